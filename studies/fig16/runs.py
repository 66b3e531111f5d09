"""Fig. 16's dataset: which runs are made, and what they give.

Source   Winkler, Meguro & Yamazaki (1995), "Criteria of overturning for single blocks"
Status   the criterion itself: `studies.criteria.overturning` and its tests
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

import numpy as np
import xarray as xr

from rocking import Mode
from rocking.effects import compose
from studies.criteria.free_vibration import DashpotFit, fit_dashpot, swing_restitution
from studies.criteria.overturning import METHODS, STIFFNESS, Criterion, Settings, overturning, system_of
from studies.fig16.sensitivity import SCATTER, VARIATIONS, Variation
from studies.running.parts import Parts
from studies.running.study import settings_of
from studies.specimens import specimen

FREQUENCIES = tuple(np.arange(1.0, 5.01, 0.5))
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


def _run_of(job: Job) -> dict[str, Any]:
    """One run, and the CPU time [s] that it took."""
    start = time.thread_time()
    found = overturning(job.method, specimen(job.block), job.frequency, job.settings)
    return {entry.name: getattr(found, entry.name) for entry in fields(found)} | {"seconds": time.thread_time() - start}


def _compute(plan: Plan, parts: Parts) -> tuple[dict[Job, Criterion], dict[str, float]]:
    """Every run of the plan, and the CPU time [s] of each method."""
    jobs = list(_jobs(plan))
    seconds = dict.fromkeys(plan.methods, 0.0)
    results: dict[Job, Criterion] = {}
    for job, found in zip(jobs, parts.results(jobs, _run_of, "fig16"), strict=True):
        seconds[job.method] += found.pop("seconds")
        results[job] = Criterion(**found)
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
    # The criterion is read off the motion that is asked for; effects on the base make another one of it.
    whose = "commanded base acceleration" if plan.settings.effects_on_base else "base acceleration"
    reference = "Winkler, Meguro & Yamazaki (1995), Fig. 16"
    variables = {
        "overturning_amplitude": (
            dims, amplitude,
            {
                "units": "m s-2", "reference": reference,
                "long_name": f"envelope of the {whose} at overturning",
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
                    "long_name": f"envelope of the {whose} at overturning with one parameter changed",
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


def _method1(block: int, settings: Settings) -> Any:
    """A block under Method 1, before effects."""
    return system_of("method1", specimen(block), settings)


def _restitution(plan: Plan) -> str:
    """Which restitution Methods 1 and 2 have."""
    s = plan.settings
    if s.restitution is not None:
        return f"{s.restitution:g} for Methods 1 and 2"
    plastic = s.impact_law == "frictional" and s.normal_restitution == s.tangential_restitution == 0.0
    whose = "Methods 1 and 2" if plastic else "Method 1 (that of Method 2 follows from its impacts)"
    if not s.effects_on_block:
        return f"Housner's 1 - 1.5 sin^2(alpha) for {whose}"
    own = {f"Block {n}": _of_form(n, s) for n in plan.blocks}
    listing = "; ".join(f"{name} {value}" for name, value in own.items())
    return f"that of the impact of each form on the edge that lands, for {whose}, before what effects add: {listing}"


def _of_form(block: int, settings: Settings) -> str:
    """Restitution of a block with its effects, each side's where they differ."""
    try:
        system: Any = compose(_method1(block, settings), settings.effects_on_block)
    except ValueError:
        return "declined"
    rigid = getattr(system, "rigid", system)
    sides = rigid.restitutions if hasattr(rigid, "restitutions") else (getattr(rigid, "e", None),)
    found = dict.fromkeys("of its own" if e is None else f"{e:.4g}" for e in sides)
    return " and ".join(found)


def _choices(plan: Plan) -> dict[str, Any]:
    """How each parameter was chosen, for the attributes."""
    s = plan.settings
    housner = s.restitution is None
    law = s.impact_law if housner or s.impact_law != "frictional" else "two_corner"
    asked = ", which effects on the block ask for" if s.effects_on_block else ""
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
        "restitution_choice": f"{_restitution(plan)}; the paper fitted it to a free vibration and does not print it",
        "impact_choice": (
            f"Method 2: normal restitution {s.normal_restitution:g}, tangential {s.tangential_restitution:g}, law "
            f"{law}; the paper prints none of them"
        ),
        "method1_choice": (
            f"{_method1(plan.blocks[0], s).form} equations{asked} (as eqs (2) and (3) are printed: linear), start of "
            f"rocking by eq. (1){' with what the effects change of it' if s.effects else ''}"
        ),
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


def dataset(plan: Plan, parts: Parts | None = None) -> xr.Dataset:
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
    results, seconds = _compute(plan, parts or Parts())
    ds = xr.Dataset(_variables(plan, results), _coordinates(plan))
    settings = {k: ("none" if v is None else v) for k, v in asdict(replace(plan.settings, effects=())).items()}
    settings["effects"] = {effect.name: effect.parameters() for effect in plan.settings.effects}
    ds.attrs = (
        {"references": "Winkler, Meguro & Yamazaki (1995), Fig. 16", "settings": settings_of(settings)}
        | _choices(plan)
        | _dem_attributes(plan)
        | {"sensitivity_block": plan.sensitivity_block}
        | {f"seconds_{method}": round(s, 3) for method, s in seconds.items()}
    )
    return ds
