"""What learned effects with states of their own look like: how a mass or a plate answers, how a torque lags.

Each is drawn as what it does to the block in one plain motion, with a 95 % band to first order in what was fitted.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import cast

import numpy as np
from numpy.typing import NDArray

from rocking.effects.learned_base import LearnedBase
from rocking.effects.learned_coupling import LearnedCoupling
from rocking.effects.learned_response import LearnedResponse
from rocking.hybrid import REST, Base, Discrete
from rocking.hysteretic import HystereticBlock, yielding
from rocking.inner_mass import BlockWithInnerMass, inside
from studies.loop.models.model import LoopModel

Array = NDArray[np.float64]

POINTS = 241

SWINGS = 4.0
"""Periods of a mass that are drawn."""

CYCLES = 1.25
"""Of a torque that lags: the first quarter is the way from upright."""

STEPS = 20
"""Of the strain between two points."""

SMALL = 1e-6
"""Share of what a mass does that is worked out, where it may hang: small swings are as those on a spring."""

STEP = 1e-4
"""Share of a parameter by which it is varied for the band."""


def ringing(model: LoopModel) -> Array:
    """Times [s] over which a mass is drawn."""
    par = cast(BlockWithInnerMass, model.system).parameters
    return np.linspace(0.0, SWINGS * 2.0 * math.pi / par.w, POINTS)


def answer(model: LoopModel, t: Array) -> Array:
    """Angular acceleration [rad/s^2] by the mass on a block that stops from 1 rad/s and is held, at times [s] after.

    Before that the mass was at its middle place and moved along with the block.  Of one that hangs it is that of small
    swings, to scale.
    """
    system = cast(BlockWithInnerMass, model.system)
    par = system.parameters
    decay = 0.5 * par.damping
    # Roots of the oscillator, kept apart where they would meet.
    half = np.sqrt(complex(decay**2 - (par.w * (1.0 + 1e-9)) ** 2))
    shift = par.h * np.real((np.exp((half - decay) * t) - np.exp((-half - decay) * t)) / (2.0 * half))
    slide = par.h * np.real(
        ((half - decay) * np.exp((half - decay) * t) + (half + decay) * np.exp((-half - decay) * t)) / (2.0 * half)
    )
    held = Discrete(REST, 1.0, 1.0)
    still = np.zeros(POINTS)
    moment = inside(np, (still, still, SMALL * shift, SMALL * slide), held, Base(0.0, 0.0), par).moment
    return np.asarray(moment / SMALL / system.rigid.form.angular_inertia(1.0))


def there_and_back(reach: float) -> Array:
    """Rotation [rad] to the reach, to the other side and back, at p as frequency."""
    return reach * np.sin(np.linspace(0.0, CYCLES * 2.0 * math.pi, POINTS))


def loop(model: LoopModel, reach: float) -> Array:
    """Angular acceleration [rad/s^2] by what yields along `there_and_back`."""
    system = cast(HystereticBlock, model.system)
    par = system.parameters
    p = model.block.p(model.g)
    t = np.linspace(0.0, CYCLES * 2.0 * math.pi / p, (POINTS - 1) * STEPS + 1)
    step, z = t[1], 0.0
    strain = [z]

    def after(z: float, step: float, omega: float, at: float) -> float:
        # Exact for a constant speed where the rate does not hang on the strain, which is then at `at`.
        rate = float(yielding(np, at, omega, par))
        return z + (omega - rate * z) * (-math.expm1(-rate * step) / rate if rate > 0.0 else step)

    for omega in reach * p * np.cos(p * (t[:-1] + 0.5 * step)):
        z = after(z, step, omega, after(z, 0.5 * step, omega, z))
        strain.append(z)
    return -par.stiffness * np.array(strain)[::STEPS] / system.rigid.form.angular_inertia(1.0)


def amplification(model: LoopModel, frequency: Array) -> Array:
    """Acceleration under the block over that which is recorded [1], of sinusoids of these frequencies [Hz]."""
    plate = model.effects[LearnedBase.name]
    r = frequency / plate["frequency"]
    lag = 2j * plate["damping_ratio"] * r
    return np.asarray(np.abs(1.0 + plate.get("share", 1.0) * r**2 / (1.0 - r**2 + lag)))


def passed(model: LoopModel, frequency: Array) -> Array:
    """What a coupled base sensor records of sinusoids of these frequencies [Hz], over what there is [1]."""
    corner = model.get(f"{LearnedCoupling.name}.corner_frequency")
    return frequency / np.hypot(frequency, corner)


def read(model: LoopModel, frequency: Array) -> Array:
    """What a slow sensor of the rotation reads of sinusoids of these frequencies [Hz], over what there is [1]."""
    sensor = model.effects[LearnedResponse.name]
    r = frequency / sensor["frequency"]
    return np.asarray(1.0 / np.abs(1.0 - r**2 + 2j * sensor["damping_ratio"] * r))


def by_parameters(draw: Callable[[LoopModel], Array], model: LoopModel, names: list[str]) -> Array:
    """Derivatives of what is drawn by the parameters, shape (parameter, point); one-sided at the end of a range."""
    rows = []
    for name in names:
        value = model.get(name)
        step = STEP * max(abs(value), STEP)
        ends = []
        for moved in (value + step, value - step):
            try:
                ends.append((moved, draw(model.changed({name: moved}))))
            except ValueError:
                ends.append((value, draw(model)))
        (up, above), (down, below) = ends
        rows.append((above - below) / (up - down))
    return np.array(rows)
