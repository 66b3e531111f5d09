"""The loop on campaigns of a virtual laboratory whose truth is hidden from it: what it finds, and what that costs.

Cases    one campaign for each effect and seed (studies.laboratory shares no code with the models): named effects,
         effects on no list (right answer: unexplained), pairs, clean ones; by option weak ones, spoiled records,
         accelerometers in place of the rotation, outcomes alone, or a block of MuJoCo or dem for the laboratory's own.
Peers    the calibrated baseline of the same run (error before), and the true model under the same noise of base and
         leans (the floor): the loop's error after the effect stands between the two.
Measure  verdict, effects traced (as named, by a twin, in a set that cannot be told apart), false alarms, share of true
         parameters within their 95 % interval, error on later tests over the floor, claimed over true error, CPU time.
Run      python -m studies.loop_trials [--effects a b c+d null] [--seeds N] [--jobs 1] [--channel ...] [--quick]
         ->  a table, and build/studies/loop_trials/loop_trials.csv; campaigns that were closed are not closed again
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import shlex
import subprocess
import sys
import threading
import time
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from excitation import _early
from studies.laboratory import by_mujoco
from studies.laboratory.campaign import NUISANCES, make_campaign
from studies.laboratory.effects import NAMED, UNNAMED
from studies.laboratory.judge import judge
from studies.laboratory.outcomes import make_outcomes
from studies.laboratory.parameters import G
from studies.laboratory.plans import OTHERS, check_together
from studies.laboratory.truth import Truth, read_truth
from studies.running.command_line import said_of
from studies.running.files import BadInputError, save_text, writable_folder, write_whole
from studies.running.interrupts import first_done, noted
from studies.running.lock import alone

OUT = Path("build/studies/loop_trials")
QUICK = {"event": ("null", "viscous_damping"), "mujoco": ("null", "viscous_damping"), "dem": ("compliant_base",)}
PAIRS = (
    "rounded_edges+viscous_damping",
    "base_tilt+velocity_dependent_restitution",
    "base_motion_gain+rotation_offset",
    "quadratic_drag+tether",
)
TIME_LIMIT = 3600.0  # s for a campaign
COLUMNS = ("verdict", "effects", "traced", "before", "after", "floor", "after_over_floor", "claimed_over_true", "cpu_s")


@dataclass(frozen=True)
class Case:
    """A campaign to make."""

    effects: tuple[str, ...]
    seed: int
    strength: str
    channel: str
    nuisances: tuple[str, ...]
    engine: str = "event"

    @property
    def name(self) -> str:
        """What it is called in the table."""
        odd = "" if self.strength == "strong" else f"-{self.strength}"
        kind = "" if self.channel == "rotation" else f"-{self.channel}"
        engine = "" if self.engine == "event" else f"-{self.engine}"
        return f"{'+'.join(self.effects) or 'null'}{odd}{kind}{engine}-{self.seed}"


def made(case: Case, folder: Path) -> Truth:
    """The campaign on disk; one that is there already is kept."""
    if not (folder / "truth" / "truth.toml").exists():
        if case.channel == "outcome":
            make_outcomes(case.seed, case.effects, folder)
        else:
            make_campaign(
                case.seed, case.effects, folder, strength=case.strength, channel=case.channel,
                nuisances=case.nuisances, name=case.name, engine=case.engine,
            )  # fmt: skip
    return read_truth(folder / "truth")


_stopped = threading.Event()
"""Set by Ctrl-C: what runs is ended."""


def timed(command: Sequence[str], log: Path) -> tuple[float, float]:
    """(CPU, wall) seconds of a command whose output goes to `log`; RuntimeError if it fails or takes too long."""
    start = time.monotonic()
    with log.open("wb") as out:
        process = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT)
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            if _stopped.is_set():
                process.terminate()
            if time.monotonic() - start > TIME_LIMIT:
                process.kill()
                os.wait4(process.pid, 0)
                process.returncode = -9
                raise RuntimeError(f"took more than {TIME_LIMIT:g} s")
            time.sleep(0.1)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        tail = log.read_text(errors="replace").strip().splitlines()[-1:]
        raise RuntimeError(f"exit status {process.returncode}: {' '.join(tail)}")
    return usage.ru_utime + usage.ru_stime, time.monotonic() - start


def closed(case: Case, folder: Path, command: Sequence[str]) -> dict[str, Any]:
    """One campaign through the loop and before the judge; a run that fails is a row that says so.

    A row that is there already is kept, unless the campaign or the run failed.  Two runs on one folder take turns.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with alone(folder / "case"):
        return _kept(case, folder) or _closed(case, folder, command)


