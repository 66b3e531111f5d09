"""Fig. 16 of Winkler, Meguro & Yamazaki (1995): criteria of overturning of Blocks 1, 3 and 7 by three methods.

See          Method 1 (rotation alone) needs an acceleration that grows with frequency; Method 2 and the distinct
             elements, which may slide and jump, level off at a few g.
Paper says   Method 1 grows almost linearly; Method 2 and DEM are alike, far from Method 1, and differ most beyond 3 Hz;
             at large amplitude the motion is mostly sliding rotation; at low frequency a block overturns as soon
             as it rocks.
Run          python -m studies.fig16 [--quick]  ->  build/studies/fig16.nc, then fig16.png and .pdf, and
             fig16_sensitivity.png and .pdf: how far the curves move with what the paper does not print.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import shlex
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from tqdm import tqdm

from rocking import Mode
from rocking.effects import parse
from rocking.solvers import available
from studies import _run
from studies.fig16_check import check
from studies.fig16_drawing import figure, sensitivity_figure
from studies.fig16_sensitivity import QUICK, SCATTER, VARIATIONS, G, Variation
from studies.free_vibration import DashpotFit, fit_dashpot, swing_restitution
from studies.overturning import METHOD_LABELS, METHODS, STIFFNESS, Criterion, Settings, overturning
from studies.specimens import SIZES, specimen

FREQUENCIES = tuple(np.arange(1.0, 5.01, 0.5))
QUICK_FREQUENCIES = (1.0, 3.0, 5.0)
QUICK_STEP = 1e-5
DEFAULT_BLOCKS = (1, 3, 7)
FITTED_BLOCK = 1
"""The block whose free vibration the dashpot is fitted to, as in the paper."""


@dataclass(frozen=True)
class Plan:
    """What is computed."""

    methods: tuple[str, ...] = METHODS
    blocks: tuple[int, ...] = DEFAULT_BLOCKS
    frequencies: tuple[float, ...] = FREQUENCIES
    settings: Settings = field(default_factory=Settings)
    variations: tuple[Variation, ...] = VARIATIONS + SCATTER
    jobs: int = field(default_factory=lambda: os.cpu_count() or 1)

    @property
    def sensitivity_block(self) -> int:
        """The block of the sensitivity panels: Block 3 where it is among those asked for."""
        return 3 if 3 in self.blocks else self.blocks[0]


@dataclass(frozen=True)
class Job:
    """One run: a method, a block, a frequency, and the variation (-1: none)."""

    method: str
    block: int
    frequency: float
    variation: int
    settings: Settings


def _fit(restitution: float | None) -> DashpotFit | None:
    """The dashpot for a restitution (Housner's if None); None where no dashpot gives it."""
    block = specimen(FITTED_BLOCK)
    wanted = block.housner_restitution if restitution is None else restitution
    try:
        return fit_dashpot(block, wanted, kn=STIFFNESS, ks=STIFFNESS)
    except ValueError:
        return None


def _settings_of(plan: Plan, variation: Variation) -> Settings:
    """The plan's settings with one variation."""
    changes = dict(variation.changes)
    ramp = changes.pop("ramp", plan.settings.ramp) * changes.pop("ramp_factor", 1.0)
    settings = replace(plan.settings, ramp=ramp, **changes)
    if "restitution" in changes and "dem" in plan.methods:
        fit = _fit(settings.restitution)
        settings = replace(settings, damping=fit.damping if fit else math.nan)
    return settings


def _jobs(plan: Plan) -> Iterator[Job]:
    varied = [_settings_of(plan, v) for v in plan.variations]
    # Method by method, so that the time of each can be told.
    for method in plan.methods:
        for block in plan.blocks:
            for frequency in plan.frequencies:
                yield Job(method, block, frequency, -1, plan.settings)
        for i, variation in enumerate(plan.variations):
            if method in variation.methods:
                for frequency in plan.frequencies:
                    yield Job(method, plan.sensitivity_block, frequency, i, varied[i])


def _compute(plan: Plan) -> tuple[dict[Job, Criterion], dict[str, float]]:
    """Every run of the plan, and the wall time [s] of each method."""
    jobs = list(_jobs(plan))
    results: dict[Job, Criterion] = {}
    seconds: dict[str, float] = {}
    pool = ThreadPoolExecutor(plan.jobs)
    try:
        with tqdm(total=len(jobs), unit="run", desc="fig16", disable=None) as bar:
            for method in plan.methods:
                bar.set_postfix_str(METHOD_LABELS[method])
                start = time.perf_counter()
                futures = {
                    pool.submit(overturning, method, specimen(job.block), job.frequency, job.settings): job
                    for job in jobs
                    if job.method == method
                }
                for future in as_completed(futures):
                    results[futures[future]] = future.result()
                    bar.update()
                seconds[method] = time.perf_counter() - start
    finally:
        # On Ctrl-C, runs that have not begun are dropped.
        pool.shutdown(wait=True, cancel_futures=True)
    return results, seconds


def _variables(plan: Plan, results: dict[Job, Criterion]) -> dict[str, Any]:
    shape = (len(plan.methods), len(plan.blocks), len(plan.frequencies))
    amplitude, when = np.full(shape, math.nan), np.full(shape, math.nan)
    fractions = np.full((2, *shape, len(Mode)), math.nan)
    notes = np.full(shape, "", dtype=object)
    varied_shape = (len(plan.variations), shape[0], shape[2])
    varied = np.full(varied_shape, math.nan)
    varied_notes = np.full(varied_shape, "not a parameter of this method", dtype=object)
    for job, found in results.items():
        m, f = plan.methods.index(job.method), plan.frequencies.index(job.frequency)
        if job.variation >= 0:
            varied[job.variation, m, f] = found.amplitude
            varied_notes[job.variation, m, f] = found.note
            continue
        at = (m, plan.blocks.index(job.block), f)
        amplitude[at], when[at], notes[at] = found.amplitude, found.time, found.note
        fractions[0][at], fractions[1][at] = found.mode_fraction, found.mode_fraction_late
    dims = ("method", "block", "frequency")
    reference = "Winkler, Meguro & Yamazaki (1995), Fig. 16"
    variables = {
        "overturning_amplitude": (
            dims, amplitude,
            {
                "units": "m s-2", "reference": reference,
                "long_name": "envelope of the base acceleration at overturning",
            },
        ),
        "overturning_time": (dims, when, {"units": "s", "long_name": "time of overturning", "reference": reference}),
        "mode_fraction": (
            (*dims, "mode"), fractions[0],
            {
                "units": "1", "long_name": "share of the time until overturning",
                "reference": "six modes of Ishiyama (1982)",
            },
        ),
        "mode_fraction_late": (
            (*dims, "mode"), fractions[1],
            {
                "units": "1", "long_name": "share of the second half of the time until overturning",
                "reference": "six modes of Ishiyama (1982)",
            },
        ),
        "note": (dims, notes.astype(str), {"long_name": "overturned, or why there is no amplitude"}),
    }  # fmt: skip
    if plan.variations:
        dims = ("variation", "method", "frequency")
        variables |= {
            "varied_amplitude": (
                dims, varied,
                {
                    "units": "m s-2", "reference": reference,
                    "long_name": "envelope at overturning with one parameter changed",
                },
            ),
            "varied_note": (dims, varied_notes.astype(str), {"long_name": "overturned, or why there is no amplitude"}),
        }  # fmt: skip
    return variables


def _coordinates(plan: Plan) -> dict[str, Any]:
    blocks = [specimen(number) for number in plan.blocks]
    coordinates: dict[str, Any] = {
        "method": ("method", list(plan.methods), {"long_name": "method"}),
        "block": ("block", list(plan.blocks), {"long_name": "block of Table 1"}),
        "frequency": (
            "frequency",
            list(plan.frequencies),
            {"units": "Hz", "long_name": "frequency of the base motion"},
        ),
        "mode": ("mode", [mode.name.lower() for mode in Mode], {"long_name": "mode of motion"}),
        "b": ("block", [x.b for x in blocks], {"units": "m", "long_name": "breadth"}),
        "h": ("block", [x.h for x in blocks], {"units": "m", "long_name": "height"}),
        "alpha": ("block", [x.alpha for x in blocks], {"units": "rad", "long_name": "slenderness angle"}),
        "mass": ("block", [x.mass for x in blocks], {"units": "kg", "long_name": "mass"}),
    }
    if plan.variations:
        labels = [v.label for v in plan.variations]
        groups = [v.group for v in plan.variations]
        coordinates["variation"] = ("variation", labels, {"long_name": "what was changed"})
        coordinates["variation_group"] = ("variation", groups, {"long_name": "kind of change"})
    return coordinates


def _choices(plan: Plan) -> dict[str, Any]:
    """How each parameter was chosen, for the attributes."""
    s = plan.settings
    housner = s.restitution is None
    law = s.impact_law if housner or s.impact_law != "frictional" else "two_corner"
    text = {
        "ramp_choice": (
            f"linear envelope to {s.ramp:.6g} m/s^2 in {s.duration:g} s, one for all runs; the paper prints about 90 s "
            "and that records were scaled up until blocks fell. Chosen so large that nearly all fall; a fast ramp is "
            "ahead of the motion at low frequency (see the ramp variations)"
        ),
        "friction_choice": (
            f"{s.friction:g}, static and kinetic, Method 2 and DEM; the paper says that it exceeds b/h and that "
            "abrasive paper was under the blocks"
        ),
        "restitution_choice": (
            "Housner's 1 - 1.5 sin^2(alpha) for Methods 1 and 2"
            if housner
            else f"{s.restitution:g} for Methods 1 and 2"
        )
        + "; the paper fitted it to a free vibration and does not print it",
        "impact_choice": (
            f"Method 2: normal restitution {s.normal_restitution:g}, tangential {s.tangential_restitution:g}, law "
            f"{law}; the paper prints none of them"
        ),
        "method1_choice": f"{s.form} equations (as eqs (2) and (3) are printed: linear), start of rocking by eq. (1)",
        "parameter_sensitivity": f"variable varied_amplitude, on Block {plan.sensitivity_block}",
    }
    return text if plan.variations else {k: v for k, v in text.items() if k != "parameter_sensitivity"}


def _dem_attributes(plan: Plan) -> dict[str, Any]:
    damping = plan.settings.damping
    if "dem" not in plan.methods or not math.isfinite(damping):
        return {}
    per_block = {
        f"Block {n}": round(swing_restitution(specimen(n), damping, kn=STIFFNESS, ks=STIFFNESS), 4) for n in plan.blocks
    }
    return {
        "damping_choice": (
            f"DEM: dashpot {damping:.6g} N s/m, normal and shear, for all blocks, fitted to a free vibration of Block "
            f"{FITTED_BLOCK} that loses what the restitution of Method 1 does; restitution per swing it gives: "
            f"{json.dumps(per_block)}"
        ),
        "stiffness_choice": "DEM: kn = ks = 1.98e7 N/m, printed in the paper",
        "step_choice": f"DEM: {plan.settings.dt:g} s; the paper's is 2.0e-6 s",
    }


def dataset(plan: Plan, command: str = "studies.fig16.dataset") -> xr.Dataset:
    """Compute the criteria of the plan; draws nothing.

    Returns:
        Dataset with `overturning_amplitude` [m/s^2], `overturning_time` [s], `note` (method, block, frequency),
        `mode_fraction` (method, block, frequency, mode) and, where the plan varies parameters, `varied_amplitude`
        (variation, method, frequency) on one block; the parameters and how they were chosen are attributes.
    """
    if "dem" in plan.methods and not math.isfinite(plan.settings.damping):
        fit = _fit(plan.settings.restitution)
        if fit is not None:
            plan = replace(plan, settings=replace(plan.settings, damping=fit.damping))
    results, seconds = _compute(plan)
    ds = xr.Dataset(_variables(plan, results), _coordinates(plan))
    settings = {k: ("none" if v is None else v) for k, v in asdict(replace(plan.settings, effects=())).items()}
    settings["effects"] = {effect.name: effect.parameters() for effect in plan.settings.effects}
    ds.attrs = (
        _run.provenance("Criteria of overturning of single blocks by three methods", command)
        | {"references": "Winkler, Meguro & Yamazaki (1995), Fig. 16", "settings": json.dumps(settings)}
        | _choices(plan)
        | _dem_attributes(plan)
        | {"sensitivity_block": plan.sensitivity_block}
        | {f"seconds_{method}": round(s, 3) for method, s in seconds.items()}
    )
    return ds.merge(check(ds), combine_attrs="no_conflicts")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m studies.fig16",
        description=(
            "Criteria of overturning (Fig. 16 of Winkler, Meguro & Yamazaki 1995): a wooden block stands on a table "
            "that shakes harder and harder; at which acceleration does it fall? Three methods are compared: Method 1 "
            "(the block only rocks), Method 2 (it may slide and jump too) and DEM (distinct elements)."
        ),
        epilog="Writes fig16.nc, then draws it as fig16.png/.pdf and fig16_sensitivity.png/.pdf.",
    )
    parser.add_argument(
        "--methods", nargs="+", default=list(METHODS), metavar="NAME", help=f"of {', '.join(METHODS)} (default: all)"
    )
    parser.add_argument(
        "--solver",
        default="numba",
        help="solver of Methods 1 and 2: numba (default); exact knows linear Method 1 alone; scipy is slow",
    )
    parser.add_argument(
        "--blocks", nargs="+", default=list(DEFAULT_BLOCKS), metavar="N", help="numbers of Table 1 (default: 1 3 7)"
    )
    parser.add_argument(
        "--friction", type=float, default=0.7, metavar="MU", help="friction, Method 2 and DEM (default: %(default)s)"
    )
    parser.add_argument(
        "--restitution", type=float, metavar="E", help="angular velocity after / before an impact (default: Housner's)"
    )
    parser.add_argument(
        "--ramp", type=float, default=25.0, metavar="G",
        help="acceleration at the end of the 90 s ramp, in g (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--effect", action="append", default=[], metavar="NAME.PARAMETER=NUMBER",
        help="something real that the ideal block lacks, as rounded_edges.radius=0.003 [SI units]; may be repeated",
    )  # fmt: skip
    parser.add_argument(
        "--no-sensitivity", action="store_true", help="leave out the runs with other friction, restitution, ramp ..."
    )
    _run.add_common_arguments(parser)
    return parser


