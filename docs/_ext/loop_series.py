"""The trials of the loop by series: shares of right answers and medians, from benchmarks/results/loop_trials.csv."""

from __future__ import annotations

import re
from collections.abc import Iterable
from statistics import median

from result_tables import ROOT, day_of, rows_of

from studies.laboratory.effects import NAMED

TRIALS = ROOT / "benchmarks" / "results" / "loop_trials.csv"
COLUMNS = (
    "series", "campaigns", "clean, called none", "named, traced", "(as named)", "no name, unexplained",
    "error at least halved", "intervals that hold", "error after / floor", "(up to 1.5)", "claimed error within 20 %",
    "CPU [s]",
)  # fmt: skip


def series_of(case: str) -> str:
    """The seed of a campaign, with what is odd about it: the engine, or the channel."""
    name, _, seed = case.rpartition("-")
    odd = re.sub(r"^[a-z_+]+-?", "", name)
    return f"{seed}, {odd.replace('_', ' ')}" if odd else seed


def _share(right: Iterable[bool]) -> str:
    found = list(right)
    return f"{sum(found)}/{len(found)}" if found else "-"


def _row(series: str, rows: list[dict[str, str]]) -> list[str]:
    done = [r for r in rows if not r["failed"]]
    # A run that failed has no right answer.
    clean = [r for r in rows if not r["truth"]]
    named = [r for r in rows if r["truth"] and set(r["truth"].split("+")) <= set(NAMED)]
    unnamed = [r for r in rows if r["truth"] and r not in named]
    # Errors of accelerometers are those of impacts that come a moment too soon or late; no floor was worked out.
    halved = [r for r in (*named, *unnamed) if r["before"] and r["after"] and r["after_over_floor"]]
    over = [float(r["after_over_floor"]) for r in done if r["after_over_floor"]]
    claimed = [float(r["claimed_over_true"]) for r in done if r["claimed_over_true"]]
    hold, given = (sum(int(r[k]) for r in named if r["covered"]) for k in ("covered", "parameters"))
    return [
        series,
        str(len(rows)),
        _share(r["verdict"] == "none" for r in clean),
        _share(r["traced"] in ("exact", "twin", "set") for r in named),
        _share(r["traced"] == "exact" for r in named),
        _share(r["verdict"] == "unexplained" for r in unnamed),
        _share(float(r["after"]) <= 0.5 * float(r["before"]) for r in halved),
        f"{hold}/{given}" if given else "-",
        f"{median(over):.2f}" if over else "-",
        _share(x <= 1.5 for x in over),
        _share(abs(x - 1.0) <= 0.2 for x in claimed),
        f"{median(float(r['cpu_s']) for r in done):.0f}" if done else "-",
    ]


def series_text() -> str:
    """A table with a row for each series, the latest first."""
    by: dict[str, list[dict[str, str]]] = {}
    for row in rows_of(TRIALS):
        by.setdefault(series_of(row["case"]), []).append(row)
    latest = sorted(by, key=lambda s: (-int(s.partition(",")[0]), s))
    lines = [f"| {' | '.join(COLUMNS)} |", "|" + "---|" * len(COLUMNS)]
    lines += [f"| {' | '.join(_row(s, by[s]))} |" for s in latest]
    note = f"*Counted from `benchmarks/results/loop_trials.csv`, of {day_of(TRIALS)}.*"
    return "\n".join([note, "", "::::{container} measured", *lines, "::::"])
