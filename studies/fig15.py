"""Fig. 15 of Winkler, Meguro & Yamazaki (1995): criteria of rocking of Blocks 5, 6, 3 and 7, of one height.

See          every block begins to rock near its own (b/h) g; what a real table does to that is shown beside it.
Paper says   the analytic criteria are almost constant over frequency, some of the tests fall with it; an uneven
             envelope bends them; slender blocks feel their base and vertical disturbance more than stocky ones.
Run          python -m studies.fig15 [--quick]  ->  build/studies/fig15.nc, then fig15.png and .pdf, and
             fig15_disturbances.png and .pdf
"""

from __future__ import annotations

import argparse
import math
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from rocking.effect import Effect
from rocking.effects.base_tilt import BaseTilt
from rocking.effects.rounded_edges import RoundedEdges
from rocking.effects.table_pitch import TablePitch
from rocking.effects.vertical_motion import VerticalMotion
from studies.claims.bounds import CLAIMS
from studies.criteria.columns import G
from studies.criteria.rocking_onset import OnsetJob, OnsetSettings, onset
from studies.families import onset as onset_figures
from studies.families.onset import BLOCK_COLOURS, STYLES, OnsetPlan
from studies.running.labelled import gathered, names_axis
from studies.running.parts import Parts
from studies.running.plot import caption, new_figure
from studies.running.statements import Finding, listed, table
from studies.running.study import Study
from studies.specimens import specimen

BLOCKS = (3, 5, 6, 7)

PITCH, TILT, RADIUS, VERTICAL, UNEVEN = 5e-4, 5e-3, 1e-3, 0.1, 0.1
"""Sizes of the disturbances: [rad] while the base has the acceleration (b/h) g, [rad], [m], [1], [1]."""

DISTURBANCES = {
    "pitch": f"table pitches by {1e3 * PITCH:g} mrad",
    "tilt": f"floor tilted by {1e3 * TILT:g} mrad",
    "edges": f"edges worn to a radius of {1e3 * RADIUS:g} mm",
    "vertical": f"vertical motion, {VERTICAL:g} of the horizontal",
    "envelope": f"envelope uneven by {100 * UNEVEN:g} %",
}


def _disturbed(kind: str, block: int, sign: float, settings: OnsetSettings) -> OnsetSettings:
    """The settings with one disturbance, this way or the other."""
    x = specimen(block)
    effects: dict[str, tuple[Effect, ...]] = {
        "pitch": (TablePitch(per_acceleration=sign * PITCH / (x.b / x.h * G)),),
        "tilt": (BaseTilt(angle=sign * TILT),),
        "edges": (RoundedEdges(radius=RADIUS),),
        "vertical": (VerticalMotion(ratio=sign * VERTICAL),),
        "envelope": (),
    }
    if kind == "envelope":
        return OnsetSettings(settings.ramp, settings.duration, UNEVEN, 1 if sign > 0 else 2, settings.friction)
    return OnsetSettings(settings.ramp, settings.duration, friction=settings.friction, effects=effects[kind])


def _disturbances(plan: OnsetPlan, parts: Parts) -> dict[str, Any]:
    """Change of Method 1's criterion by each disturbance, this way and the other."""
    signs = (1.0, -1.0)
    jobs = [
        OnsetJob("method1", block, frequency, _disturbed(kind, block, sign, plan.settings))
        for kind, sign, block, frequency in product(DISTURBANCES, signs, plan.blocks, plan.frequencies)
    ]
    shape = (len(DISTURBANCES), len(signs), len(plan.blocks), len(plan.frequencies))
    labels = {
        "lift_acceleration": ("m s-2", "magnitude of the base acceleration at lift-off, disturbed (Method 1)"),
        "onset_acceleration": ("m s-2", "largest base acceleration until motion follows, disturbed (Method 1)"),
    }
    results = parts.results(jobs, onset, "fig15 disturbances")
    found = gathered(results, ("disturbance", "way", "block", "frequency"), shape, labels)
    return {f"disturbed_{name}": variable for name, variable in found.items()}


