"""Rotation from accelerometers on the block, by the calibrated ideal block: where to cut, and states to start from.

A reading depends on the rotation, on the speed by the centripetal term, and above all on the side: the angular
acceleration of a rocking block changes sign with it.  For each sample three hypotheses (upright, leaning to +x, leaning
to -x) are weighed, and the likeliest sequence of them is found (Viterbi).  Each stretch of one side is then fitted with
a free state.  What comes out serves to cut records into swings; effects are judged in the channels themselves.

The block's own mass may be other than a uniform rectangle's, or off its middle; a reading, in which rotation and
angular acceleration nearly cancel, then tells a rotation that is far off, or none.  Where stretches are missed by far,
centre of mass and inertia are fitted along with their states, and sides and rotations are found by these.  A stretch
that is still missed by far has the rotation that kinematics alone give (`studies.loop.records.kinematics`): some other
torque acts in it.

Source   Viterbi (1967) for the sequence.
Status   mounting angles are estimated from what the sensors read at rest; free and forced runs are got back (tests).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rocking.hybrid import REST, ROTATION
from studies.campaigns import Channel, Test
from studies.campaigns.clipping import clipped
from studies.campaigns.swings import segment
from studies.loop.fits.fitting import Fit, fit
from studies.loop.fits.linearising import residuals
from studies.loop.models.candidates import candidates
from studies.loop.models.model import MOUNTING, LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.observed.observing import readings
from studies.loop.observed.windows import SIDE, Record, Window, cut
from studies.loop.records.kinematics import Ends, Sensor, turned
from studies.loop.runs.simulation import Job, Simulator

Array = NDArray[np.float64]

MASS, OFF = "mass_distribution", "eccentric_mass"

NEAR_IMPACT = 2
"""Samples on either side of a change of side that are not compared: the jump falls somewhere between them."""

SLOP = 0.1
"""Standard deviation [m/s^2] of what an ideal block leaves out, added to the noise when sides are told apart."""

CHANGE = 15.0
"""Price of a change of side in the log-likelihood: some 5 standard deviations of one sample."""

MOUNTING_SD = 0.03
"""How far from its declared axis a sensor may be mounted [rad], one standard deviation."""

LARGEST = 0.2
"""Mounting angle [rad] that no sensor has; a block that lies there is turned by more than a radian."""

LEAST = 8
"""Samples of the shortest stretch that is fitted."""

FAR_OFF = 6.0
"""Windows with a misfit beyond this many medians have lost their impact."""

MISSED = 2.0
"""Sum of squares over its expectation that the uniform block may leave of stretches before the mass is asked for."""

MUCH_BETTER = 2.0
"""By what factor another mass has to lessen that."""

FEW = 60
"""Stretches, the longest, that are asked."""

ANEW, SETTLED = 6, 0.01
"""How often their states are looked for anew at the most, and the share of the sum of squares that ends it."""

LOST = 0.1
"""Share of the samples of a stretch at which the ideal block may have left its side and yet be taken to fit it."""

LONGEST = 25.0
"""Of a stretch that is a swing, over the time 1 / p of the block [1]: what lasts longer is a block that fell."""

KNOTS = 0.125
"""Between knots of a spline through a stretch, over the time 1 / p of the block [1]."""

SCANNED = np.linspace(0.03, 0.99, 40)
"""States at the start of a stretch that are tried, as shares of the largest (to the power 3/2: denser for small)."""


@dataclass(frozen=True)
class Stretch:
    """A row of samples on one side: `start` to `stop` (excluded)."""

    side: int
    start: int
    stop: int


def mounted(model: LoopModel, simulator: Simulator, sensors: Sequence[Channel]) -> LoopModel:
    """The model with mounting angles from what the sensors read while the block stands."""
    angles = {}
    for channel in sensors:
        x, z = channel.axis
        top, bottom = 0.0, MOUNTING_SD**-2
        for k, test in enumerate(simulator.tests):
            if channel.name not in test.data:
                continue
            sd = channel.noise or 0.03
            base, rest = simulator.base(model, k), _standing(test, channel, sd, model)
            read = test.data[channel.name]
            rest = rest & np.isfinite(read)
            slope = (base.a_x * z - (model.g + base.a_z) * x)[rest]
            left = (read - base.a_x * x - (model.g + base.a_z) * z)[rest]
            top, bottom = top + float(slope @ left) / sd**2, bottom + float(slope @ slope) / sd**2
        angles[f"{MOUNTING}.{channel.name}"] = top / bottom
    return model.changed(angles)


def with_its_mass(simulator: Simulator, model: LoopModel, records: Sequence[Record]) -> LoopModel:
    """The model by which records are to be read: itself, or with the mass that stretches ask for.

    records: as read by the model.
    """
    windows = _longest(simulator, model, records)
    if len(windows) < LEAST:
        return model
    stands = fit(simulator, model, [], windows, iterations=10)
    pool = {c.name: c for c in candidates(model.declared) if c.name in (MASS, OFF)}
    for _ in range(len(pool)):
        if stands.chi2 < MISSED * stands.samples:
            break
        found = []
        for effect in [e for e in pool if e not in stands.model.effects]:
            start = {f"{OFF}.offset": 0.0} if effect == OFF else pool[effect].starts[0]
            parameters = (*stands.parameters, *pool[effect].parameters)
            found.append(_of_mass(simulator, stands.model.changed(start), parameters, records))
        best = min(found, key=lambda f: f.chi2)
        if best.chi2 >= stands.chi2 / MUCH_BETTER:
            break
        stands = best
    return stands.model if stands.parameters else model


def read_by(model: LoopModel) -> str:
    """What is to be said of records that were read with another mass than the uniform block's."""
    own, said = model.effects, []
    if MASS in own:
        mass = own[MASS]
        said.append(f"at {mass['height']:.4g} m and an inertia of {mass['inertia']:.4g} kg m^2 about it")
    if OFF in own:
        said.append(f"off the middle by {1e3 * own[OFF]['offset']:.3g} mm")
    return (
        f"accelerometers were turned into rotations with a centre of mass {', and '.join(said)}: with the declared "
        "ones they are missed by far"
    )


