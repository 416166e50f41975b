"""Writes the MSH files of this folder with Gmsh itself; the tests read them, and never run this.

    pip install gmsh && python make.py

Models come in four encodings, solids of order 2 in the first and the last: MODEL.2a.msh (MSH 2.2, ASCII), .2b (2.2, binary), .4a (4.1,
ASCII) and .4b (4.1, binary).
"""

import gmsh

ENCODINGS = {"2a": (2.2, 0), "2b": (2.2, 1), "4a": (4.1, 0), "4b": (4.1, 1)}


def start(name):
    gmsh.clear()
    gmsh.model.add(name)
    for option, value in {
        "Mesh.SecondOrderIncomplete": 0,
        "Mesh.RecombineAll": 0,
        "Mesh.SaveParametric": 0,
        "Mesh.SaveAll": 0,
    }.items():
        gmsh.option.setNumber(option, value)


def name(dimension, tags, text):
    gmsh.model.addPhysicalGroup(dimension, tags, name=text)


def write(model, encodings=ENCODINGS):
    for suffix in encodings:
        version, binary = ENCODINGS[suffix]
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.write(f"{model}.{suffix}.msh")


def plate(turned=False):
    """A quarter of a plate of 10 mm by 10 mm with a hole of radius 4 mm, in two sectors."""
    geo = gmsh.model.geo
    c = 4.0 / 2.0**0.5
    places = [(0, 0), (4, 0), (10, 0), (10, 10), (0, 10), (0, 4), (c, c)]
    o, a, b, d, e, f, m = [geo.addPoint(x, y, 0) for x, y in places]
    bottom, right, top, left = (
        geo.addLine(p, q) for p, q in [(a, b), (b, d), (d, e), (e, f)]
    )
    arcs = [geo.addCircleArc(f, o, m), geo.addCircleArc(m, o, a)]
    cut = geo.addLine(m, d)
    loops = [[bottom, right, -cut, arcs[1]], [cut, top, left, arcs[0]]]
    if turned:
        loops = [[-line for line in reversed(loop)] for loop in loops]
    sectors = [geo.addPlaneSurface([geo.addCurveLoop(loop)]) for loop in loops]
    for line in [bottom, right, top, left, cut, *arcs]:
        geo.mesh.setTransfiniteCurve(line, 4)
    geo.synchronize()
    name(2, [sectors[0]], "right half")
    name(2, [sectors[1]], "left half")
    name(2, sectors, "plate")
    for line, text in [(bottom, "bottom"), (right, "right"), (top, "top"), (left, "left")]:
        name(1, [line], text)
    name(1, arcs, "hole")
    name(1, [cut], "cut")
    name(0, [d], "corner")
    name(0, [o], "centre")  # in no cell
    return sectors


def plates():
    for model, order, incomplete, quads, turned in [
        ("tri6", 2, 0, 0, False),
        ("quad8", 2, 1, 2, False),
        ("quad9", 2, 0, 2, True),
        ("mixed", 1, 0, 1, False),
    ]:
        start(model)
        sectors = plate(turned)
        for sector in sectors[:quads]:
            gmsh.model.mesh.setTransfiniteSurface(sector)
            gmsh.model.mesh.setRecombine(2, sector)
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", incomplete)
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(order)
        write(model)
        if model == "tri6":
            gmsh.option.setNumber("Mesh.SaveParametric", 1)
            write("parametric", ["4a", "4b"])
            gmsh.option.setNumber("Mesh.SaveParametric", 0)
            gmsh.model.mesh.partition(2)
            write("partitioned", ["2a", "4a", "4b"])


def box(hexes):
    """A box of 2 × 3 × 5 mm, cut at z = 2 into a lower and an upper part that share nodes."""
    geo = gmsh.model.geo
    points = {
        (i, j, k): geo.addPoint(x, y, z)
        for i, x in enumerate([0, 2])
        for j, y in enumerate([0, 3])
        for k, z in enumerate([0, 2, 5])
    }
    lines = {}

    def line(p, q):
        if (q, p) in lines:
            return -lines[q, p]
        if (p, q) not in lines:
            lines[p, q] = geo.addLine(points[p], points[q])
        return lines[p, q]

    def face(*corners):
        edges = [line(p, q) for p, q in zip(corners, corners[1:] + corners[:1])]
        return geo.addPlaneSurface([geo.addCurveLoop(edges)])

    ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
    levels = [face(*[(*p, k) for p in ring]) for k in range(3)]
    sides = [
        [
            face((*p, k), (*q, k), (*q, k + 1), (*p, k + 1))
            for p, q in zip(ring, ring[1:] + ring[:1])
        ]
        for k in range(2)
    ]
    volumes = [
        geo.addVolume([geo.addSurfaceLoop([levels[k], levels[k + 1], *sides[k]])])
        for k in range(2)
    ]
    for tag in lines.values():
        geo.mesh.setTransfiniteCurve(tag, 3)
    if hexes:
        for tag in [*levels, *sides[0], *sides[1]]:
            geo.mesh.setTransfiniteSurface(tag)
            geo.mesh.setRecombine(2, tag)
        for tag in volumes:
            geo.mesh.setTransfiniteVolume(tag)
    geo.synchronize()
    name(3, [volumes[0]], "lower")
    name(3, [volumes[1]], "upper")
    name(3, volumes, "box")
    name(2, [levels[0]], "base")
    name(2, [levels[1]], "interface")
    name(2, [levels[2], *sides[0], *sides[1]], "box")  # the name of cells as well
    name(1, [abs(line((0, 0, 0), (0, 0, 1)))], "edge")
    name(0, [points[1, 1, 2]], "tip")
    gmsh.model.mesh.generate(3)


def boxes():
    for model, hexes in [("tet4", False), ("hex8", True)]:
        start(model)
        box(hexes)
        write(model)
    for model, hexes, incomplete in [
        ("tet10", False, 0),
        ("hex20", True, 1),
        ("hex27", True, 0),
    ]:
        start(model)
        box(hexes)
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", incomplete)
        gmsh.model.mesh.setOrder(2)
        write(model, ["2a", "4b"])


def periodic():
    """A unit square without any physical group, its right side a translated copy of the left."""
    start("periodic")
    geo = gmsh.model.geo
    corners = [geo.addPoint(x, y, 3) for x, y in [(0, 0), (1, 0), (1, 1), (0, 1)]]
    sides = [geo.addLine(corners[i], corners[(i + 1) % 4]) for i in range(4)]
    geo.addPlaneSurface([geo.addCurveLoop(sides)])
    for side in sides:
        geo.mesh.setTransfiniteCurve(side, 3)
    geo.synchronize()
    shift = [1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
    gmsh.model.mesh.setPeriodic(1, [sides[1]], [sides[3]], shift)
    gmsh.model.mesh.generate(2)
    write("periodic")


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
plates()
boxes()
periodic()
gmsh.finalize()
