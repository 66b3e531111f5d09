"""What impacts and lift-off leave over: measured restitution less the model's, and when a forced test first moves.

Status   angular velocities before and after an impact come from local fits (`studies.campaigns.swings`); a model with
         further freedoms has no restitution of its own: NaN.  The onset is the passage of a level above the noise, in
         the record and in the model's reading alike.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rocking.hybrid import REST, ROTATION, Base, Discrete
from rocking.motion import base_at
from studies.campaigns.swings import OPEN
from studies.loop.models.model import LoopModel
from studies.loop.observed.residual_torque import rocks_alone, with_numpy
from studies.loop.observed.windows import Record, struck_before
from studies.loop.runs.simulation import Simulator

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Impacts:
    """Measured impacts of a record, arrays of shape (impact,)."""

    time: Array  # [s]
    side: NDArray[np.int64]  # +1 where the +x edge hands over, -1 where the -x edge does
    omega: Array  # angular velocity before, as read [rad/s]
    restitution: Array  # after over before, eq. (4) [1]
    sd: Array  # of the restitution [1]
    number: Array  # impacts of the record before it [1]
    pause: Array  # time since the last one of these [s]
    in_all: Array  # impacts before it, with those of the tests before [1]
    squares: Array  # sum of the squares of their speeds [rad^2/s^2]


def impacts(record: Record) -> Impacts:
    """The impacts of a record at which a restitution was seen."""
    rows = []
    for impact in record.found.impacts:
        e, sd = impact.restitution
        side = record.found.swings[impact.swing].side
        if math.isfinite(e) and math.isfinite(sd) and abs(impact.before) > 3.0 * impact.before_sd:
            rows.append((impact.time, side, impact.before, e, sd, *struck_before(record, impact.time)))
    columns = np.array(rows, dtype=np.float64).reshape(-1, 9).T
    return Impacts(columns[0], columns[1].astype(np.int64), *columns[2:])


def modelled_restitution(model: LoopModel, simulator: Simulator, test: int, seen: Impacts) -> Array:
    """Restitution of the model [1] at the measured impacts; NaN where it has none or comes to rest."""
    model = simulator.in_test(model, test)
    system = model.system
    if not rocks_alone(system) or not seen.time.size:
        return np.full(seen.time.shape, np.nan)
    motion = model.base(simulator.bases[test], simulator.spans[test])
    base = Base(*(v + np.zeros(seen.time.shape) for v in base_at(np, motion, seen.time, np.asarray(motion.parameters))))
    omega = seen.omega / model.reading_slope(0.0)
    q = Discrete(np.full(omega.shape, ROTATION), seen.side.astype(np.float64), np.ones(omega.shape))
    k = system.guard_names.index("impact")
    use = seen.squares if getattr(system, "worn_exponent", 0.0) == 2.0 else seen.in_all
    y = (np.zeros(omega.shape), omega, seen.number, seen.pause, use)[: len(system.state_names)]
    (_, after, *_), then = system.jump(np, y, q, base, with_numpy(system.parameters), k)
    return np.where(then.mode == REST, np.nan, after / omega)


def at_rest(record: Record) -> float:
    """Reading [rad] before the first motion; 0 where the record does not begin at rest."""
    first = record.found.rests[0] if record.found.rests else None
    if first is None or first[0] > 0.1 * record.time.size:
        return 0.0
    return float(np.nanmean(record.rotation[slice(*first)]))


def onset(time: Array, rotation: Array, level: float, zero: float = 0.0) -> float:
    """When the rotation first passes the level to either side [s], between samples by a straight line; NaN if never.

    Args:
        time, rotation: of a record or a model [s, rad], shape (time,), NaN where missing.
        level: [rad].
        zero: reading at rest [rad].
    """
    there = np.flatnonzero(np.isfinite(rotation))
    t, x = time[there], np.abs(rotation[there] - zero)
    beyond = np.flatnonzero(x > level)
    if not beyond.size:
        return math.nan
    k = int(beyond[0])
    if k == 0:
        return float(t[0])
    return float(t[k - 1] + (level - x[k - 1]) / (x[k] - x[k - 1]) * (t[k] - t[k - 1]))


def onset_level(record: Record) -> float:
    """Rotation [rad] whose passage counts as motion: that at which a swing is one."""
    return OPEN * record.noise