def _of_mass(simulator: Simulator, model: LoopModel, parameters: Sequence[Parameter], records: Sequence[Record]) -> Fit:
    """The mass that stretches ask for; the states of these are looked for anew by each mass that was found."""
    found = fit(simulator, model, parameters, _longest(simulator, model, records))
    for _ in range(ANEW):
        before = found
        found = fit(simulator, before.model, parameters, _longest(simulator, before.model, records))
        if found.chi2 > (1.0 - SETTLED) * before.chi2:
            break
    return min(before, found, key=lambda f: f.chi2)


def _longest(simulator: Simulator, model: LoopModel, records: Sequence[Record]) -> list[Window]:
    """The longest stretches of all records on one side, but for those in which a block lies there."""
    found = [
        (record, part) for record in records if record.sides is not None for part in _stretches(record.sides)
        if part.side != 0 and _read(part, record) >= LEAST and _is_a_swing(model, record, part)
    ]  # fmt: skip
    longest = sorted(found, key=lambda one: one[1].start - one[1].stop)[:FEW]
    return _windows(simulator, model, longest)


def _standing(test: Test, channel: Channel, sd: float, model: LoopModel) -> NDArray[np.bool_]:
    """Samples at which the block stands still: before a forced test can move it, and the quiet end of a free one.

    A block that lies there is quiet too, but no mounting angle is as large as that.
    """
    size, onset = test.time.size, model.declared.onset_acceleration
    if test.kind == "forced":
        base = test.base_x
        moved = np.flatnonzero(np.abs(np.nan_to_num(base)) > 0.5 * onset) if base is not None else np.zeros(0, int)
        return np.arange(size) < (int(moved[0]) if moved.size else size)
    count = max(10, round(0.4 / test.time_step))
    tail = test.data[channel.name][-count:]
    quiet = np.isfinite(tail).sum() > count // 2 and float(np.nanstd(tail)) < 2.0 * sd
    quiet = quiet and abs(float(np.nanmean(tail)) - model.g * channel.axis[1]) < LARGEST * model.g
    return np.arange(size) >= (size - count if quiet else size)


