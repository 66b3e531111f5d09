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
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from rocking.effect import OF_THE_SENSOR, Effect
from rocking.effects import parse
from rocking.solvers import available
from studies.criteria.overturning import METHOD_LABELS, METHODS, Settings
from studies.fig16.drawing import figure, sensitivity_figure
from studies.fig16.runs import DEFAULT_BLOCKS, FREQUENCIES, Plan, dataset
from studies.fig16.sensitivity import QUICK, SCATTER, VARIATIONS, G
from studies.fig16.statements import check
from studies.running.command_line import one_of, positive
from studies.running.files import BadInputError
from studies.running.study import Study, make
from studies.specimens import SIZES

QUICK_FREQUENCIES = (1.0, 3.0, 5.0)
QUICK_STEP = 1e-5


def _arguments(parser: argparse.ArgumentParser) -> None:
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
        help="something real that the ideal block or base lacks, as rounded_edges.radius=0.003 [SI units]; may be "
        "repeated with other parameters; effects on a sensor alone are refused",
    )  # fmt: skip
    parser.add_argument(
        "--no-sensitivity", action="store_true", help="leave out the runs with other friction, restitution, ramp ..."
    )


def _block_numbers(values: Sequence[Any]) -> list[int]:
    for value in values:
        if not str(value).isdecimal():
            raise BadInputError(f"--blocks {value}: want one of {', '.join(map(str, SIZES))}")
    return one_of("--blocks", [int(value) for value in values], tuple(SIZES))


def _effects(texts: Sequence[str]) -> tuple[Effect, ...]:
    """The effects asked for, each of which has a say here.

    Raises:
        BadInputError: one cannot be read, or acts on a sensor alone, of which no run here has any.
    """
    try:
        effects = parse(texts)
    except ValueError as error:
        raise BadInputError(f"--effect: {error}") from None
    for effect in effects:
        if effect.ways() <= OF_THE_SENSOR:
            raise BadInputError(f"--effect {effect.name}: acts on a rotation sensor alone; want one on block or base")
    return effects


def plan_of(arguments: argparse.Namespace) -> Plan:
    """The plan that the command line asks for.

    Raises:
        BadInputError: an option's value is not one that it can have.
    """
    methods = tuple(one_of("--methods", arguments.methods, METHODS))
    blocks = tuple(_block_numbers(arguments.blocks))
    one_of("--solver", [arguments.solver], available())
    positive("--friction", arguments.friction, zero=True)
    if "method2" in methods and arguments.friction >= 4.0 / 3.0:
        raise BadInputError(f"--friction {arguments.friction:g}: want below 4/3 with Method 2 (a corner may jam)")
    if arguments.restitution is not None and not 0.0 <= arguments.restitution <= 1.0:
        raise BadInputError(f"--restitution {arguments.restitution:g}: want 0 to 1")
    positive("--ramp", arguments.ramp)
    settings = Settings(
        ramp=arguments.ramp * G,
        friction=arguments.friction,
        restitution=arguments.restitution,
        solver=arguments.solver,
        effects=_effects(arguments.effect),
    )
    variations = () if arguments.no_sensitivity else VARIATIONS + SCATTER
    if arguments.quick:
        settings = replace(settings, dt=QUICK_STEP)
        quick = () if arguments.no_sensitivity else QUICK
        return Plan(methods, blocks, QUICK_FREQUENCIES, settings, quick)
    return Plan(methods, blocks, FREQUENCIES, settings, variations)


def _say(ds: xr.Dataset) -> None:
    """CPU time by method, and where there is no amplitude."""
    for method in ds.method.values:
        print(f"{METHOD_LABELS[method]:9s} {ds.attrs[f'seconds_{method}']:6.1f} s")
    missing = ds.overturning_amplitude.isnull()
    for method, block, frequency in np.argwhere(missing.values):
        at = ds.isel(method=method, block=block, frequency=frequency)
        label = METHOD_LABELS[str(at.method.values)]
        print(f"no amplitude: {label}, Block {int(at.block)}, {float(at.frequency):g} Hz: {at.note.item()}")


def _sensitivity(ds: xr.Dataset) -> Figure | None:
    return sensitivity_figure(ds) if "varied_amplitude" in ds else None


STUDY = Study(
    name="fig16",
    title="Criteria of overturning of single blocks by three methods (Fig. 16 of Winkler, Meguro & Yamazaki 1995)",
    about=(
        "A wooden block stands on a table that shakes harder and harder; at which acceleration does it fall? Three "
        "methods are compared: Method 1 (the block only rocks), Method 2 (it may slide and jump too) and DEM "
        "(distinct elements)."
    ),
    plan=plan_of,
    dataset=dataset,
    figures={"fig16": figure, "fig16_sensitivity": _sensitivity},
    check=check,
    arguments=_arguments,
    say=_say,
    example='(ds.overturning_amplitude.sel({"block": 3}) / 9.80665).plot.line(x="frequency")',
)


def main(argv: list[str]) -> None:
    """Compute, save, then draw."""
    make(STUDY, argv)
