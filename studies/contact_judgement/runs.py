"""Which parameters of contact judgement there are, from what to what each is varied, and the runs that show its effect.

Three things are measured for each variation:

- the history of a block that falls, off its middle, on another that lies on the floor (corners on edges, near their
  ends too): eq. (8) over 1 s, from the same drop with defaults and a step of 1.1e-6 s;
- the criterion of overturning of a free column of two blocks, the envelope of a base acceleration that grows, in
  several trials whose ramps differ in the third digit, since single runs are chaotic;
- the cost: processor time and lists of contacts made for each simulated second of the column.

Source   Winkler, Meguro & Yamazaki (1995), "Contact updating and contact judgement", which calls for such a study
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dem
from excitation import RampedSinusoid
from studies.criteria.columns import Column, ColumnSettings
from studies.running.parts import Result
from studies.specimens import specimen

DROP_HEIGHT, DROP_ASIDE = 0.01, 0.0075
"""Of the falling block above the other and beside its middle [m]."""

DROP_SAMPLE, DROP_SAMPLES = 3.3e-3, 304
"""Interval [s] and samples of eq. (8): 1 s."""

DROP_PIVOT = 1.1e-6
"""Step [s] of the drop that all are compared with."""

DROP_STEP = 2.2e-5
"""Step [s] of the other drops, about a sixth of the critical one."""

TREMBLE = 1e-3
"""Share by which the ramps of trials differ. Much less would leave the trials alike until the first close call, and
what happens there would look like an effect of whatever was varied."""

COLUMN = Column(2)
DEFAULT_SHARE = 0.25
"""Step over the critical one."""


@dataclass(frozen=True)
class Variation:
    """One change from the defaults; None leaves what is the default."""

    group: str
    label: str
    value: float  # in the group's unit; NaN for a choice
    judgement: tuple[tuple[str, float], ...] = ()  # of dem.ContactJudgement
    onset: str = "located"
    coulomb: str = "total"
    step_share: float = DEFAULT_SHARE  # of the critical step, column
    drop_step: float = DROP_STEP  # [s]
    stiffness: float = 1.0  # over the paper's
    damping: float = 1.0  # over the fitted dashpot's


DEFAULT = Variation("default", "defaults", math.nan)

UNITS = {
    "skin": "m", "update_after": "m", "reach": "m", "end_slack": "m", "facing": "rad", "onset": "", "coulomb": "",
    "step": "1", "stiffness": "1", "damping": "1",
}  # fmt: skip
"""Groups, with the unit of their values; "1" for shares and factors, none for choices."""


def _judged(group: str, values: tuple[float, ...]) -> tuple[Variation, ...]:
    return tuple(Variation(group, f"{value:g}", value, ((group, value),)) for value in values)


VARIATIONS = (
    *_judged("skin", (0.003, 0.006, 0.012, 0.04)),  # the default is 18.75 mm for the column
    *_judged("update_after", (0.0, 1e-4, 1e-3)),  # default: 0.475 of the skin
    *_judged("reach", (1e-6, 1e-5, 1e-4, 1e-3)),
    *_judged("end_slack", (0.0, 1e-6, 1e-4, 1e-3, 5e-3)),
    *_judged("facing", (0.01, 0.03, 0.15)),
    Variation("onset", "from overlap", math.nan, onset="overlap"),
    Variation("onset", "incremental", math.nan, onset="incremental"),
    Variation("onset", "incremental, paper's step", math.nan, onset="incremental", step_share=0.01, drop_step=2.2e-6),
    Variation("coulomb", "limit on spring", math.nan, coulomb="spring"),
    *(
        Variation("step", f"{share:g}", share, step_share=share, drop_step=step)
        for share, step in ((0.0625, 5.5e-6), (0.125, 1.1e-5), (0.5, 6.6e-5), (0.9, 1.1e-4))
    ),
    *(Variation("stiffness", f"x {factor:g}", factor, stiffness=factor) for factor in (0.25, 0.5, 2.0)),
    *(Variation("damping", f"x {factor:g}", factor, damping=factor) for factor in (0.25, 0.5, 2.0)),
)  # fmt: skip
"""Changes one at a time. The last two groups are no judgement: they limit how deep a corner goes, and say how much the
others matter."""

QUICK = tuple(
    v for v in VARIATIONS if v.label in ("0.001", "from overlap", "x 0.5") or (v.group, v.label) == ("skin", "0.006")
)
"""A few, for a quick look."""


def judgement_of(variation: Variation) -> dem.ContactJudgement:
    """The engine's parameters."""
    given: dict[str, Any] = dict(variation.judgement)
    return dem.ContactJudgement(**given)


def drop(variation: Variation, settings: ColumnSettings) -> NDArray[np.float64]:
    """Heights of the falling block's centroid at the samples [m], less what the reach of two edges lifts it."""
    block, reach = specimen(4), judgement_of(variation).reach
    # The way to fall is that between the places where they feel each other.
    lower = dem.block(block.b, block.h, block.d, block.density, z=reach)
    upper = dem.block(block.b, block.h, block.d, block.density, x=DROP_ASIDE, z=block.h + 2.0 * reach + DROP_HEIGHT)
    contact = replace(
        settings.contact, damping=None, damping_ratio=0.1 * variation.damping,
        kn=settings.stiffness * variation.stiffness, ks=settings.stiffness * variation.stiffness,
    )  # fmt: skip
    run = dem.simulate_assembly(
        dem.Assembly((lower, upper), standing=False), t_end=DROP_SAMPLE * (DROP_SAMPLES - 1), dt=variation.drop_step,
        contact=contact, onset=variation.onset, coulomb=variation.coulomb, judgement=judgement_of(variation),
        criteria=dem.Criteria(stop="never"), save_every=round(DROP_SAMPLE / variation.drop_step), keep=[1],
    )  # fmt: skip
    return run.z[:DROP_SAMPLES, 0] - 2.0 * reach


def pivot(settings: ColumnSettings) -> NDArray[np.float64]:
    """The drop that all are compared with."""
    return drop(replace(DEFAULT, drop_step=DROP_PIVOT), settings)


def trembled(trial: int) -> float:
    """By which share the ramp of a trial differs: 0, then more and more to both sides."""
    return TREMBLE * ((trial + 1) // 2) * (1.0 if trial % 2 else -1.0)


def column_run(variation: Variation, frequency: float, trial: int, settings: ColumnSettings) -> Result:
    """Envelope at overturning [m/s^2], NaN without; processor time [s] and lists made for each simulated second."""
    scene = COLUMN.assembly(specimen(settings.block))
    usual = settings.contact
    assert usual.damping is not None
    contact = replace(
        usual, damping=usual.damping * variation.damping, kn=usual.kn * variation.stiffness,
        ks=usual.ks * variation.stiffness,
    )  # fmt: skip
    motion = RampedSinusoid(frequency, settings.duration, settings.ramp * (1.0 + trembled(trial)))
    begun = time.thread_time()
    run = dem.simulate_assembly(
        scene, motion, t_end=settings.duration, contact=contact, onset=variation.onset, coulomb=variation.coulomb,
        dt=variation.step_share * dem.assembly_critical_step(scene, contact), judgement=judgement_of(variation),
        criteria=dem.Criteria(margin=1e3),
    )  # fmt: skip
    spent = time.thread_time() - begun
    fell = run.overturning_time
    amplitude = math.nan if math.isnan(fell) else float(motion.envelope(fell))
    return {
        "amplitude": amplitude,
        "seconds": spent / run.end_time,
        "lists": float(run.settings["lists_made"]) / run.end_time,
        "note": run.reason,
    }
