"""The criterion of overturning of one block under a ramped sinusoid, by each of the three methods.

The criterion is the envelope of the base acceleration at the last instant at which |theta| passes the tilt of unstable
balance before the block falls; where effects change the base, that of the acceleration that is asked of it.

Source   Winkler, Meguro & Yamazaki (1995), "Criteria of overturning for single blocks".
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import dem
from excitation import RampedSinusoid
from rocking import G_STANDARD, Block, Method1, Method2, Mode, Outcome, solve
from rocking.effect import OF_THE_SENSOR, Effect
from rocking.effects import base_with
from rocking.hybrid import System
from rocking.method2 import ImpactLaw
from rocking.motion import pitch_kernel
from studies.criteria.free_vibration import scene_of

METHODS = ("method1", "method2", "dem")
METHOD_LABELS = {"method1": "Method 1", "method2": "Method 2", "dem": "DEM"}

STIFFNESS = 1.98e7
"""Normal and shear stiffness of a contact [N/m]: Winkler, Meguro & Yamazaki (1995), "Material parameters"."""

PAPER_STEP = 2.0e-6
"""Time step of the distinct elements [s]: same source, "Numerical stability"."""


@dataclass(frozen=True)
class Settings:
    """Everything that a criterion depends on besides block, frequency and method; what the paper prints is marked."""

    ramp: float = 25.0 * G_STANDARD  # envelope at the end [m/s^2]
    duration: float = 90.0  # of the ramp [s]: "about 90 s" in the paper
    imperfection: float = 0.0  # rms departure of the envelope [1]
    seed: int = 0  # of that departure
    friction: float = 0.7  # Method 2 and DEM [1]; the paper says only that it exceeds b/h
    restitution: float | None = None  # e of eq. (4) [1]; Housner's if None
    form: Literal["linear", "nonlinear"] = "linear"  # Method 1; eqs (2) and (3) as printed are linear
    normal_restitution: float = 0.0  # Method 2 [1]
    tangential_restitution: float = 0.0  # Method 2 [1]
    impact_law: ImpactLaw = "frictional"  # Method 2
    damping: float = math.nan  # DEM: dashpot of a corner [N s/m], from a free vibration
    stiffness: float = STIFFNESS  # DEM: kn = ks [N/m], printed
    dt: float = PAPER_STEP  # DEM: step [s], printed
    solver: str = "numba"  # Methods 1 and 2
    rtol: float = 1e-9
    atol: float = 1e-12
    effects: tuple[Effect, ...] = ()  # what the ideal block lacks; a method that cannot carry one declines

    @property
    def effects_on_block(self) -> tuple[Effect, ...]:
        """Those that act on the block itself, rather than on the base or a sensor."""
        return tuple(e for e in self.effects if e.ways() - {"base_motion", *OF_THE_SENSOR})

    @property
    def effects_on_base(self) -> tuple[Effect, ...]:
        """Those that make another motion of the one that is asked for."""
        return tuple(e for e in self.effects if "base_motion" in e.ways())

    def motion(self, frequency: float) -> RampedSinusoid:
        """The base motion at a frequency [Hz], before effects on it."""
        return RampedSinusoid(frequency, self.duration, self.ramp, imperfection=self.imperfection, seed=self.seed)


@dataclass(frozen=True)
class Criterion:
    """What one run gave; NaN where it gave none, and then `note` says why."""

    amplitude: float  # envelope at overturning [m/s^2], before effects on the base
    time: float  # of overturning [s]
    mode_fraction: NDArray[np.float64]  # share of the time until overturning in each mode, shape (6,)
    mode_fraction_late: NDArray[np.float64]  # the same for the second half of that time
    note: str  # "overturned", or why there is no amplitude


def _no_criterion(note: str) -> Criterion:
    unknown = np.full(len(Mode), math.nan)
    return Criterion(math.nan, math.nan, unknown, unknown, note)


def _criterion(
    motion: RampedSinusoid, time: float, spent: NDArray[np.float64], spent_early: NDArray[np.float64]
) -> Criterion:
    """From the time [s] in each mode until overturning, and that until half of it."""
    late = spent - spent_early
    return Criterion(float(motion.envelope(time)), time, spent / spent.sum(), late / late.sum(), "overturned")


def _standing(settings: Settings) -> Criterion:
    g_units = settings.ramp / G_STANDARD
    return _no_criterion(f"standing at the end of the ramp, {settings.ramp:.4g} m/s^2 ({g_units:.3g} g)")


def system_of(method: str, block: Block, settings: Settings) -> System:
    """The block under Method 1 or 2.

    Raises:
        ValueError: the method cannot have these settings.
    """
    if method == "method1":
        # Effects on the equations are added to the nonlinear ones.
        form = "nonlinear" if settings.effects_on_block else settings.form
        return Method1(block, restitution=settings.restitution, form=form)
    # The two-corner law has a given restitution in rocking impacts and is frictional elsewhere; another law has none.
    given = settings.restitution is not None and settings.impact_law == "frictional"
    law: ImpactLaw = "two_corner" if given else settings.impact_law
    return Method2(
        block,
        friction=settings.friction,
        normal_restitution=settings.normal_restitution,
        tangential_restitution=settings.tangential_restitution,
        impact_law=law,
        restitution=settings.restitution,
    )


def _analytic(method: str, block: Block, frequency: float, settings: Settings) -> Criterion:
    motion = settings.motion(frequency)
    try:
        run = solve(
            system_of(method, block, settings), motion, t_end=settings.duration, solver=settings.solver,
            rtol=settings.rtol, atol=settings.atol, save_at=(), effects=settings.effects,
        )  # fmt: skip
    except ValueError as refusal:
        return _no_criterion(f"declined: {refusal}")
    if run.outcome is Outcome.FAILED:
        return _no_criterion(f"failed: {run.reason}")
    if not run.overturned:
        return _standing(settings)
    fell = run.overturning_time
    return _criterion(motion, fell, run.mode_durations(fell), run.mode_durations(0.5 * fell))


def _felt(motion: RampedSinusoid, settings: Settings) -> Callable[[NDArray[np.float64]], Any]:
    """The base motion as distinct elements take it, with the effects on the base.

    Raises:
        ValueError: an effect acts on the block, or makes the base pitch.
    """
    if settings.effects_on_block:
        raise ValueError(f"{settings.effects_on_block[0].name}: distinct elements do not carry it")
    if not settings.effects:
        return motion
    base = base_with(motion, settings.effects, (0.0, settings.duration), G_STANDARD)
    if pitch_kernel(base) is not None:
        raise ValueError(f"{base!r}: a single distinct element does not carry a base that pitches")
    return lambda t: base.kernel(np, t, base.parameters)


def _distinct_element(block: Block, frequency: float, settings: Settings) -> Criterion:
    if not math.isfinite(settings.damping):
        return _no_criterion("declined: no dashpot gives this restitution in a free vibration")
    motion = settings.motion(frequency)
    try:
        run = dem.simulate(
            scene_of(block), _felt(motion, settings), t_end=settings.duration, dt=settings.dt, mu=settings.friction,
            damping=settings.damping, kn=settings.stiffness, ks=settings.stiffness,
        )  # fmt: skip
    except ValueError as refusal:
        return _no_criterion(f"declined: {refusal}")
    if run.outcome is dem.Outcome.UNSTABLE:
        return _no_criterion(f"failed: at {run.end_time:.6g} s {run.outcome.value}")
    if run.side == 0:
        return _standing(settings)
    fell = run.overturning_time
    early = np.array([np.interp(0.5 * fell, run.time, clock) for clock in run.mode_clock.T])
    return _criterion(motion, fell, run.mode_seconds_to_overturning, early)


def overturning(method: str, block: Block, frequency: float, settings: Settings) -> Criterion:
    """The criterion of overturning of a block at a frequency [Hz] by "method1", "method2" or "dem"."""
    if method == "dem":
        return _distinct_element(block, frequency, settings)
    return _analytic(method, block, frequency, settings)
