"""Writes bar-necks.msh: half of a bar from its middle upwards, thinner there by two hundredths, in quadratic cells.

    python bar-necks.py
"""

from pathlib import Path

LENGTH, RADIUS, CELLS = 26.667, 6.413, (4, 15)

nodes, number = [], {}
for j in range(2 * CELLS[1] + 1):
    for i in range(2 * CELLS[0] + 1):
        if i % 2 and j % 2:
            continue  # serendipity cells have no node in their middle
        r, z = RADIUS * i / (2 * CELLS[0]), LENGTH * j / (2 * CELLS[1])
        number[i, j] = len(nodes) + 1
        nodes.append((r * (0.982 + 0.018 * z / LENGTH), z))

# Type in Gmsh, group, nodes: corners, then the middles of the sides between them.
LINE, QUAD = 8, 16
GROUPS = [(1, 1, "bottom"), (1, 2, "top"), (1, 3, "axis"), (2, 4, "bar")]
elements = []
for i in range(0, 2 * CELLS[0], 2):
    for j, group in [(0, 1), (2 * CELLS[1], 2)]:
        elements.append((LINE, group, [(i, j), (i + 2, j), (i + 1, j)]))
for j in range(0, 2 * CELLS[1], 2):
    elements.append((LINE, 3, [(0, j), (0, j + 2), (0, j + 1)]))
    for i in range(0, 2 * CELLS[0], 2):
        corners = [(i, j), (i + 2, j), (i + 2, j + 2), (i, j + 2)]
        middles = [(i + 1, j), (i + 2, j + 1), (i + 1, j + 2), (i, j + 1)]
        elements.append((QUAD, 4, corners + middles))

lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(GROUPS))]
lines += [f'{dim} {tag} "{name}"' for dim, tag, name in GROUPS]
lines += ["$EndPhysicalNames", "$Nodes", str(len(nodes))]
lines += [f"{k} {x!r} {y!r} 0" for k, (x, y) in enumerate(nodes, 1)]
lines += ["$EndNodes", "$Elements", str(len(elements))]
for k, (kind, group, places) in enumerate(elements, 1):
    lines.append(" ".join(map(str, [k, kind, 2, group, group, *(number[p] for p in places)])))
lines += ["$EndElements", ""]
Path(__file__).with_suffix(".msh").write_text("\n".join(lines))
