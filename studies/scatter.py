"""Scatter: what is predictable and what only in statistics; and how short, low and effective jumps are.

See          at low frequency the runs fall together; where a block rocks for long, changes of the ramp by parts in a
             million move the fall by far more, and only the distribution means anything.
Paper says   jumps are short and low and yet displace the block, and passing over the smallest nuance one may come to
             an essentially different final state (Method 2).
Run          python -m studies.scatter [--quick]  ->  build/studies/scatter.nc, then scatter.png and .pdf
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from rocking import Method2, Mode, solve
from rocking.instruments import marker
from studies.claims.bounds import CLAIMS
from studies.criteria.columns import Column, ColumnJob, ColumnSettings, G, criterion
from studies.criteria.overturning import METHOD_LABELS, Settings, overturning
from studies.running.command_line import positive
from studies.running.files import BadInputError
from studies.running.labelled import FREQUENCIES, QUICK_FREQUENCIES, frequency_axis, gathered, names_axis
from studies.running.parts import Parts
from studies.running.plot import COLOURS, caption, new_figure
from studies.running.statements import Finding, listed, table
from studies.running.study import Study
from studies.specimens import specimen

BLOCK = 3
METHODS = ("method1", "method2", "dem")
TINY = 1e-6
"""Step between the ramps, relative [1]."""

JUMPS_AT = 3.0
"""Frequency at which jumps are looked at [Hz]."""

BOUNCE = 0.3
"""Normal restitution of the run whose jumps are looked at [1]; without any, Method 2 hardly ever jumps."""

SAMPLE = 2e-4
"""Time between samples of the run whose jumps are looked at [s]."""


@dataclass(frozen=True)
class Plan:
    """What is computed."""

    frequencies: tuple[float, ...] = FREQUENCIES
    members: int = 12
    settings: Settings = field(default_factory=Settings)


@dataclass(frozen=True)
class Job:
    """One run."""

    method: str
    frequency: float
    change: float  # of the ramp [1]
    settings: Settings


def _amplitude(job: Job) -> dict[str, Any]:
    """Envelope at overturning [m/s^2] of one run; NaN where the block stands at the end of the ramp."""
    ramp = job.settings.ramp * (1.0 + job.change)
    if job.method == "dem":
        settings = ColumnSettings(ramp, job.settings.duration, job.settings.friction, block=BLOCK)
        return {"amplitude": criterion(ColumnJob(Column(1), job.frequency, settings))["overturning_amplitude"]}
    varied = Settings(ramp=ramp, duration=job.settings.duration, friction=job.settings.friction)
    return {"amplitude": overturning(job.method, specimen(BLOCK), job.frequency, varied).amplitude}


def jumps(settings: Settings, frequency: float, bounce: float) -> dict[str, Any]:
    """Lengths [s] and heights [m] of the jumps of one run by Method 2, and the share of the path made in them."""
    system = Method2(specimen(BLOCK), friction=settings.friction, normal_restitution=bounce)
    t = np.arange(0.0, settings.duration, SAMPLE)
    run = solve(system, settings.motion(frequency), t_end=settings.duration, save_at=t)
    fell = run.overturning_time if run.overturned else run.t_end
    flying = (Mode.TRANSLATION_JUMP, Mode.ROTATION_JUMP)
    edges = np.append(run.events.t, run.t_end)
    aloft = np.isin(run.events.mode_after, flying) & (run.events.t < fell)
    begins = aloft & ~np.isin(run.events.mode_before, flying)
    starts, ends = run.events.t[begins], []
    for start in starts:
        k = int(np.searchsorted(run.events.t, start))
        while k < aloft.size and aloft[k]:
            k += 1
        ends.append(min(edges[k], fell))
    z = run.y[:, system.state_names.index("z")]
    windows = [slice(*np.searchsorted(run.t, (a, b))) for a, b in zip(starts, ends, strict=True)]
    heights = np.array([z[w].max() if z[w].size else 0.0 for w in windows])
    path = np.abs(np.diff(marker(run, (0.0, 0.0))[0]))
    before = run.t[1:] <= fell
    inside, whole = np.isin(run.mode[1:], flying) & before, float(path[before].sum())
    return {
        "length": np.array(ends) - starts, "height": np.maximum(heights, 0.0),
        "share": float(path[inside].sum()) / whole if whole > 0.0 else np.nan,  # it stood still
    }  # fmt: skip


def dataset(plan: Plan, parts: Parts) -> xr.Dataset:
    """Amplitudes over (method, frequency, member), and the jumps of one run over `jump`."""
    changes = tuple(round(TINY * (i - plan.members // 2), 12) for i in range(plan.members))
    jobs = [Job(m, f, change, plan.settings) for m, f, change in product(METHODS, plan.frequencies, changes)]
    results = parts.results(jobs, _amplitude, "scatter")
    shape = (len(METHODS), len(plan.frequencies), plan.members)
    label = {"amplitude": ("m s-2", "envelope of the base acceleration at overturning")}
    ds = xr.Dataset(gathered(results, ("method", "frequency", "member"), shape, label))
    ds = ds.assign_coords(frequency_axis(plan.frequencies) | names_axis("method", METHODS, "method"))
    ds = ds.assign_coords(member=("member", list(changes), {"units": "1", "long_name": "relative change of the ramp"}))
    found, plastic = (jumps(plan.settings, JUMPS_AT, bounce) for bounce in (BOUNCE, 0.0))
    ds["jump_length"] = ("jump", found["length"], {"units": "s", "long_name": "length of a jump"})
    ds["jump_height"] = ("jump", found["height"], {"units": "m", "long_name": "height of the lower corner in a jump"})
    ds["jump_share"] = ((), found["share"], {"units": "1", "long_name": "share of the path over the floor in jumps"})
    h = specimen(BLOCK).h
    return ds.assign_attrs(
        jumps_frequency=JUMPS_AT, jumps_restitution=BOUNCE, plastic_jumps=plastic["length"].size, block=BLOCK, h=h
    )


def variation(ds: xr.Dataset) -> xr.DataArray:
    """Coefficient of variation of the amplitudes that are known."""
    return ds.amplitude.std("member", ddof=1) / ds.amplitude.mean("member")


def _strips(ax: Any, ds: xr.Dataset) -> None:
    for i, method in enumerate(ds.method.values):
        values = ds.amplitude.sel({"method": method}) / G
        at = np.broadcast_to(ds.frequency.values[:, None] + 0.08 * (i - 1), values.shape)
        label = METHOD_LABELS[str(method)]
        ax.plot(
            at.ravel(),
            values.values.ravel(),
            ls="none",
            marker="os^"[i],
            ms=4,
            mfc="none",
            color=COLOURS[method],
            label=label,
        )
    ax.set_yscale("log")
    ax.set_xlabel("Frequency of the base motion [Hz]")
    ax.set_ylabel("Envelope of base acceleration\nat overturning [g]")
    ax.legend(fontsize=8)
    ax.grid(alpha=0.3, which="both")


def figure(ds: xr.Dataset) -> Figure:
    """Every run (left), the scatter by frequency (middle), and the jumps of one run (right)."""
    fig = new_figure(13.0, 4.5)
    left, middle, right = fig.subplots(1, 3, width_ratios=[1.5, 1.0, 1.0])
    _strips(left, ds)
    for i, method in enumerate(ds.method.values):
        curve = 100.0 * variation(ds).sel({"method": method})
        middle.plot(ds.frequency, np.maximum(curve, 1e-5), color=COLOURS[method], marker="os^"[i], ms=4)
    middle.set_yscale("log")
    middle.set_xlabel("Frequency of the base motion [Hz]")
    middle.set_ylabel("Coefficient of variation [%]")
    middle.grid(alpha=0.3)
    right.plot(
        1e3 * ds.jump_length,
        np.maximum(1e3 * ds.jump_height, 1e-3),
        ls="none",
        marker=".",
        ms=3,
        color=COLOURS["method2"],
    )
    if ds.sizes["jump"]:
        right.set_xscale("log")
        right.set_yscale("log")
    right.set_xlabel("Length of a jump [ms]")
    right.set_ylabel("Height of a jump, at least 0.001 [mm]")
    right.grid(alpha=0.3)
    caption(
        fig,
        f"Block {ds.attrs['block']} on ramps that differ by parts in a million. Notice: at low frequency all runs fall "
        "together; where the block rocks for long the fall is a matter of chance within wide limits (left, middle). "
        f"Right: jumps of one run by Method 2 at {ds.attrs['jumps_frequency']:g} Hz with a normal restitution of "
        f"{ds.attrs['jumps_restitution']:g}; without any there are {ds.attrs['plastic_jumps']}.",
    )
    return fig


def check(ds: xr.Dataset) -> xr.Dataset:
    """The paper's statements on jumps and nuances."""
    period = 1.0 / float(ds.attrs["jumps_frequency"])
    spread = variation(ds)
    by_method = {METHOD_LABELS[str(m)]: float(spread.sel({"method": m}).max()) for m in ds.method.values}
    several = ds.sizes["jump"] > 0
    length = float(ds.jump_length.median()) / period if several else np.nan
    height = float(ds.jump_height.median()) / float(ds.attrs["h"]) if several else np.nan
    number = f"{ds.sizes['jump']} jumps with e_n {ds.attrs['jumps_restitution']:g}, {ds.attrs['plastic_jumps']} with 0"
    return table(
        [
            Finding(CLAIMS["scatter.short"], length, number),
            Finding(CLAIMS["scatter.low"], height, number),
            Finding(CLAIMS["scatter.displace"], float(ds.jump_share), number),
            Finding(CLAIMS["scatter.nuance"], float(spread.max()), listed(by_method)),
        ]
    )


