"""Writes plates-stacked.msh: a plate, 20 mm x 10 mm, of 5 x 3 quadrangles with named sides.

    python plates-stacked.py
"""

from pathlib import Path

NX, NY = 5, 3
node = [[1 + i + (NX + 1) * j for i in range(NX + 1)] for j in range(NY + 1)]
names = ["left", "right", "bottom", "top", "plate"]
edges = {
    "left": [(node[j + 1][0], node[j][0]) for j in range(NY)],
    "right": [(node[j][NX], node[j + 1][NX]) for j in range(NY)],
    "bottom": [(node[0][i], node[0][i + 1]) for i in range(NX)],
    "top": [(node[NY][i + 1], node[NY][i]) for i in range(NX)],
}
cells = [
    (node[j][i], node[j][i + 1], node[j + 1][i + 1], node[j + 1][i])
    for j in range(NY)
    for i in range(NX)
]
elements = [(1, 1 + names.index(name), pair) for name, pairs in edges.items() for pair in pairs]
elements += [(3, 5, cell) for cell in cells]

lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))]
lines += [f'{2 if name == "plate" else 1} {k} "{name}"' for k, name in enumerate(names, 1)]
lines += ["$EndPhysicalNames", "$Nodes", str((NX + 1) * (NY + 1))]
lines += [
    f"{node[j][i]} {20 * i / NX} {10 * j / NY} 0" for j in range(NY + 1) for i in range(NX + 1)
]
lines += ["$EndNodes", "$Elements", str(len(elements))]
for number, (kind, group, nodes) in enumerate(elements, 1):
    lines.append(" ".join(map(str, (number, kind, 2, group, group, *nodes))))
lines += ["$EndElements", ""]
Path(__file__).with_suffix(".msh").write_text("\n".join(lines))
