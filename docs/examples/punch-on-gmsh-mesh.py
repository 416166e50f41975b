"""Writes punch-on-gmsh-mesh.msh with Gmsh itself.

    pip install gmsh && python punch-on-gmsh-mesh.py

Half of a block, 50 mm x 20 mm, whose free upper corner is rounded with a radius of 12 mm.
"""

import gmsh

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
geo = gmsh.model.geo
R = 12.0
places = [(0, 0), (50, 0), (50, 20 - R), (50 - R, 20), (20, 20), (0, 20), (50 - R, 20 - R)]
p = [geo.addPoint(x, y, 0) for x, y in places]
bottom = geo.addLine(p[0], p[1])
side = geo.addLine(p[1], p[2])
round_ = geo.addCircleArc(p[2], p[6], p[3])
top = geo.addLine(p[3], p[4])
punch = geo.addLine(p[4], p[5])
left = geo.addLine(p[5], p[0])
lines = [bottom, side, round_, top, punch, left]
block = geo.addPlaneSurface([geo.addCurveLoop(lines)])
geo.synchronize()
gmsh.model.addPhysicalGroup(2, [block], name="block")
for tag, name in [(bottom, "bottom"), (left, "symmetry"), (punch, "punch"), (round_, "round")]:
    gmsh.model.addPhysicalGroup(1, [tag], name=name)
gmsh.option.setNumber("Mesh.MeshSizeMin", 4)
gmsh.option.setNumber("Mesh.MeshSizeMax", 4)
gmsh.model.mesh.generate(2)
gmsh.model.mesh.setOrder(2)
gmsh.write("punch-on-gmsh-mesh.msh")
gmsh.finalize()
