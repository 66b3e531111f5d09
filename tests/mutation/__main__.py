"""Break the physics at random places and see which tests notice.

    python tests/mutation --breaks 60 --seed 1 --out tests/mutation/results.csv     from the root of the project
    python tests/mutation --breaks 60 --seed 1 --quick     first the likely tests alone; without --quick then the rest
    python tests/mutation --again --out tests/mutation/results.csv                  what survived, with today's tests

Own script: mutmut and cosmic-ray walk through all breaks of a file and know nothing of caches of compiled code.

Each break is made in a clone, with an empty cache of compiled code; the tests that are likely to see it come first,
then the rest of the default tests of its package.  A test counts only if it passes without the break.  A run that is
cut short goes on where it was; breaks are drawn from the commit that the file names.
"""

from __future__ import annotations

import argparse
import csv
import random
import signal
import subprocess
import sys
import tempfile
from fnmatch import fnmatch
from pathlib import Path

from breaks import Break, breaks_of
from clone import Clone, Verdict
from physics import files, groups
from tqdm import tqdm

ROOT = Path(__file__).resolve().parents[2]
COLUMNS = (
    "number", "seed", "commit", "file", "line", "function", "kind", "before", "after", "outcome", "test", "seconds",
    "now", "now_test", "explained",
)  # fmt: skip


def all_breaks(tree: Path) -> list[Break]:
    """Every break of every file of physics."""
    return [b for path in files(tree) for b in breaks_of(str(path), (tree / path).read_bytes())]


def drawn(tree: Path, seed: int, count: int) -> list[Break]:
    """Breaks at random: a place by equal chance over all files, then one of its edits.

    A longer draw begins with the shorter one of the same seed.
    """
    places: dict[tuple[str, int, int], list[Break]] = {}
    for b in all_breaks(tree):
        places.setdefault((b.file, b.start, b.end), []).append(b)
    rng = random.Random(seed)
    order = sorted(places)
    rng.shuffle(order)
    return [rng.choice(places[place]) for place in order][:count]


def read_rows(path: Path) -> list[dict[str, str]]:
    """Rows of an earlier run."""
    if not path.is_file():
        return []
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def write_rows(path: Path, rows: list[dict[str, str]]) -> None:
    """All rows, put in place at once."""
    part = path.with_suffix(".part")
    with part.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    part.replace(path)


class Judge:
    """Verdicts in one clone; a test that also fails without the break is an error of the tree, not a catch."""

    def __init__(self, folder: Path, commit: str, stuck: float, quick: bool = False) -> None:
        self.broken, self.sound = (Clone(ROOT, folder / name, commit) for name in ("broken", "sound"))
        self.stuck, self.quick, self.good = stuck, quick, set[str]()

    def __call__(self, one: Break) -> Verdict:
        tests = groups(self.broken.tree, one.file)
        short = self.quick and len(tests) > 1
        verdict = self.broken.judge(one, tests[:-1] if short else tests, self.stuck)
        # Of all its cases: names of some hold numbers that were computed, and the break may have moved these.
        without = verdict.test.partition("[")[0]
        if short and verdict.outcome == "survived":
            return Verdict("open", "", verdict.seconds)
        if verdict.outcome == "timeout":  # compiling from nothing on a busy machine is no reason to call it caught
            self.sound.make_cold()
            outcome, test = self.sound.run([without], 0.5 * self.stuck)
            if outcome == "timeout":
                return Verdict("open", f"too slow without the break too: {test}", verdict.seconds)
        elif verdict.outcome != "survived" and verdict.test not in self.good:
            outcome, test = self.sound.run([without], 3.0 * self.stuck)
        else:
            return verdict
        if outcome != "survived":
            raise SystemExit(f"{test}: {outcome} without any break; want tests that pass, see {self.sound.log}")
        self.good.add(verdict.test)
        return verdict