def _kept(case: Case, folder: Path) -> dict[str, Any] | None:
    """The row of an earlier run; None where there is none or it is damaged.

    Raises:
        BadInputError: it is of other nuisances, which the name of a case does not tell.
    """
    try:
        found = json.loads((folder / "row.json").read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        found = None
    whole = isinstance(found, dict) and found.get("failed") == "" and {"case", "truth"} <= set(found)
    of = found["nuisances"] if whole and "nuisances" in found else _nuisances_of(folder)
    wanted = sorted(case.nuisances)
    if of is not None and of != wanted:
        raise BadInputError(f"{folder}: holds a campaign with nuisances {of}, not {wanted}; want another --out")
    return found if whole else None


def _nuisances_of(folder: Path) -> list[str] | None:
    """Nuisances of the campaign that was made there; None where none was."""
    if not (folder / "truth" / "truth.toml").exists():
        return None
    return sorted(read_truth(folder / "truth").about.get("nuisances", []))


def _closed(case: Case, folder: Path, command: Sequence[str]) -> dict[str, Any]:
    kept = folder / "row.json"
    truth = made(case, folder)
    loop, ahead = folder / "loop", str(folder / "predict" / "campaign.toml")
    row: dict[str, Any] = {"case": case.name, "truth": "+".join(truth.effects), "failed": ""}
    row["nuisances"] = sorted(case.nuisances)
    try:
        # A laboratory knows its own gravity; 0.03 % of it would count as 2 % of a worn edge.
        given = [str(folder / "campaign" / "campaign.toml"), "--out", str(loop), "--gravity", str(G)]
        cpu, wall = timed([*command, *given], folder / "loop.log")
        for model, out in (("model", "predict"), ("baseline", "predict-baseline")):
            log = folder / f"{out}.log"
            timed([*command, "predict", str(loop / f"{model}.toml"), ahead, "--out", str(loop / out)], log)
        row |= judge(loop, truth) | {"cpu_s": cpu, "wall_s": wall}
    except (RuntimeError, ValueError, OSError, KeyError) as error:
        row["failed"] = f"{type(error).__name__}: {error}"
        return row
    save_text(json.dumps(row), kept)
    return row


def shown(value: Any) -> str:
    """A cell of the table."""
    if isinstance(value, float):
        return f"{value:.3g}"
    return "-" if value is None or value == "" else str(value)


def _share(rows: Iterable[dict[str, Any]], key: str, *values: Any) -> str:
    found = [r[key] in values for r in rows if r.get(key) is not None]
    return f"{sum(found)}/{len(found)}"


def summary(rows: Sequence[dict[str, Any]]) -> list[str]:
    """Lines on all rows that did not fail."""
    done = [r for r in rows if not r["failed"]]
    known = [r for r in done if r["truth"] and set(r["truth"].split("+")) <= set(NAMED)]
    unknown = [r for r in done if r["truth"] and r not in known]
    null = [r for r in done if not r["truth"]]
    covered, given = (sum(r[k] for r in known) for k in ("covered", "parameters"))

    def median(key: str, some: Sequence[dict[str, Any]]) -> str:
        values = [r[key] for r in some if r.get(key) is not None]
        return f"{np.median(values):.3g}" if values else "-"

    return [
        f"failed                {len(rows) - len(done)}/{len(rows)}",
        f"clean, called none    {_share(null, 'verdict', 'none')}",
        f"named, traced         {_share(known, 'traced', 'exact', 'twin', 'set')}"
        f"  (as named {_share(known, 'traced', 'exact')})",
        f"named, error halved   {_share(known, 'halved', True)}",
        f"no name, unexplained  {_share(unknown, 'verdict', 'unexplained')}",
        f"no name, error halved {_share(unknown, 'halved', True)}",
        f"intervals that cover  {covered}/{given}",
        f"error after / floor   {median('after_over_floor', [*known, *null])} (named and clean), "
        f"{median('after_over_floor', unknown)} (no name)",
        f"claimed / true error  {median('claimed_over_true', done)}",
        f"CPU time              {median('cpu_s', done)} s",
    ]


def report(rows: Sequence[dict[str, Any]], path: Path) -> None:
    """The table on the screen and as CSV; all figures of a campaign are in its row.json."""
    width = max(len(r["case"]) for r in rows)
    print(" ".join([" " * width, *(f"{c:>16.16}" for c in COLUMNS)]))
    for row in rows:
        cells = [f"{row['failed']:.100}"] if row["failed"] else [f"{shown(row.get(c)):>16.40}" for c in COLUMNS]
        print(" ".join([f"{row['case']:<{width}}", *cells]))
    print("\n".join(summary(rows)))
    head = ["case", "truth", *COLUMNS[:3], "covered", "parameters", *COLUMNS[3:], "failed"]

    def write(target: Path) -> None:
        with target.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, head, extrasaction="ignore", lineterminator="\n")
            writer.writeheader()
            writer.writerows({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in r.items()} for r in rows)

    write_whole(path, write)


def _not_had(effect: str, engine: str) -> str:
    """Why a laboratory of that engine does not have it; nothing where it has."""
    try:
        check_together(() if effect == "null" else effect.split("+"), engine)
    except (KeyError, ValueError) as error:
        return str(error)
    return ""


