"""Which stones fall in an earthquake: overturning over size and slenderness, and what fallen stones tell.

See          slender and small stones fall; of one shape the larger is the safer, which West's formula cannot know.
Paper says   peak accelerations were read off fallen tombstones by West's formula, and the results are controversial.
Asks         which size and slenderness are safe; how far West's formula turned round is from the truth; how fragility
             by peak velocity and Ishiyama's two limits compare with simulated falls.
Run          python -m studies.tombstones [--quick]  ->  build/studies/tombstones.nc, then tombstones.png and .pdf, and
             tombstones_fragility.png and .pdf
Source       motions: Kanai (1957), Tajimi (1960), Clough & Penzien (1975), as of `excitation.KanaiTajimi`; limits:
             Ishiyama (1982)
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator
from numpy.typing import NDArray

from excitation import KanaiTajimi, Record, scaled_to
from excitation.intensities import peak
from rocking import Block, Method1, solve_batch
from rocking.closed_forms import ishiyama_velocity, west_acceleration
from studies.claims.bounds import CLAIMS
from studies.criteria.columns import G
from studies.running.labelled import PAPER, names_axis
from studies.running.parts import Parts
from studies.running.plot import caption, new_figure
from studies.running.statements import Finding, listed, table
from studies.running.study import Study

GROUNDS = {"firm": 2.5, "soft": 1.0}
"""Ground frequencies of the synthetic motions [Hz]."""

TIME_STEP, DURATION = 0.01, 20.0


@dataclass(frozen=True)
class Plan:
    """What is computed."""

    heights: tuple[float, ...] = tuple(np.geomspace(0.25, 4.0, 9).round(4).tolist())
    slenderness: tuple[float, ...] = tuple(np.linspace(0.1, 0.5, 9).round(4).tolist())
    peaks: tuple[float, ...] = tuple((np.geomspace(0.1, 4.0, 30) * G).round(5).tolist())
    records: int = 24


@dataclass(frozen=True)
class Job:
    """All stones under the motions of one ground at one peak acceleration [m/s^2]."""

    ground: str
    peak: float
    records: int
    heights: tuple[float, ...]
    slenderness: tuple[float, ...]


def record_of(ground: str, seed: int) -> Record:
    """A synthetic motion with a peak of 1 m/s^2."""
    made = KanaiTajimi(1.0, DURATION, ground_frequency=GROUNDS[ground]).record(TIME_STEP, seed)
    return scaled_to(made, pga=1.0)


def _stones(job: Job) -> dict[str, Any]:
    """Which stones fall, shape (height, slenderness, record)."""
    blocks = [Block(ratio * h, h) for h, ratio in product(job.heights, job.slenderness)]
    motions = [
        scaled_to(record_of(job.ground, seed), pga=job.peak).motion(interpolation="linear")
        for seed in range(job.records)
    ]
    systems = [Method1(block, form="nonlinear") for block in blocks for _ in motions]
    done = solve_batch(systems, motions * len(blocks), t_end=DURATION + 5.0, solver="taylor")
    shape = (len(job.heights), len(job.slenderness), job.records)
    return {"fell": done.overturned.reshape(shape), "failed": int(np.sum(done.outcome == 3))}


def dataset(plan: Plan, parts: Parts) -> xr.Dataset:
    """Whether a stone falls over (ground, peak, h, slenderness, record)."""
    grounds = tuple(GROUNDS)
    jobs = [Job(g, a, plan.records, plan.heights, plan.slenderness) for g, a in product(grounds, plan.peaks)]
    results = parts.results(jobs, _stones, "tombstones")
    failed = sum(result["failed"] for result in results)
    if failed:
        raise RuntimeError(f"{failed} runs failed; want none")
    dims = ("ground", "peak", "h", "slenderness", "record")
    shape = (len(grounds), len(plan.peaks), len(plan.heights), len(plan.slenderness), plan.records)
    fell = np.array([result["fell"] for result in results]).reshape(shape)
    velocity = [[peak(record_of(g, seed).velocity) for seed in range(plan.records)] for g in grounds]
    flags = {"flag_values": np.array([0, 1], dtype=np.int8), "flag_meanings": "stands falls"}
    ds = xr.Dataset(
        {
            "fell": (dims, fell.astype(np.int8), {"long_name": "whether the stone falls", **flags}),
            "velocity": (
                ("ground", "record"), velocity, {"units": "s", "long_name": "peak velocity over peak acceleration"},
            ),
        },
        coords=names_axis("ground", grounds, "ground")
        | {
            "peak": ("peak", list(plan.peaks), {"units": "m s-2", "long_name": "peak acceleration of the motion"}),
            "h": ("h", list(plan.heights), {"units": "m", "long_name": "height of the stone"}),
            "slenderness": (
                "slenderness", list(plan.slenderness), {"units": "1", "long_name": "breadth over height of the stone"},
            ),
            "record": ("record", list(range(plan.records)), {"units": "1", "long_name": "seed of the motion"}),
        },
    )  # fmt: skip
    limits = np.array([[ishiyama_velocity(Block(r * h, h)) for r in plan.slenderness] for h in plan.heights])
    ds["ishiyama"] = (
        ("h", "slenderness"),
        limits,
        {"units": "m s-1", "long_name": "Ishiyama's limit of peak velocity"},
    )
    west = [west_acceleration(ratio, 1.0) for ratio in plan.slenderness]
    ds["west"] = ("slenderness", west, {"units": "m s-2", "long_name": "(b/h) g"})
    return ds.assign_attrs(references=f"{PAPER}, Introduction; Ishiyama (1982)", model="Method 1, nonlinear")


def least(ds: xr.Dataset) -> xr.DataArray:
    """Least peak acceleration of those computed that fells a stone [m/s^2]; NaN if none does."""
    falls = ds.fell.astype(bool)
    return ds.peak.where(falls).min("peak").rename("least felling acceleration")


def _heights(axis: Any, set_scale: Any) -> None:
    """A logarithmic axis of heights with plain numbers."""
    set_scale("log")
    axis.set_major_locator(FixedLocator([0.25, 0.5, 1.0, 2.0, 4.0]))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_locator(NullLocator())


def _map(ax: Any, ds: xr.Dataset, ground: str, level: float) -> Any:
    at = ds.sel(ground=ground).sel(peak=level * G, method="nearest")
    share = at.fell.mean("record")
    mesh = ax.pcolormesh(ds.slenderness, ds.h, share, vmin=0.0, vmax=1.0, cmap="cividis", shading="nearest")
    if min(share.shape) > 1:
        velocity = float(at.velocity.median()) * float(at.peak)
        lines = ax.contour(ds.slenderness, ds.h, ds.ishiyama / velocity, levels=[1.0], colors="w", linestyles="--")
        ax.clabel(lines, fmt="Ishiyama", fontsize=8)
    ax.axvline(float(at.peak) / G, color="w", lw=1.4, ls=":")
    ax.set_xlim(float(ds.slenderness.min()) - 0.025, float(ds.slenderness.max()) + 0.025)
    _heights(ax.yaxis, ax.set_yscale)
    ax.set_title(f"{ground} ground, peak {float(at.peak) / G:.2g} g", fontsize=10)
    ax.set_xlabel("b/h")
    return mesh


def figure(ds: xr.Dataset) -> Figure:
    """Share of motions that fell a stone, over size and slenderness."""
    levels = (0.3, 0.6, 1.2)
    fig = new_figure(11.5, 7.0)
    axes = fig.subplots(len(GROUNDS), len(levels), sharex=True, sharey=True)
    for row, ground in zip(axes, ds.ground.values, strict=True):
        for ax, level in zip(row, levels, strict=True):
            mesh = _map(ax, ds, str(ground), level)
        row[0].set_ylabel("Height [m]")
    fig.colorbar(mesh, ax=axes, label="Share of the motions that fell the stone", shrink=0.8)
    caption(
        fig,
        f"Stones under {ds.sizes['record']} synthetic motions on firm and soft ground, by Method 1. Notice: left of "
        "the dotted line (West) a stone begins to rock, but it falls only well to the left of it, and the less the "
        "larger it is; above the dashed line (Ishiyama's peak velocity) next to none falls.",
    )
    return fig


def _curve(ax: Any, x: NDArray[np.float64], fell: NDArray[np.bool_], colour: str, label: str, marker: str) -> None:
    """Share that falls by classes of x."""
    edges = np.geomspace(0.3, 30.0, 22)
    place = np.digitize(x, edges)
    counts = np.bincount(place, minlength=edges.size + 1)[1:-1]
    falls = np.bincount(place, weights=fell, minlength=edges.size + 1)[1:-1]
    with np.errstate(invalid="ignore"):
        share = np.where(counts > 20, falls / counts, np.nan)
    ax.plot(np.sqrt(edges[1:] * edges[:-1]), share, color=colour, marker=marker, ms=4, label=label)


def fragility_figure(ds: xr.Dataset) -> Figure:
    """Share of falls by peak acceleration and by peak velocity; what West's formula misses."""
    fig = new_figure(12.0, 4.6)
    left, middle, right = fig.subplots(1, 3)
    for ax, by in ((left, "acceleration"), (middle, "velocity")):
        for ground, colour, marker in zip(ds.ground.values, ("#0072B2", "#D55E00"), "os", strict=True):
            at = ds.sel(ground=ground)
            x = at.peak / at.west if by == "acceleration" else at.peak * at.velocity / at.ishiyama
            x, fell = xr.broadcast(x, at.fell)
            _curve(ax, x.values.ravel(), fell.transpose(*x.dims).values.ravel() > 0, colour, f"{ground} ground", marker)
        ax.axvline(1.0, color="0.4", lw=1, ls=":")
        ax.set_xscale("log")
        ax.set_ylim(0.0, 1.02)
        ax.grid(alpha=0.3)
        ax.legend(fontsize=8)
    left.set_xlabel("Peak acceleration over (b/h) g")
    middle.set_xlabel("Peak velocity over Ishiyama's limit")
    left.set_ylabel("Share of stones that fall")
    for ground, colour in zip(ds.ground.values, ("#0072B2", "#D55E00"), strict=True):
        factor = (least(ds) / ds.west).sel(ground=ground)
        middle_of = factor.median(["slenderness", "record"])
        right.fill_between(
            ds.h, factor.quantile(0.05, ["slenderness", "record"]), factor.quantile(0.95, ["slenderness", "record"]),
            color=colour, alpha=0.2, lw=0,
        )  # fmt: skip
        right.plot(ds.h, middle_of, color=colour, label=f"{ground} ground")
    _heights(right.xaxis, right.set_xscale)
    right.set_ylim(bottom=0.0)
    right.set_xlabel("Height of the stone [m]")
    right.set_ylabel("Least felling acceleration over (b/h) g")
    right.axhline(1.0, color="0.4", lw=1, ls=":")
    right.grid(alpha=0.3)
    right.legend(fontsize=8)
    caption(
        fig,
        "What fallen stones tell. Notice: the share that falls rises from nothing to all over a wide range of the "
        "peak acceleration (left) and of the peak velocity (middle), differently on each ground; next to none falls "
        "below the limits of West and Ishiyama (dotted). Right: the acceleration that it took, over what West's "
        "formula gives; median and 90 % of all shapes and motions.",
    )
    return fig


