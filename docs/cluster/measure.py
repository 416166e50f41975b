"""Runs a deck on several numbers of processes, and tells of each what the processes took and whether the results
are those of the embedded engine; no part of moreau.

    python3 docs/cluster/measure.py MOREAU DECK DIR [PROCESSES ...]
    python3 docs/cluster/measure.py --beside MOREAU DECK DIR
    python3 docs/cluster/measure.py --table DIR

MOREAU is a command built with the feature `distributed`; 0 processes are the embedded engine. With --beside two runs of one
process each are started at once: what they take more than one alone is not what processes wait for each other, but what
processors take from each other. The table has all runs that are in DIR, those of earlier calls among them. Memory is the largest that a process has held, and processor time
that of the program in its own code and in the system's, both as the system tells them of a process that has ended.
"""

import csv
import json
import os
import resource
import subprocess
import sys
from pathlib import Path

# Not bound: runs at once would be bound to the same core.
MPI = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n"]
COLUMNS = "processes | processor [s] | largest memory [MB] | factors | iterations | forces | statuses"


def one(mark, command):
    """One process of a run, with what it took written to a file."""
    outcome = subprocess.run(command, check=False).returncode
    took = resource.getrusage(resource.RUSAGE_CHILDREN)
    rank = os.environ.get("OMPI_COMM_WORLD_RANK", "0")
    seconds = took.ru_utime + took.ru_stime
    Path(f"{mark}-{rank}").write_text(f"{took.ru_maxrss / 1e3} {seconds}\n")
    sys.exit(outcome)


def results(directory, count):
    return Path(directory, f"on-{count}" if count else "embedded")


def rows(directory, name):
    with open(Path(directory, name), newline="") as file:
        return list(csv.reader(file))


def compare(first, second):
    """Largest difference of the forces over the largest force, and contact points of other statuses."""
    a, b = rows(first, "history.csv"), rows(second, "history.csv")
    columns = [c for c, name in enumerate(a[0]) if name.startswith("force.")]
    largest = max((abs(float(r[c])) for r in a[1:] for c in columns), default=1.0)
    pairs = ((float(r[c]), float(s[c])) for r, s in zip(a[1:], b[1:]) for c in columns)
    worst = max((abs(x - y) for x, y in pairs), default=0.0)
    a, b = rows(first, "contact.csv"), rows(second, "contact.csv")
    at = a[0].index("status")
    other = sum(r[at] != s[at] for r, s in zip(a[1:], b[1:])) + abs(len(a) - len(b))
    return worst / largest, other


def command(moreau, deck, out, mark, count):
    # As many threads as each process of several has.
    own = [moreau, "run", deck, "--out", str(out), "--force", "--quiet", "--threads", "1"]
    own = [sys.executable, __file__, "--one", str(mark), *own]
    return [*MPI, str(count), *own] if count else own


def run(moreau, deck, directory, count):
    mark = Path(directory, f"took-{count}")
    for old in Path(directory).glob(f"took-{count}-*"):
        old.unlink()
    own = command(moreau, deck, results(directory, count), mark, count)
    outcome = subprocess.run(own, check=False).returncode
    if outcome != 0:
        sys.exit(f"{deck} on {count} processes: status {outcome}")


def beside(moreau, deck, directory):
    Path(directory).mkdir(parents=True, exist_ok=True)
    places = [Path(directory, f"beside-{side}") for side in ("left", "right")]
    runs = [subprocess.Popen(command(moreau, deck, at, f"{at}-took", 1)) for at in places]
    if any([run.wait() for run in runs]):
        sys.exit(f"{deck} twice at once: a run failed")
    table(directory)


def table(directory):
    marks = {int(f.name.split("-")[1]) for f in Path(directory).glob("took-*")}
    print(f"| {COLUMNS} |\n|{COLUMNS.count('|') * '---|'}---|")
    largest, sums = {}, {}
    for count in sorted(marks):
        took = [f.read_text().split() for f in Path(directory).glob(f"took-{count}-*")]
        largest[count] = max(float(t[0]) for t in took)
        sums[count] = sum(float(t[1]) for t in took)
        told = json.loads(Path(results(directory, count), "run.json").read_text())
        cells = [str(count) if count else "embedded", f"{sums[count]:.1f}", f"{largest[count]:.0f}"]
        cells += [str(told["factorisations"]), str(told["linear_iterations"])]
        if count and 0 in marks:
            worst, other = compare(results(directory, 0), results(directory, count))
            cells += [f"{worst:.1e}", str(other)]
        print("| " + " | ".join([*cells, "", ""][:7]) + " |", flush=True)
    for what, of, count in [("memory", largest, 4), ("processor time", sums, 2)]:
        if 1 in of and count in of:
            print(f"{what} on {count} over that on 1: {of[count] / of[1]:.2f}")
    both = [float(f.read_text().split()[1]) for f in Path(directory).glob("beside-*-took-0")]
    if both and 1 in sums:
        print(f"processor time of two runs on 1 at once over that of one, twice: {sum(both) / (2 * sums[1]):.2f}")


def main(moreau, deck, directory, counts):
    Path(directory).mkdir(parents=True, exist_ok=True)
    for count in map(int, counts or ["0", "1", "2", "3", "4"]):
        run(moreau, deck, directory, count)
    table(directory)


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["--one", mark, *command]:
            one(mark, command)
        case ["--beside", moreau, deck, directory]:
            beside(moreau, deck, directory)
        case ["--table", directory]:
            table(directory)
        case [moreau, deck, directory, *counts]:
            main(moreau, deck, directory, counts)
        case _:
            sys.exit(__doc__)
