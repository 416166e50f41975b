"""The punched block by CalculiX: CPE8R elements, contact node to surface by a penalty.

    python3 calculix_block.py NX NY INCREMENTS FRICTION

needs the program ccx (package calculix-ccx). Prints one line of JSON: the load of the punch [N],
Newton iterations, processor seconds of ccx.
"""
import json
import os
import re
import resource
import subprocess
import sys
import tempfile

nx, ny, increments = (int(word) for word in sys.argv[1:4])
friction = float(sys.argv[4])
LENGTH, HEIGHT, YOUNG, POISSON, YIELD, TRAVEL, PENALTY = 50.0, 20.0, 210000.0, 0.3, 300.0, 0.2, 1e7


def number(i, j):
    return 1 + i + j * (2 * nx + 1)


lines = ["*NODE, NSET=ALL"]
sets = {"BOTTOM": [], "PUNCH": [], "AXIS": []}
for j in range(2 * ny + 1):
    for i in range(2 * nx + 1):
        if i % 2 and j % 2:
            continue
        x, y = LENGTH * i / (2 * nx), HEIGHT * j / (2 * ny)
        lines.append(f"{number(i, j)}, {x!r}, {y!r}")
        if j == 0:
            sets["BOTTOM"].append(number(i, j))
        if j == 2 * ny and x <= 25.0 + 1e-9:
            sets["PUNCH"].append(number(i, j))
        if i == 0:
            sets["AXIS"].append(number(i, j))
first = number(2 * nx, 2 * ny) + 1
sets["TOOL"] = list(range(first, first + 4))
for node, (x, y) in zip(sets["TOOL"], [(-10, -10), (70, -10), (70, 0), (-10, 0)]):
    lines.append(f"{node}, {x}, {y}")
lines.append("*ELEMENT, TYPE=CPE8R, ELSET=BLOCK")
cell = 0
for j in range(0, 2 * ny, 2):
    for i in range(0, 2 * nx, 2):
        cell += 1
        around = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
        lines.append(", ".join(str(n) for n in [cell] + [number(i + a, j + b) for a, b in around]))
lines += ["*ELEMENT, TYPE=CPE4, ELSET=FOUNDATION", f"{cell + 1}, " + ", ".join(map(str, sets["TOOL"]))]
for name, nodes in sets.items():
    lines.append(f"*NSET, NSET={name}")
    lines += [f"{node}," for node in nodes]
lines += f"""*MATERIAL, NAME=STEEL
*ELASTIC
{YOUNG}, {POISSON}
*PLASTIC
{YIELD}, 0.
*MATERIAL, NAME=HARD
*ELASTIC
{YOUNG}, {POISSON}
*SOLID SECTION, ELSET=BLOCK, MATERIAL=STEEL
1.
*SOLID SECTION, ELSET=FOUNDATION, MATERIAL=HARD
1.
*SURFACE, NAME=SLAVE, TYPE=NODE
BOTTOM
*SURFACE, NAME=MASTER
{cell + 1}, S3
*SURFACE INTERACTION, NAME=TOUCH
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
{PENALTY}
*FRICTION
{friction}, {PENALTY}
*CONTACT PAIR, INTERACTION=TOUCH, TYPE=NODE TO SURFACE, SMALL SLIDING
SLAVE, MASTER
*STEP, INC=10000
*STATIC
{1.0 / increments!r}, 1., 1e-6, {1.0 / increments!r}
*BOUNDARY
TOOL, 1, 2
AXIS, 1, 1
PUNCH, 2, 2, {-TRAVEL}
*NODE PRINT, NSET=PUNCH, TOTALS=ONLY
RF
*END STEP""".splitlines()

with tempfile.TemporaryDirectory() as folder:
    with open(os.path.join(folder, "block.inp"), "w", encoding="ascii") as file:
        file.write("\n".join(lines) + "\n")
    threads = {"OMP_NUM_THREADS": "1", "CCX_NPROC_EQUATION_SOLVER": "1", "CCX_NPROC_STIFFNESS": "1"}
    run = subprocess.run(
        ["ccx", "block"], cwd=folder, env=os.environ | threads, capture_output=True, text=True, check=False
    )
    with open(os.path.join(folder, "block.dat"), encoding="ascii") as file:
        totals = [line.split() for line in file if re.match(r"\s+-?\d\.\d+E", line)]
    with open(os.path.join(folder, "block.sta"), encoding="ascii") as file:
        steps = [line.split() for line in file if re.match(r"\s*\d+\s+\d+\s+\d+", line)]
if "Job finished" not in run.stdout or not totals:
    sys.exit("ccx stopped: " + run.stdout[-500:])
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(json.dumps({
    "system": "CalculiX",
    "unknowns": 2 * (3 * nx * ny + 2 * (nx + ny) + 1), "load": -float(totals[-1][1]),
    "iterations": sum(int(step[3]) for step in steps),
    "seconds": used.ru_utime + used.ru_stime,
}))
