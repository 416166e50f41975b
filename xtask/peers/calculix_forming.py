"""Forming under large strains by CalculiX: CPE8R and CAX8R elements with NLGEOM, contact node to surface by a penalty.

    python3 calculix_forming.py (billet | ring | bar) INCREMENTS

needs the program ccx (package calculix-ccx). A quarter of a block of steel 20 mm x 20 mm pressed to 0.6 of its height and
a ring 6 : 3 : 2 pressed to half of its height, by a platen with friction 0.1; a round bar that necks. The laws and the
meshes are those of the chapter "Large strains" of the verification. Prints one line of JSON: the load [N; kN for the
bar] of the quarter, of the full circle where the body is round; Newton iterations; processor seconds of ccx.
"""
import json
import math
import os
import re
import resource
import subprocess
import sys
import tempfile

case, increments = sys.argv[1], int(sys.argv[2])
FRICTION = 0.1
# The ring stops at a quarter of its way with springs that are stiffer, or with fewer increments.
PENALTY, FINER = (1e4, 8) if case == "ring" else (1e6, 1)
increments *= FINER
STEEL = (210000.0, 0.3, [(300.0 + 500.0 * p, p) for p in (0.0, 5.0)])


def voce(p):
    return 0.45 + (0.715 - 0.45) * (1.0 - math.exp(-16.93 * p)) + 0.12924 * p


STRAINS = [0.4 * (i / 150) ** 2 for i in range(150)] + [0.4 + 0.1 * i for i in range(30)]
ALLOY = (206.9, 0.29, [(voce(p), p) for p in STRAINS])
x0, x1, height, nx, ny, travel, law, round_ = {
    "billet": (0.0, 10.0, 10.0, 8, 8, -4.0, STEEL, False),
    "ring": (4.5, 9.0, 3.0, 12, 8, -1.5, STEEL, True),
    "bar": (0.0, 6.413, 26.667, 4, 15, 7.0, ALLOY, True),
}[case]
touches = case != "bar"


def number(i, j):
    return 1 + i + j * (2 * nx + 1)


def place(i, j):
    x, y = x0 + (x1 - x0) * i / (2 * nx), height * j / (2 * ny)
    return (x if touches else x * (0.982 + 0.018 * y / height)), y


lines = ["*NODE, NSET=ALL"]
sets = {"BOTTOM": [], "TOP": [], "AXIS": [], "SKIN": []}
for j in range(2 * ny + 1):
    for i in range(2 * nx + 1):
        if i % 2 and j % 2:
            continue
        node, (x, y) = number(i, j), place(i, j)
        lines.append(f"{node}, {x!r}, {y!r}")
        if j == 0:
            sets["BOTTOM"].append(node)
        if j == 2 * ny:
            sets["TOP"].append(node)
        if i == 0 and x0 == 0.0:
            sets["AXIS"].append(node)
        bore = i == 0 and x0 > 0.0
        if j == 2 * ny or (j > 0 and (i == 2 * nx or bore)):
            sets["SKIN"].append(node)
cells = []
for j in range(0, 2 * ny, 2):
    for i in range(0, 2 * nx, 2):
        around = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
        cells.append([number(i + a, j + b) for a, b in around])
kind = "CAX" if round_ else "CPE"
if touches:
    first = number(2 * nx, 2 * ny) + 1
    sets["TOOL"] = list(range(first, first + 4))
    left = 0.0 if round_ else -10.0
    for node, (x, y) in zip(sets["TOOL"], [(left, 0), (60, 0), (60, 10), (left, 10)]):
        lines.append(f"{node}, {x}, {height + y}")
lines.append(f"*ELEMENT, TYPE={kind}8R, ELSET=BODY")
lines += [", ".join(str(n) for n in [k + 1, *cell]) for k, cell in enumerate(cells)]
if touches:
    platen = ", ".join(map(str, sets["TOOL"]))
    lines += [f"*ELEMENT, TYPE={kind}4, ELSET=PLATEN", f"{len(cells) + 1}, {platen}"]
for name, nodes in sets.items():
    if nodes:
        lines.append(f"*NSET, NSET={name}")
        lines += [f"{node}," for node in nodes]
young, poisson, curve = law
lines += f"*MATERIAL, NAME=METAL\n*ELASTIC\n{young}, {poisson}\n*PLASTIC".splitlines()
lines += [f"{stress:.12g}, {p:.12g}" for stress, p in curve]
lines += ["*SOLID SECTION, ELSET=BODY, MATERIAL=METAL", "1."]
if touches:
    lines += f"""*MATERIAL, NAME=HARD
*ELASTIC
{young}, {poisson}
*SOLID SECTION, ELSET=PLATEN, MATERIAL=HARD
1.
*SURFACE, NAME=SLAVE, TYPE=NODE
SKIN
*SURFACE, NAME=MASTER
{len(cells) + 1}, S1
*SURFACE INTERACTION, NAME=TOUCH
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
{PENALTY}
*FRICTION
{FRICTION}, {PENALTY}
*CONTACT PAIR, INTERACTION=TOUCH, TYPE=NODE TO SURFACE
SLAVE, MASTER""".splitlines()
driven = "TOOL" if touches else "TOP"
lines += f"""*STEP, NLGEOM, INC=100000
*STATIC
{1.0 / increments!r}, 1., 1e-9, {1.0 / increments!r}
*BOUNDARY
BOTTOM, 2, 2
{driven}, 2, 2, {travel}""".splitlines()
if sets["AXIS"]:
    lines.append("AXIS, 1, 1")
if touches:
    lines.append("TOOL, 1, 1")
lines += f"*NODE PRINT, NSET={driven}, TOTALS=ONLY\nRF\n*END STEP".splitlines()

with tempfile.TemporaryDirectory() as folder:
    with open(os.path.join(folder, "body.inp"), "w", encoding="ascii") as file:
        file.write("\n".join(lines) + "\n")
    threads = {"OMP_NUM_THREADS": "1", "CCX_NPROC_EQUATION_SOLVER": "1", "CCX_NPROC_STIFFNESS": "1"}
    run = subprocess.run(
        ["ccx", "body"], cwd=folder, env=os.environ | threads, capture_output=True, text=True, check=False
    )
    with open(os.path.join(folder, "body.dat"), encoding="ascii") as file:
        totals = [line.split() for line in file if re.match(r"\s+-?\d\.\d+E", line)]
    with open(os.path.join(folder, "body.sta"), encoding="ascii") as file:
        steps = [line.split() for line in file if re.match(r"\s*\d+\s+\d+\s+\d+", line)]
if "Job finished" not in run.stdout or not totals:
    reached = steps[-1][-2] if steps else "0"
    said = re.findall(r"\*ERROR.*", run.stdout) or ["no error"]
    sys.exit(f"ccx stopped at {reached} of the step: {said[0].strip()}")
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(json.dumps({
    "system": "CalculiX",
    "unknowns": 2 * (3 * nx * ny + 2 * (nx + ny) + 1),
    "load": abs(float(totals[-1][1])) * (180.0 if round_ else 1.0),
    "iterations": sum(int(step[3]) for step in steps),
    "seconds": used.ru_utime + used.ru_stime,
}))
