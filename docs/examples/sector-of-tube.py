"""Writes sector-of-tube.msh: 60 degrees of a tube, 10 mm to 20 mm, between planes at 30 and 90 degrees.

    python sector-of-tube.py
"""

from math import cos, radians, sin

RADIAL, AROUND = 4, 6
LINE, CELL = 8, 16  # of three nodes, of eight

numbers, lines, cells = {}, [], []


def node(i, k):
    """Of the grid of half cells: i outwards, k around from 30 degrees."""
    return numbers.setdefault((i, k), len(numbers) + 1)


for k in range(0, 2 * AROUND, 2):
    for i in range(0, 2 * RADIAL, 2):
        corners = [(i, k), (i + 2, k), (i + 2, k + 2), (i, k + 2)]
        sides = [(i + 1, k), (i + 2, k + 1), (i + 1, k + 2), (i, k + 1)]
        cells.append([node(*at) for at in corners + sides])
    for group, i in ((2, 0), (3, 2 * RADIAL)):
        lines.append((group, [node(i, k), node(i, k + 2), node(i, k + 1)]))
for i in range(0, 2 * RADIAL, 2):
    for group, k in ((4, 0), (5, 2 * AROUND)):
        lines.append((group, [node(i, k), node(i + 2, k), node(i + 1, k)]))

elements = [(LINE, group, nodes) for group, nodes in lines] + [(CELL, 1, nodes) for nodes in cells]
with open("sector-of-tube.msh", "w", encoding="utf-8") as out:
    names = ['2 1 "tube"', '1 2 "bore"', '1 3 "outside"', '1 4 "lower"', '1 5 "upper"']
    print("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5", *names, sep="\n", file=out)
    print("$EndPhysicalNames\n$Nodes", len(numbers), sep="\n", file=out)
    for (i, k), number in numbers.items():
        r, angle = 10 + 5 * i / RADIAL, radians(30 + 30 * k / AROUND)
        print(number, r * cos(angle), r * sin(angle), 0, file=out)
    print("$EndNodes\n$Elements", len(elements), sep="\n", file=out)
    for number, (kind, group, nodes) in enumerate(elements, 1):
        print(number, kind, 2, group, group, *nodes, file=out)
    print("$EndElements", file=out)