def records(
    simulator: Simulator, model: LoopModel, sensors: Sequence[Channel], noises: dict[str, float]
) -> list[Record]:
    """The records of all tests that hold some of the sensors.

    Args:
        simulator: of the tests.
        model: the ideal block, with mounting angles.
        sensors: accelerometers on the block.
        noises: one standard deviation of each [m/s^2], by name.
    """
    found = []
    for k, test in enumerate(simulator.tests):
        own = [c for c in sensors if c.name in test.data and np.isfinite(test.data[c.name]).sum() >= 20]
        if own:
            found.append(_record(simulator, model, k, own, noises))
    return found


def _record(
    simulator: Simulator, model: LoopModel, index: int, sensors: list[Channel], noises: dict[str, float]
) -> Record:
    test = simulator.tests[index]
    sds = np.array([noises[c.name] for c in sensors])
    observed = np.array([np.where(clipped(test.data[c.name]), np.nan, test.data[c.name]) for c in sensors])
    weighed = _weighed(simulator, model, index, sensors, observed, sds)
    parts = _stretches(weighed.sides)
    compared = observed.copy()
    for part in parts[1:]:
        compared[:, max(0, part.start - NEAR_IMPACT) : part.start + NEAR_IMPACT] = np.nan
    noise = weighed.theta_sd / math.sqrt(10.0)
    size = test.time.size
    blank = Record(
        index, test.kind, test.time, np.zeros(size), noise, 0.0, 0.0, segment(test.time, np.zeros(size), noise),
        tuple(sensors), observed, compared, np.repeat(sds[:, None], size, axis=1), sides=weighed.sides,
    )  # fmt: skip
    rotation, speeds, fell = _rotation(simulator, model, blank, parts)
    for values in (observed, compared, rotation[None, :]):
        values[:, fell:] = np.nan
    lean = 0.0
    if test.kind == "free":
        known = np.flatnonzero(np.isfinite(rotation))
        lean = float(rotation[known[0]]) if known.size else float(test.initial_rotation or 0.0)
    found = replace(
        blank, rotation=rotation, lean=lean, lean_sd=4.0 * noise if test.kind == "free" else 0.0,
        found=segment(test.time, rotation, noise),
    )  # fmt: skip
    return _with_changes(found, [(part, speed) for part, speed in speeds if part.start < fell], test.time_step)


def _with_changes(record: Record, changes: Sequence[tuple[Stretch, float]], step: float) -> Record:
    """The record with a channel that says where the side changes: rotation near zero, as sure as samples are close.

    changes: stretches that begin with an impact, and the angular speed there [rad/s].
    """
    size = record.time.size
    crossing, sd = np.full(size, np.nan), np.ones(size)
    seen = np.flatnonzero(np.isfinite(record.recorded).any(axis=0))
    for part, speed in changes:
        # The impact falls anywhere between the last sample of one side and the first of the other that are there.
        after = int(np.searchsorted(seen, part.start))
        first = int(seen[after]) if after < seen.size else part.start
        unseen = float(record.time[first] - record.time[seen[after - 1]]) if after else step
        crossing[first] = part.side * 0.5 * abs(speed) * unseen
        sd[first] = max(abs(speed) * unseen / math.sqrt(12.0), 0.1 * record.noise)
    return replace(
        record, channels=(*record.channels, SIDE), recorded=np.vstack([record.recorded, crossing]),
        observed=np.vstack([record.observed, crossing]), noises=np.vstack([record.noises, sd]),
    )  # fmt: skip