def _positive(option: str, value: float, zero: bool = False) -> None:
    if not (math.isfinite(value) and (value > 0.0 or (zero and value == 0.0))):
        raise _run.BadInputError(f"{option} {value:g}: want a number {'of 0 or more' if zero else 'above 0'}")


def _block_numbers(values: Sequence[Any]) -> list[int]:
    for value in values:
        if not str(value).isdecimal():
            raise _run.BadInputError(f"--blocks {value}: want one of {', '.join(map(str, SIZES))}")
    return _run.one_of("--blocks", [int(value) for value in values], tuple(SIZES))


def plan_of(arguments: argparse.Namespace) -> Plan:
    """The plan that the command line asks for.

    Raises:
        BadInputError: an option's value is not one that it can have.
    """
    methods = tuple(_run.one_of("--methods", arguments.methods, METHODS))
    blocks = tuple(_block_numbers(arguments.blocks))
    _run.one_of("--solver", [arguments.solver], available())
    _positive("--friction", arguments.friction, zero=True)
    if "method2" in methods and arguments.friction >= 4.0 / 3.0:
        raise _run.BadInputError(f"--friction {arguments.friction:g}: want below 4/3 with Method 2 (a corner may jam)")
    if arguments.restitution is not None and not 0.0 <= arguments.restitution <= 1.0:
        raise _run.BadInputError(f"--restitution {arguments.restitution:g}: want 0 to 1")
    _positive("--ramp", arguments.ramp)
    try:
        effects = parse(arguments.effect)
    except ValueError as error:
        raise _run.BadInputError(f"--effect: {error}") from None
    settings = Settings(
        ramp=arguments.ramp * G,
        friction=arguments.friction,
        restitution=arguments.restitution,
        solver=arguments.solver,
        effects=effects,
    )
    variations = () if arguments.no_sensitivity else VARIATIONS + SCATTER
    if arguments.quick:
        settings = replace(settings, dt=QUICK_STEP)
        quick = () if arguments.no_sensitivity else QUICK
        return Plan(methods, blocks, QUICK_FREQUENCIES, settings, quick)
    return Plan(methods, blocks, FREQUENCIES, settings, variations)