def _check_together(parser: argparse.ArgumentParser, options: argparse.Namespace) -> None:
    """End with a sentence where an option has no say beside another."""
    if options.quick and options.effects:
        parser.error(f"--effects {' '.join(options.effects)}: want it without --quick, which has its own")
    if options.engine != "event" and options.channel != "rotation":
        parser.error(f"--channel {options.channel}: want rotation of the engine {options.engine}, or --engine event")
    if options.channel == "outcome":
        if options.strength != "strong":
            parser.error(f"--strength {options.strength}: want strong with --channel outcome, where it has no say")
        if options.nuisances:
            parser.error(f"--nuisances {' '.join(options.nuisances)}: want none with --channel outcome")


def arguments(given: Sequence[str] | None = None) -> argparse.Namespace:
    """What the command line says."""
    known = ["null", *NAMED, *UNNAMED]
    parser = argparse.ArgumentParser(
        prog="python -m studies.loop_trials", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--effects", nargs="+",
        help=f"of {', '.join(known)}; pairs as a+b, null for none (all that the engine has, and four pairs)",
    )  # fmt: skip
    parser.add_argument("--quick", action="store_true", help="a case or two that the engine has")
    parser.add_argument("--seeds", type=int, default=1, help="campaigns for each")
    parser.add_argument("--first-seed", type=int, default=1001, help="seed of the first (%(default)s)")
    parser.add_argument("--jobs", type=int, default=1, help="campaigns at a time")
    parser.add_argument("--strength", choices=("strong", "weak"), default="strong", help="of the effect (%(default)s)")
    parser.add_argument(
        "--channel", choices=("rotation", "block_acceleration", "outcome"), default="rotation",
        help="what the laboratory hands over (%(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--engine", choices=("event", *OTHERS), default="event",
        help="whose block it is: the laboratory's own, or one of MuJoCo or dem, with fewer effects (%(default)s)",
    )  # fmt: skip
    parser.add_argument("--nuisances", nargs="*", default=[], choices=NUISANCES, help="what else is not ideal there")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of campaigns, runs and table (%(default)s)")
    parser.add_argument("--csv", type=Path, help="the table (loop_trials.csv in that folder)")
    parser.add_argument("--command", default=f"{sys.executable} -m studies.loop", help="what is judged")
    options = parser.parse_args(given)
    _check_together(parser, options)
    if options.quick:
        options.effects = list(QUICK[options.engine])
    for effect in options.effects or ():
        for part in effect.split("+"):
            if part not in known:
                near = get_close_matches(part, known)
                meant = f"; near it: {', '.join(near)}" if near else ""
                parser.error(f"--effects {part!r}: want some of the {len(known)} that --help names{meant}")
        wrong = _not_had(effect, options.engine)
        if wrong:
            parser.error(f"--effects {effect}: {wrong}")
    options.effects = options.effects or [e for e in [*known, *PAIRS] if not _not_had(e, options.engine)]
    if options.engine == "mujoco":
        try:
            by_mujoco.package()
        except ValueError as error:
            parser.error(f"--{error}")
    for name in ("seeds", "jobs"):
        if getattr(options, name) < 1:
            parser.error(f"--{name} {getattr(options, name)}: want 1 or more")
    if options.first_seed < 0:
        parser.error(f"--first-seed {options.first_seed}: want 0 or more")
    if not shlex.split(options.command):
        parser.error(f"--command {options.command!r}: want a program")
    return options


def main(given: Sequence[str] | None = None) -> int:
    """Run the command; 2 where something is wrong with what it was given, 1 if it cannot be written, 130 on Ctrl-C."""
    kept = "campaigns that were closed are kept, the same command goes on"
    _early.loaded()
    _stopped.clear()
    try:
        return _run_trials(arguments(given))
    except BadInputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"error: {said_of(error, kept)}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print(f"interrupted: {kept}", file=sys.stderr)
        return 130


def _run_trials(options: argparse.Namespace) -> int:
    writable_folder(options.out)
    table: Path = options.csv or options.out / "loop_trials.csv"
    if table.is_dir():
        raise BadInputError(f"--csv {table}: want a file")
    writable_folder(table.parent)
    cases = [
        Case(
            () if e == "null" else tuple(e.split("+")), options.first_seed + k,
            options.strength, options.channel, tuple(options.nuisances), options.engine,
        )
        for e in options.effects
        for k in range(options.seeds)
    ]  # fmt: skip
    command = shlex.split(options.command)
    with noted() as interrupt, ThreadPoolExecutor(options.jobs) as pool:
        tasks = [pool.submit(closed, case, (options.out / case.name).resolve(), command) for case in cases]
        try:
            # The bar is closed before anything else is said.
            with tqdm(total=len(tasks), desc="campaigns", unit="campaign") as bar:
                under_way = set(tasks)
                while under_way:
                    for task in first_done(under_way, interrupt):
                        task.result()  # raises what it raised
                        under_way.remove(task)
                        bar.update()
            rows = [task.result() for task in tasks]
        except BaseException:
            _stopped.set()
            pool.shutdown(wait=True, cancel_futures=True)
            raise
    report(rows, table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