def by_base(simulator: Simulator, model: LoopModel, record: Record) -> Array:
    """Derivative of the readings by the horizontal base acceleration [unit of the channel per m/s^2] along a record.

    Shape (channel, time); the motion itself stays as it is.
    """
    theta = np.nan_to_num(record.rotation)
    y = np.column_stack([theta, np.zeros(theta.size)])
    moving = np.abs(theta) > 3.0 * record.noise
    mode, s = np.where(moving, ROTATION, REST), np.where(theta < 0.0, -1.0, 1.0)
    base = simulator.base(model, record.test)
    step = 0.01
    more = base._replace(a_x=base.a_x + step)
    return np.array([
        np.abs(readings(model, c, y, theta, mode, s, more) - readings(model, c, y, theta, mode, s, base)) / step
        for c in record.channels
    ])  # fmt: skip


@dataclass(frozen=True)
class _Weighed:
    sides: NDArray[np.int64]  # likeliest side of each sample, 0 where upright
    theta: Array  # rotation [rad] of each sample under its side
    theta_sd: float  # its standard deviation from the noise, for a typical sample


def _weighed(
    simulator: Simulator, model: LoopModel, index: int, sensors: list[Channel], observed: Array, sds: Array
) -> _Weighed:
    """Weigh the three hypotheses for each sample."""
    size = observed.shape[1]
    alpha, p = model.declared.alpha, model.declared.p(model.g)
    variance = sds**2 + SLOP**2
    there = np.isfinite(observed)
    weight = np.where(there, 1.0 / variance[:, None], 0.0)

    def read(theta: float, omega: float, side: int) -> Array:
        y = np.tile([theta, omega], (size, 1))
        mode = np.full(size, ROTATION if side else REST)
        s, base = np.full(size, float(side or 1)), simulator.base(model, index)
        return np.array([readings(model, c, y, y[:, 0], mode, s, base) for c in sensors])

    costs, thetas = np.empty((3, size)), np.zeros((3, size))
    left = np.where(there, observed - read(0.0, 0.0, 0), 0.0)
    costs[1] = np.sum(weight * left**2, axis=0)
    sd = math.nan
    for row, side in ((0, -1), (2, 1)):
        zero = read(0.0, 0.0, side)
        by_theta = (read(0.5 * side * alpha, 0.0, side) - zero) / (0.5 * alpha)  # per rotation to that side
        by_square = (read(0.0, p * alpha, side) - zero) / (p * alpha) ** 2
        left = np.where(there, observed - zero, 0.0)
        # Least squares in the rotation and the square of the speed, with what is usual of them beforehand.
        prior, usual = np.array([alpha**-2, (p * alpha) ** -4]), np.array([0.3 * alpha, 0.1 * (p * alpha) ** 2])
        A = np.array([
            [np.sum(weight * by_theta**2, 0) + prior[0], np.sum(weight * by_theta * by_square, 0)],
            [np.sum(weight * by_theta * by_square, 0), np.sum(weight * by_square**2, 0) + prior[1]],
        ]).transpose(2, 0, 1)  # fmt: skip
        b = np.array([np.sum(weight * by_theta * left, 0) + prior[0] * usual[0],
                      np.sum(weight * by_square * left, 0) + prior[1] * usual[1]]).T  # fmt: skip
        x = np.linalg.solve(A, b[..., None])[..., 0]
        x = np.clip(x, 0.0, [1.3 * alpha, 3.0 * (p * alpha) ** 2])
        rest = left - by_theta * x[:, 0] - by_square * x[:, 1]
        costs[row] = np.sum(weight * rest**2, axis=0) + np.sum(prior * (x - usual) ** 2, axis=1)
        thetas[row] = side * x[:, 0]
        own = np.sum(np.where(there, by_theta**2 / sds[:, None] ** 2, 0.0), axis=0)
        sd = 1.0 / math.sqrt(max(float(np.median(own)), 1e-6))
    sides = _likeliest(np.minimum(costs, 60.0)) - 1
    return _Weighed(sides, np.take_along_axis(thetas, (sides + 1)[None, :], axis=0)[0], sd)


