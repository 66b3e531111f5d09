"""How often the loop's 95 % intervals hold what was planted, the effect being given and its numbers alone fitted.

Cases    one campaign for each effect and seed of the virtual laboratory (studies.laboratory shares no code with the
         models); nothing is searched for, so that many campaigns can be afforded
Measure  share of the planted numbers within their intervals, and how they lie about them: (found - planted) over the
         standard deviation, whose mean square is 1 if intervals are neither too wide nor too narrow
Run      python -m studies.loop_coverage [--effects a b] [--seeds N]  ->  a table, and
         build/studies/loop_coverage/loop_coverage.csv; campaigns that were fitted are not fitted again
"""

from __future__ import annotations

import argparse
import csv
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from studies.campaigns import read
from studies.laboratory.effects import NAMED, SPOKEN
from studies.laboratory.parameters import G
from studies.loop.records.preparing import as_declared, prepare
from studies.loop.swings.tracing import all_candidates, baseline, search
from studies.loop.whole.settling import intervals, settle
from studies.loop.whole.whole_fits import whole_fit
from studies.loop_trials import Case, made
from studies.running.command_line import run
from studies.running.files import save_text, writable_folder, write_whole
from studies.running.lock import alone

OUT = Path("build/studies/loop_coverage")
COLUMNS = ("effect", "seed", "form", "parameter", "planted", "found", "low", "high", "z", "held")
IN_95 = 1.96
KEPT = "campaigns that were fitted are kept, the same command goes on"
NOT_IN_SWINGS = ("base_adhesion",)
"""Effects that no swing shows: the loop finds them by scanning whole records alone."""


def fitted(case: Case, folder: Path) -> list[dict[str, Any]]:
    """Rows of one campaign, one for each planted number that the loop gives an interval of.

    Raises:
        ValueError: the effect cannot be fitted to it; it says why.
    """
    truth = made(case, folder)
    campaign = read(folder / "campaign" / "campaign.toml")
    setup = prepare(campaign, as_declared(campaign, G))
    plain = baseline(setup.simulator, setup.start, setup.swings)
    effect = SPOKEN.get(case.effects[0], case.effects[0])
    known = all_candidates(plain.swing.model, campaign.conditions.friction)
    tried = search(setup.simulator, plain, [c for c in known if c.effect == effect])
    if tried.best is None:
        raise ValueError(f"{case.name}: {'; '.join(f'{form}: {why}' for form, why in tried.skipped.items())}")
    settled = settle(setup, tried.best, whole_fit(setup, tried.best))
    rows = []
    for name, (found, low, high) in intervals(tried.best, settled).items():
        if name not in truth.parameters:
            continue
        planted = truth.parameters[name]
        half = (found - low) if planted < found else (high - found)
        z = IN_95 * (found - planted) / half if half > 0.0 else float("nan")
        rows.append(
            {
                "effect": case.effects[0], "seed": case.seed, "form": tried.best.names[-1], "parameter": name,
                "planted": planted, "found": found, "low": low, "high": high, "z": z, "held": low <= planted <= high,
            }
        )  # fmt: skip
    return rows


def summary(rows: Sequence[dict[str, Any]]) -> list[str]:
    """How often intervals hold, for each effect and for all."""
    lines = []
    for effect in [*dict.fromkeys(r["effect"] for r in rows), ""]:
        own = [r for r in rows if effect in ("", r["effect"])]
        z = np.array([r["z"] for r in own])
        held = sum(bool(r["held"]) for r in own)
        lines.append(
            f"{effect or 'all':32s} {held:4d} of {len(own):4d} held ({held / max(len(own), 1):4.0%}), root mean square "
            f"of z {np.sqrt(np.mean(z**2)) if own else float('nan'):.2f}"
        )
    return lines


def arguments(given: Sequence[str] | None = None) -> argparse.Namespace:
    """What the command line says."""
    known = [name for name in NAMED if name not in NOT_IN_SWINGS]
    parser = argparse.ArgumentParser(
        prog="python -m studies.loop_coverage",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--effects", nargs="+", default=known, help="names (all that swings show)")
    parser.add_argument("--seeds", type=int, default=5, help="campaigns for each (%(default)s)")
    parser.add_argument("--first-seed", type=int, default=1001, help="seed of the first (%(default)s)")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of campaigns and table (%(default)s)")
    options = parser.parse_args(given)
    for name in options.effects:
        if name not in known:
            parser.error(f"--effects {name!r}: want some of {', '.join(known)}")
    if options.seeds < 1:
        parser.error(f"--seeds {options.seeds}: want 1 or more")
    if options.first_seed < 0:
        parser.error(f"--first-seed {options.first_seed}: want 0 or more")
    return options


def main(given: Sequence[str] | None = None) -> None:
    """Run the command."""
    options = arguments(given)
    out = writable_folder(options.out)
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    cases = [Case((e,), seed, "strong", "rotation", ()) for seed in seeds for e in options.effects]
    rows: list[dict[str, Any]] = []
    with tqdm(cases, desc="campaigns", unit="campaign") as bar:
        for case in bar:
            bar.set_postfix_str(case.name)
            try:
                rows += _kept_or_fitted(case, out / case.name)
            except ValueError as error:
                bar.write(f"not fitted: {error}")
    width = max((len(r["parameter"]) for r in rows), default=0)
    for r in rows:
        sign = "" if r["held"] else "  missed"
        print(
            f"{r['effect']}-{r['seed']:<8d} {r['parameter']:<{width}} {r['planted']:.6g} found {r['found']:.6g} "
            f"({r['low']:.6g} to {r['high']:.6g}), z {r['z']:.2f}{sign}"
        )
    print("\n".join(summary(rows)))

    def write(target: Path) -> None:
        with target.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
            writer.writeheader()
            writer.writerows({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in r.items()} for r in rows)

    write_whole(out / "loop_coverage.csv", write)


def _kept_or_fitted(case: Case, folder: Path) -> list[dict[str, Any]]:
    """Rows that are there from an earlier run, or those of a fit now."""
    folder.mkdir(parents=True, exist_ok=True)
    with alone(folder / "case"):
        kept = folder / "coverage.json"
        try:
            rows = json.loads(kept.read_text(encoding="utf-8"))
        except (OSError, ValueError, RecursionError):
            rows = None
        if isinstance(rows, list) and all(isinstance(r, dict) and set(COLUMNS) <= set(r) for r in rows):
            return rows
        rows = fitted(case, folder)
        save_text(json.dumps(rows), kept)
        return rows


if __name__ == "__main__":
    run(main, KEPT)