def dataset(plan: OnsetPlan, parts: Parts) -> xr.Dataset:
    """Criteria of rocking over (method, block, frequency), and Method 1's over (disturbance, way, block, frequency)."""
    ds = onset_figures.dataset(plan, parts, "fig15").assign(_disturbances(plan, parts))
    plain = replace(plan.settings, form="nonlinear")
    jobs = [OnsetJob("method1", block, frequency, plain) for block, frequency in product(plan.blocks, plan.frequencies)]
    label = {"onset_acceleration": ("m s-2", "largest base acceleration until motion follows (Method 1, nonlinear)")}
    shape = (len(plan.blocks), len(plan.frequencies))
    nonlinear = gathered(parts.results(jobs, onset, "fig15 nonlinear"), ("block", "frequency"), shape, label)
    ds = ds.assign(nonlinear_onset_acceleration=nonlinear["onset_acceleration"])
    ds = ds.assign_coords(names_axis("disturbance", list(DISTURBANCES), "what is not ideal"))
    return ds.assign_coords(
        way=("way", [1.0, -1.0], {"units": "1", "long_name": "sign of the disturbance, or its seed"})
    )


def changes(ds: xr.Dataset) -> xr.DataArray:
    """Relative change of the criterion by each disturbance; of what is put in at lift-off, but for the envelope."""
    lift = ds.disturbed_lift_acceleration / ds.lift_acceleration.sel({"method": "method1"}) - 1.0
    # Effects act on the nonlinear equations, an uneven envelope on those of the figure.
    motion = ds.disturbed_onset_acceleration / ds.onset_acceleration.sel({"method": "method1"}) - 1.0
    return lift.where(ds.disturbance != "envelope", motion).drop_vars("method")


def figure(ds: xr.Dataset) -> Figure:
    """One panel a method, stocky blocks first."""
    return onset_figures.figure(
        ds.sortby("alpha", ascending=False),
        "After Fig. 15 of Winkler, Meguro & Yamazaki (1995). Notice: each block begins to rock at its own (b/h) g, at "
        "every frequency and by every method. Lines: largest acceleration until a corner is 0.05 mm off the floor; "
        "dashes: at lift-off itself.",
    )


def disturbances_figure(ds: xr.Dataset) -> Figure:
    """Change of the criterion by each disturbance, by block."""
    ds = ds.sortby("alpha", ascending=False)
    change = 100.0 * changes(ds)
    kinds = [str(kind) for kind in ds.disturbance.values]
    fig = new_figure(3.1 * len(kinds) + 0.4, 4.3)
    axes = fig.subplots(1, len(kinds), sharex=True)
    for ax, kind in zip(axes, kinds, strict=True):
        for i, block in enumerate(ds.block.values):
            for way in ds.way.values:
                curve = change.sel(disturbance=kind, way=way, block=block)
                label = f"Block {int(block)}, b/h = {float(curve.b / curve.h):.1f}" if way > 0 else None
                ax.plot(
                    ds.frequency, curve, color=BLOCK_COLOURS[i], ls=STYLES[i], marker="osD^"[i], ms=3.5, label=label
                )
        ax.set_title(DISTURBANCES[kind], fontsize=9.5)
        ax.set_xlabel("Frequency of the base motion [Hz]")
        ax.axhline(0.0, color="0.4", lw=0.8)
        ax.grid(alpha=0.3)
    axes[0].set_ylabel("Change of the acceleration at\nthe start of rocking [%]")
    axes[0].legend(fontsize=8)
    caption(
        fig,
        "What a real table and real edges do to Method 1's criteria, each disturbance one way and the other. Notice: a "
        "pitch too small to see acts through its acceleration, hence more at high frequency and on slender blocks; "
        "tilt and worn edges also act more on slender blocks; vertical motion in proportion to the horizontal one acts "
        "more on stocky ones, which need more of it. Each panel has its own scale.",
    )
    return fig