def _likeliest(costs: Array) -> NDArray[np.int64]:
    """The sequence of hypotheses of least cost with a price for each change (Viterbi); shape (time,)."""
    count, size = costs.shape
    price = CHANGE * (1.0 - np.eye(count))
    total = costs[:, 0].copy()
    back = np.zeros((size, count), dtype=np.int64)
    for k in range(1, size):
        ways = total[:, None] + price
        back[k] = np.argmin(ways, axis=0)
        total = ways[back[k], np.arange(count)] + costs[:, k]
    path = np.empty(size, dtype=np.int64)
    path[-1] = int(np.argmin(total))
    for k in range(size - 1, 0, -1):
        path[k - 1] = back[k, path[k]]
    return path


def _stretches(sides: NDArray[np.int64]) -> list[Stretch]:
    edges = np.concatenate([[0], np.flatnonzero(np.diff(sides)) + 1, [sides.size]])
    return [Stretch(int(sides[a]), int(a), int(b)) for a, b in pairwise(edges)]


def _rotation(
    simulator: Simulator, model: LoopModel, record: Record, parts: Sequence[Stretch]
) -> tuple[Array, list[tuple[Stretch, float]], int]:
    """Rotation at the samples, NaN where it is not known; stretches that follow one of the other side, with the angular
    speed at their start [rad/s]; and the first sample of a fall."""
    rotation = np.full(record.time.size, np.nan)
    for part in parts:
        if part.side == 0:
            rotation[part.start : part.stop] = 0.0
    where = [part for part in parts if part.side != 0 and _read(part, record) >= LEAST]
    if not where:
        return rotation, [], record.time.size
    windows = _windows(simulator, model, [(record, part) for part in where])
    found = fit(simulator, model, [], windows, iterations=10)
    fitted = found.windows
    fell = record.time.size
    times = [record.time[_inner(part, record)] for part in where]
    answers = simulator.run([model], [
        Job(0, w.test, np.ascontiguousarray(t), w.start, w.theta, w.omega) for w, t in zip(fitted, times, strict=True)
    ])  # fmt: skip
    side_before = {part.stop: part.side for part in parts}
    changes = []
    for part, answer, w, rms in zip(where, answers, fitted, found.by_window, strict=True):
        theta, speed = answer.theta, w.omega
        # Samples at which the run has left the side are compared with nothing.
        lost = float(np.mean(np.sign(theta) != part.side)) > LOST
        if (lost or rms**2 > MISSED) and _is_a_swing(model, record, part):
            rotations, speeds, left = _by_kinematics(simulator, model, record, part)
            if lost or left < rms**2:
                theta, speed = rotations, float(speeds[0])
        own = np.where(np.sign(theta) == part.side, theta, np.nan)
        rotation[_inner(part, record)] = own
        if side_before.get(part.start) == -part.side:
            changes.append((part, speed))
        beyond = np.flatnonzero(np.abs(own) > model.declared.alpha)
        if beyond.size and not np.any(np.abs(own[beyond[-1] :]) < model.declared.alpha):
            fell = min(fell, int(np.arange(record.time.size)[_inner(part, record)][beyond[0]]))
    return rotation, changes, fell


def _by_kinematics(
    simulator: Simulator, model: LoopModel, record: Record, part: Stretch
) -> tuple[Array, Array, float]:  # fmt: skip
    """Rotation and angular speed at the samples of a stretch, whatever acts in it, and the mean square left."""
    inner, step = _inner(part, record), simulator.tests[record.test].time_step
    first, last = part.start == 0, part.stop == record.time.size
    alpha, p = model.declared.alpha, model.declared.p(model.g)
    begin = float(record.time[part.start] - (0.0 if first else 0.5 * step))
    end = float(record.time[part.stop - 1] + (0.0 if last else 0.5 * step))
    ends = Ends(begin, end, (not first, not last), first and record.kind == "free", p * alpha * step / math.sqrt(12.0))
    base = simulator.base(model, record.test)
    sensors = [
        Sensor(c.position, model.axis(c), float(record.noises[k, 0]))
        for k, c in enumerate(record.channels) if c.position is not None
    ]  # fmt: skip
    intervals = max(1, math.ceil((end - begin) * p / KNOTS))
    return turned(
        record.time[inner], record.observed[: len(sensors), inner], sensors, (base.a_x[inner], base.a_z[inner]),
        float(model.g), 0.5 * part.side * model.declared.breadth, ends, intervals, alpha,
    )  # fmt: skip


