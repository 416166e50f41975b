"""Runs a deck on several numbers of processes, and tells of each what the processes took and whether the results
are those of the run before it; no part of moreau.

    python3 docs/cluster/measure.py MOREAU DECK DIR [PROCESSES ...]

MOREAU is a command built with the feature `distributed`. The first run is that of the embedded engine. Memory is the
largest that a process has held, and processor time that of the program in its own code and in the system's, both as
the system tells them of a process that has ended.
"""

import csv
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

MPI = ["mpirun", "--oversubscribe", "-n"]


def one(into, command):
    """One process of a run, with what it took written to a file."""
    outcome = subprocess.run(command, check=False).returncode
    took = resource.getrusage(resource.RUSAGE_CHILDREN)
    rank = os.environ.get("OMPI_COMM_WORLD_RANK", "0")
    seconds = took.ru_utime + took.ru_stime
    Path(into, f"took-{rank}").write_text(f"{took.ru_maxrss / 1e3} {seconds}\n")
    sys.exit(outcome)


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


def main(moreau, deck, directory, counts):
    Path(directory).mkdir(parents=True, exist_ok=True)
    reference = Path(directory, "embedded")
    print("processes   seconds   processor s   largest MB   forces   statuses")
    for count in [0, *map(int, counts)]:
        out = Path(directory, f"on-{count}") if count else reference
        for old in Path(directory).glob("took-*"):
            old.unlink()
        run = [moreau, "run", deck, "--out", str(out), "--force", "--quiet"]
        # As many threads as each process of several has.
        run += ["--threads", "1"]
        command = [sys.executable, __file__, "--one", directory, *run]
        command = [*MPI, str(count), *command] if count else command
        started = time.time()
        outcome = subprocess.run(command, check=False).returncode
        seconds = time.time() - started
        took = [f.read_text().split() for f in Path(directory).glob("took-*")]
        memory = max((float(t[0]) for t in took), default=0.0)
        processor = sum(float(t[1]) for t in took)
        worst, other = compare(reference, out) if outcome == 0 else (float("nan"), -1)
        name = str(count) if count else "embedded"
        print(f"{name:>9} {seconds:9.1f} {processor:13.1f} {memory:12.0f}   {worst:.1e} {other:8d}", flush=True)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        one(sys.argv[2], sys.argv[3:])
    main(sys.argv[1], sys.argv[2], sys.argv[3], sys.argv[4:] or ["1", "2", "3", "4"])