def arguments(parser: argparse.ArgumentParser) -> None:
    """--ramp and --friction."""
    parser.add_argument(
        "--ramp",
        type=float,
        default=25.0,
        metavar="G",
        help="acceleration at the end of the 90 s ramp, in g (default: 25)",
    )
    parser.add_argument("--friction", type=float, default=0.7, metavar="MU", help="Method 2 and DEM (default: 0.7)")


def plan_of(options: argparse.Namespace) -> Plan:
    """The plan that the command line asks for.

    Raises:
        BadInputError: an option's value is not one that it can have.
    """
    positive("--ramp", options.ramp)
    positive("--friction", options.friction, zero=True)
    if options.friction >= 4.0 / 3.0:
        raise BadInputError(f"--friction {options.friction:g}: want below 4/3 with Method 2 (a corner may jam)")
    settings = Settings(ramp=options.ramp * G, friction=options.friction)
    if options.quick:
        return Plan(QUICK_FREQUENCIES, 3, Settings(ramp=options.ramp * G, friction=options.friction, duration=30.0))
    return Plan(settings=settings)


STUDY = Study(
    name="scatter",
    title="Scatter under tiny changes, and the jumps of a block",
    about="What of a block's fall can be predicted, and what only in statistics?",
    plan=plan_of,
    dataset=dataset,
    figures={"scatter": figure},
    check=check,
    arguments=arguments,
    example='(ds.amplitude.std("member") / ds.amplitude.mean("member")).plot.line(x="frequency")',
)

if __name__ == "__main__":
    STUDY.run()