def _report(ds: xr.Dataset) -> None:
    for method in ds.method.values:
        print(f"{METHOD_LABELS[method]:9s} {ds.attrs[f'seconds_{method}']:6.1f} s")
    missing = ds.overturning_amplitude.isnull()
    for method, block, frequency in np.argwhere(missing.values):
        at = ds.isel(method=method, block=block, frequency=frequency)
        label = METHOD_LABELS[str(at.method.values)]
        print(f"no amplitude: {label}, Block {int(at.block)}, {float(at.frequency):g} Hz: {at.note.item()}")
    for i in range(ds.sizes.get("statement", 0)):
        row = ds.isel(statement=i)
        verdict = {1: "holds", 0: "does not hold", -1: "not decided"}[int(row.statement_holds)]
        print(f"{verdict}: {row.statement.item()} [{row.statement_number.item():.3g}; {row.statement_bound.item()}]")
        if row.statement_detail.item():
            print(f"    {row.statement_detail.item()}")


def main(argv: list[str]) -> None:
    """Compute, save, then draw."""
    arguments = _parser().parse_args(argv)
    plan = plan_of(arguments)
    folder: Path = _run.writable_folder(arguments.out)
    ds = dataset(plan, command=shlex.join(["python", "-m", "studies.fig16", *argv]))
    _run.save_dataset(ds, folder / "fig16.nc")
    written = [folder / "fig16.nc", *_run.save_figure(figure(ds), folder, "fig16")]
    if "varied_amplitude" in ds:
        written += _run.save_figure(sensitivity_figure(ds), folder, "fig16_sensitivity")
    _report(ds)
    print("wrote", ", ".join(str(path) for path in written))


if __name__ == "__main__":
    _run.run(main)
