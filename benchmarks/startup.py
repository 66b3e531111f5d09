"""How long does a user wait before the first number?  CPU time of `import rocking` and of the first run of a process.

Peers    the bare interpreter and `import numpy`, which `rocking` cannot do without.
Measure  CPU time of a fresh process (all of its threads), the least of several; first runs find on disk what an earlier
         process compiled.  Aim: less than 0.3 s for the import, the interpreter's own start not counted.
Run      python benchmarks/startup.py [--runs N]  ->  a table, and benchmarks/results/startup.csv
"""

from __future__ import annotations

import argparse
import csv
import platform
import resource
import subprocess
import sys
import time
from pathlib import Path

RESULTS = Path(__file__).parent / "results" / "startup.csv"
HEAD = ["what", "cpu_s", "wall_s", "more_than_bare_s"]
FREE = "from rocking import *; solve(Method1(Block(0.2, 0.8), form='linear'), theta=0.1, t_end=1.0, solver={!r})"
CASES = {"bare interpreter": "pass", "import numpy": "import numpy", "import rocking": "import rocking"} | {
    f"first run, {solver}": FREE.format(solver) for solver in ("scipy", "numba", "exact", "taylor", "diffrax")
}


def once(statement: str) -> tuple[float, float]:
    """(CPU time, wall time) [s] of a fresh interpreter that does the statement."""
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([sys.executable, "-c", statement], check=True)
    wall, after = time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall


def main() -> None:
    """Measure, print and save."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=5, help="processes of each kind that count (default: %(default)s)")
    runs = parser.parse_args().runs
    rows, bare = [], 0.0
    for name, statement in CASES.items():
        once(statement)
        cpu, wall = (min(column) for column in zip(*(once(statement) for _ in range(runs)), strict=True))
        bare = bare or cpu
        rows.append([name, f"{cpu:.3f}", f"{wall:.3f}", f"{cpu - bare:.3f}"])
    for row in [HEAD, *rows]:
        print("  ".join(f"{cell:20s}" for cell in row).rstrip())
    RESULTS.parent.mkdir(exist_ok=True)
    with RESULTS.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*HEAD, "python", "machine"])
        writer.writerows([*row, platform.python_version(), platform.machine()] for row in rows)
    print(f"wrote {RESULTS}")


if __name__ == "__main__":
    main()