def check(ds: xr.Dataset) -> xr.Dataset:
    """What West's formula misses, and how Ishiyama's limits do."""
    felling = least(ds)
    factor = felling / ds.west
    wrong = np.maximum(factor, 1.0 / factor)
    by_ground = {str(g): float(wrong.sel(ground=g).quantile(0.95)) for g in ds.ground.values}
    speed = ds.peak * ds.velocity / ds.ishiyama
    below = (ds.peak < ds.west) | (speed < 1.0)
    falls = ds.fell.astype(bool)
    velocity = felling * ds.velocity / ds.ishiyama
    spread = {"velocity": float(np.log(velocity).std()), "acceleration": float(np.log(factor).std())}
    medians = felling.fillna(np.inf).median("record")
    larger = medians / medians.shift(h=1)
    larger = larger.where(np.isfinite(medians) & np.isfinite(medians.shift(h=1)))
    return table(
        [
            Finding(CLAIMS["tombstones.misleads"], float(wrong.quantile(0.95)), listed(by_ground)),
            Finding(CLAIMS["tombstones.ishiyama"], float((falls & below).sum() / falls.sum())),
            Finding(CLAIMS["tombstones.velocity"], spread["velocity"] / spread["acceleration"], listed(spread)),
            Finding(CLAIMS["tombstones.larger"], float(larger.min())),
        ]
    )


def plan_of(options: argparse.Namespace) -> Plan:
    """The plan that the command line asks for."""
    if options.quick:
        full = Plan()
        return Plan(full.heights[::4], full.slenderness[::4], full.peaks[::5], 4)
    return Plan()


STUDY = Study(
    name="tombstones",
    title="Which stones fall in an earthquake, and what fallen stones tell",
    about="Overturning over size and slenderness under synthetic motions; West's formula; Ishiyama's limits.",
    plan=plan_of,
    dataset=dataset,
    figures={"tombstones": figure, "tombstones_fragility": fragility_figure},
    check=check,
    example='ds.fell.mean("record").sel(ground="firm").isel(peak=-1).plot()',
)

if __name__ == "__main__":
    STUDY.run()