def _is_a_swing(model: LoopModel, record: Record, part: Stretch) -> bool:
    """Whether a block may lean to that side for so long, and come back."""
    lasts = record.time[part.stop - 1] - record.time[part.start]
    return bool(lasts < LONGEST / model.declared.p(model.g))


def _inner(part: Stretch, record: Record) -> slice:
    """The samples of a stretch that an impact does not touch."""
    first = part.start + (NEAR_IMPACT if part.start > 0 else 0)
    last = part.stop - (NEAR_IMPACT if part.stop < record.time.size else 0)
    return slice(first, max(first, last))


def _read(part: Stretch, record: Record) -> int:
    """How many of these were read."""
    return int(np.count_nonzero(np.isfinite(record.observed[:, _inner(part, record)]).any(axis=0)))


def _windows(simulator: Simulator, model: LoopModel, parts: Sequence[tuple[Record, Stretch]]) -> list[Window]:
    """Stretches with a state to start from: of many states those that fit best.

    A run that comes to an impact before the stretch ends fits badly, by jumps that derivatives do not see: hence the
    scan.
    """
    tried = [_scanned(simulator, model, record, part) for record, part in parts]
    left = iter(residuals(simulator, model, [window for windows in tried for window in windows]))
    found = []
    for windows in tried:
        misses = [float(np.mean(np.minimum(np.abs(next(left)), 30.0))) for _ in windows]
        found.append(windows[int(np.argmin(misses))])
    return found


def _scanned(simulator: Simulator, model: LoopModel, record: Record, part: Stretch) -> list[Window]:
    """A stretch from many states: soon after an impact with little rotation, or at a release without speed."""
    time = record.time[_inner(part, record)]
    alpha, most = model.declared.alpha, 1.5 * model.declared.p(model.g) * model.declared.alpha
    released = part.start == 0 and record.kind == "free"
    since = (NEAR_IMPACT + 0.5) * simulator.tests[record.test].time_step
    scanned = SCANNED**1.5 * (alpha if released else most)
    states = [(part.side * x, 0.0) if released else (part.side * x * since, part.side * x) for x in scanned]
    return [
        cut(
            record, 0, float(time[0]), float(time[-1]), theta=theta, omega=omega, theta_prior=theta,
            theta_sd=math.inf if released else max(0.3 * abs(theta), 2e-3), omega_sd=0.0 if released else math.inf,
        )
        for theta, omega in states
    ]  # fmt: skip


def put_right(simulator: Simulator, model: LoopModel, windows: Sequence[Window]) -> tuple[list[Window], int]:
    """Windows with their states fitted, those that lead nowhere left out, and how many those were.

    A state from which the impact falls on the wrong side of a sample is not mended by derivatives: others about it are
    tried.
    """
    fitted = list(fit(simulator, model, [], windows, iterations=6).windows)
    for share in (0.9, 1.1, 0.95, 1.05, 0.8, 1.2):
        off = _far_off(simulator, model, fitted)
        if not off:
            break
        other = fit(
            simulator, model, [], [fitted[i].moved(share * windows[i].theta, windows[i].omega) for i in off],
            iterations=6,
        )  # fmt: skip
        before = residuals(simulator, model, [fitted[i] for i in off])
        for i, window, old, new in zip(off, other.windows, before, other.residuals, strict=True):
            if float(new @ new) < float(old @ old):
                fitted[i] = window
    off = _far_off(simulator, model, fitted)
    return [w for i, w in enumerate(fitted) if i not in off], len(off)


def _far_off(simulator: Simulator, model: LoopModel, windows: Sequence[Window]) -> list[int]:
    if not windows:
        return []
    rms = np.array([math.sqrt(float(np.mean(r * r))) for r in residuals(simulator, model, windows)])
    return [int(i) for i in np.flatnonzero(rms > FAR_OFF * max(1.0, float(np.median(rms))))]