def first_run(out: Path, count: int, seed: int, folder: Path, stuck: float, quick: bool, only: str) -> None:
    """Draw, judge and write, a row at a time; rows that are open wait for a run that is not quick.

    only: pattern of files; breaks of others are drawn too, and wait for a run that asks for them.
    """
    mine = [row for row in read_rows(out) if row["seed"] == str(seed)]
    commit = mine[0]["commit"] if mine else _head()
    judge = Judge(folder, commit, stuck, quick)
    chosen = drawn(judge.broken.tree, seed, count)
    waits = {int(r["number"]) for r in mine if r["outcome"] == "open" and not r["explained"] and not quick}
    done = {int(r["number"]) for r in mine} - waits
    todo = [(n, b) for n, b in enumerate(chosen, 1) if n not in done and fnmatch(b.file, only)]
    for number, one in tqdm(todo, unit="break"):
        verdict = judge(one)
        facts = (one.file, one.line, one.function, one.kind, one.before, one.after)
        values = (number, seed, commit, *facts, verdict.outcome, verdict.test, verdict.seconds, "", "", "")
        # Whoever explains another row meanwhile keeps what he wrote.
        others = [r for r in read_rows(out) if (r["seed"], r["number"]) != (str(seed), str(number))]
        row = dict(zip(COLUMNS, map(str, values), strict=True))
        write_rows(out, sorted([*others, row], key=lambda r: (int(r["seed"]), int(r["number"]))))
    _sum_up(read_rows(out))


def again(out: Path, folder: Path, stuck: float, quick: bool) -> None:
    """Make the breaks that survived and are not explained in today's tree, and see whether its tests notice."""
    judge = Judge(folder, _head(), stuck, quick)
    here = {(b.file, b.kind, b.before, b.after): b for b in all_breaks(judge.broken.tree)}
    waiting = [row for row in read_rows(out) if row["outcome"] in ("survived", "open") and not row["explained"]]
    waiting = sorted((row for row in waiting if row["now"] != "caught"), key=lambda row: bool(row["now"]))
    for row in tqdm(waiting, unit="break"):  # first those that were never made again
        one = here.get((row["file"], row["kind"], row["before"], row["after"]))
        verdict = Verdict("gone", "the line is no longer there", 0.0) if one is None else judge(one)
        rows = read_rows(out)
        for other in rows:
            if (other["seed"], other["number"]) == (row["seed"], row["number"]):
                other["now"], other["now_test"] = verdict.outcome, verdict.test
        write_rows(out, rows)
    _sum_up(read_rows(out))


def _head() -> str:
    return subprocess.run(
        ["git", "rev-parse", "--short=12", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.strip()


def _sum_up(rows: list[dict[str, str]]) -> None:
    seen = sum(row["outcome"] not in ("survived", "open") for row in rows)
    same = sum(row["outcome"] in ("survived", "open") and bool(row["explained"]) for row in rows)
    later = sum(row["now"] in ("caught", "crash", "timeout") for row in rows)
    share = f", {seen / (len(rows) - same):.1%} of those that change anything" if len(rows) > same else ""
    print(f"{len(rows)} breaks: {seen} caught{share}; {same} explained; {later} caught by tests added since")


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python tests/mutation", description=__doc__.split("\n", 1)[0])
    parser.add_argument("--breaks", type=int, default=60, help="how many (default: 60)")
    parser.add_argument("--seed", type=int, default=1, help="of the draw (default: 1)")
    parser.add_argument("--out", type=Path, default=ROOT / "tests/mutation/results.csv", help="table to write or go on")
    parser.add_argument("--again", action="store_true", help="only what survived and is not explained, in today's tree")
    parser.add_argument(
        "--quick", action="store_true", help="only the tests that are likely to see it; others stay open"
    )
    parser.add_argument("--only", default="*", metavar="FILES", help="judge breaks of these alone now, as 'dem/*'")
    parser.add_argument("--list", action="store_true", help="show the draw of this seed in the tree as it is, and end")
    parser.add_argument("--folder", type=Path, help="for the clones (default: a new one, deleted at the end)")
    parser.add_argument("--stuck", type=float, default=300.0, metavar="S", help="a test that takes longer has seen it")
    options = parser.parse_args()
    if options.list:
        for number, one in enumerate(drawn(ROOT, options.seed, options.breaks), 1):
            print(f"{number:3d} {one.file}:{one.line} {one.function} ({one.kind})\n    {one.before}\n    {one.after}")
        return
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that tests under way end too
    with tempfile.TemporaryDirectory(prefix="mutation_") as temporary:
        folder = options.folder or Path(temporary)
        if options.again:
            again(options.out, folder, options.stuck, options.quick)
        else:
            first_run(options.out, options.breaks, options.seed, folder, options.stuck, options.quick, options.only)


if __name__ == "__main__":
    main()