def _slope(ds: xr.Dataset, curve: xr.DataArray) -> float:
    """Change along the straight line of best fit from the lowest to the highest frequency, over the mean.

    NaN where a point of the curve is not known.
    """
    if not bool(curve.notnull().all()):
        return math.nan
    rate = np.polyfit(ds.frequency.values, curve.values, 1)[0]
    return float(rate * (ds.frequency[-1] - ds.frequency[0]) / curve.mean())


def check(ds: xr.Dataset) -> xr.Dataset:
    """The paper's statements on Fig. 15."""
    motion = onset_figures.departures(ds, "onset_acceleration")
    a = ds.onset_acceleration
    slopes = {
        f"{method}, Block {int(block)}": _slope(ds, a.sel({"method": method, "block": block}))
        for method in ("method1", "method2")
        for block in ds.block.values
    }
    method2 = a.sel({"method": "method2"})
    apart = {
        "linear Method 1": onset_figures.largest(np.abs(method2 / a.sel({"method": "method1"}) - 1.0)),
        "nonlinear Method 1": onset_figures.largest(np.abs(method2 / ds.nonlinear_onset_acceleration - 1.0)),
    }
    change = abs(changes(ds)).max(dim=["way", "frequency"], skipna=False)
    felt = {
        kind: float(change.sel(disturbance=kind, block=7) / change.sel(disturbance=kind, block=5))
        for kind in DISTURBANCES
    }
    at_5_hz = abs(changes(ds)).isel(frequency=-1).max("way", skipna=False).sel(block=3)
    pitched = ds.disturbed_lift_acceleration.sel(disturbance="pitch", block=3).min("way", skipna=False)
    tenth = {kind: 0.1 / float(at_5_hz.sel(disturbance=kind)) for kind in ("pitch", "edges", "vertical")}
    base = {kind: felt[kind] for kind in ("pitch", "tilt", "edges")}
    return table(
        [
            Finding(CLAIMS["fig15.motion"], onset_figures.largest(motion), listed(onset_figures.by_method(motion))),
            Finding(CLAIMS["fig15.constant"], float(np.max(np.abs(list(slopes.values())))), listed(slopes)),
            Finding(CLAIMS["fig15.methods"], apart["linear Method 1"], listed(apart)),
            Finding(CLAIMS["fig15.envelope"], onset_figures.largest(change.sel(disturbance="envelope"))),
            Finding(CLAIMS["fig15.slender_base"], float(np.min(list(base.values()))), listed(base)),
            Finding(CLAIMS["fig15.slender_vertical"], felt["vertical"]),
            Finding(CLAIMS["fig15.pitch"], tenth["pitch"] * PITCH),
            Finding(CLAIMS["fig15.worn"], tenth["edges"] * RADIUS),
            Finding(CLAIMS["fig15.vertical"], tenth["vertical"] * VERTICAL),
            Finding(CLAIMS["fig15.inclination"], _slope(ds, pitched)),
        ]
    )


def _plan(options: argparse.Namespace) -> OnsetPlan:
    return onset_figures.plan_of(BLOCKS, options)


STUDY = Study(
    name="fig15",
    title="Criteria of rocking of blocks of different slenderness, and what disturbs them (Fig. 15)",
    about=(
        "At which acceleration do blocks of one height begin to rock, and how far do a pitching table, a tilted floor, "
        "worn edges, vertical motion and an uneven envelope move it?"
    ),
    plan=_plan,
    dataset=dataset,
    figures={"fig15": figure, "fig15_disturbances": disturbances_figure},
    check=check,
    arguments=onset_figures.arguments,
    example='(ds.onset_acceleration / ds.west).plot.line(x="frequency", col="method")',
)

if __name__ == "__main__":
    STUDY.run()
