"""What a model says of a recorded test, from the record of the base and the lean alone; and how far off it is.

With the true laboratory this gives the floor: what the true model scores, since the base is known only to its noise
and the lean only as set.  With the ideal laboratory and its best restitution it gives the calibrated baseline.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize_scalar

from studies.campaigns import Test

from .effects import Lab
from .event import Response
from .instruments import Bench, acceleration
from .plans import ENGINES, worn
from .table import felt_by_record

Array = np.ndarray
FALLEN = 1.0  # rad; beyond this a sample counts as one after overturning


def _whole(v: Array) -> Array:
    there = np.isfinite(v)
    return v if there.all() else np.interp(np.arange(v.size), np.flatnonzero(there), v[there])


def felt(lab: Lab, test: Test) -> Array:
    """Cubic pieces of what the floor does, from the record, with the laboratory's own corrections."""
    n, h = test.time.size, 0.5 * test.time_step
    nodes = h * np.arange(2 * n - 1)
    ax, az = np.zeros(nodes.size), None
    if test.base_x is not None:
        shifted = np.clip(nodes + lab.sensors.base_lag, 0.0, nodes[-1])
        recorded = CubicSpline(nodes[::2], _whole(test.base_x))
        # A sensor that loses what a first-order low-pass keeps has lost w times its own record, integrated.
        lost = 2.0 * np.pi * lab.sensors.base_corner * recorded.antiderivative()(shifted)
        ax = lab.sensors.base_gain * (recorded(shifted) + lost)
        if test.base_z is not None:
            az = CubicSpline(nodes[::2], _whole(test.base_z))(shifted)
    return felt_by_record(h, ax, az, lab.table)


def response(lab: Lab, test: Test, lean: float, order: int = 0, pieces: Array | None = None) -> Response:
    """What the block does on the floor that the record tells of."""
    pieces = felt(lab, test) if pieces is None else pieces
    return ENGINES[lab.engine](worn(lab, order).world, pieces, 0.5 * test.time_step, 2, lean)


def predicted(lab: Lab, test: Test, lean: float, order: int = 0, pieces: Array | None = None) -> Array:
    """Rotation as recorded (gain and offset of its sensor included), shape (time,); NaN after a fall."""
    return worn(lab, order).sensors.reads(response(lab, test, lean, order, pieces).rotation)


def predicted_accelerations(lab: Lab, test: Test, lean: float, order: int, bench: Bench) -> dict[str, Array]:
    """What the accelerometers on the block read [m/s^2], by channel, shape (time,) each; NaN after a fall."""
    moved = response(lab, test, lean, order)
    floor = felt(replace(lab, table=replace(lab.table, gusts=())), test)  # what the air does moves the block alone
    sensors = (channel for channel in bench.channels if channel.kind == "block_acceleration")
    lab = worn(lab, order)
    return {channel.name: acceleration(lab, moved, floor, channel, bench) for channel in sensors}


def rms(model: Array, measured: Array) -> float:
    """RMS of model minus measured; a model that has fallen counts as pi/2 from then on, a block that has ends it."""
    down = np.flatnonzero(np.abs(measured) > FALLEN)
    end = down[0] if down.size else measured.size
    gone = np.flatnonzero(~np.isfinite(model) | (np.abs(np.nan_to_num(model)) > FALLEN))
    model = np.nan_to_num(model.copy())
    if gone.size:
        model[gone[0] :] = 0.5 * np.pi * np.sign(model[max(0, gone[0] - 1)] or 1.0)
    difference = (model - measured)[:end]
    return float(np.sqrt(np.nanmean(difference**2)))


def rms_of_accelerations(model: Mapping[str, Array], true: Mapping[str, Array]) -> float:
    """RMS [m/s^2] over the channels of what is true, but for its time and rotation, while the block has not fallen."""
    names = [name for name in true if name not in ("time", "rotation")]
    upright = np.isfinite(true["rotation"]) & (np.abs(np.nan_to_num(true["rotation"])) < FALLEN)
    return float(np.sqrt(np.mean([np.nanmean((model[name] - true[name])[upright] ** 2) for name in names])))


def fitted_lean(lab: Lab, test: Test, order: int = 0) -> float:
    """The lean of a release that fits the first 0.12 s best, one Newton step from the declared one."""
    aimed = test.initial_rotation
    if aimed is None or test.rotation is None:
        return aimed or 0.0
    n = max(4, int(0.12 / test.time_step))
    short = replace(test, time=test.time[:n], data={k: v[:n] for k, v in test.data.items()})
    d = 1e-3
    zero, more = predicted(lab, short, aimed, order), predicted(lab, short, aimed + d, order)
    slope, miss = (more - zero) / d, short.rotation - zero
    good = np.isfinite(miss)
    return aimed + float(slope[good] @ miss[good] / (slope[good] @ slope[good])) if good.sum() > 2 else aimed


def errors(lab: Lab, tests: Sequence[Test]) -> list[float]:
    """RMS of every test with its lean fitted, in the order given (which is that of the wear)."""
    scores = []
    for k, test in enumerate(tests):
        assert test.rotation is not None
        scores.append(rms(predicted(lab, test, fitted_lean(lab, test, k), k), test.rotation))
    return scores


def calibrated(lab: Lab, tests: Sequence[Test]) -> tuple[Lab, float]:
    """The laboratory with the restitution that gives the least median error, and that error."""
    # Neither leans nor base depend on restitution: no impact comes within the first 0.12 s.
    ready = [(t, t.rotation, fitted_lean(lab, t), felt(lab, t)) for t in tests if t.rotation is not None]

    released = [one for one in ready if one[0].kind == "free"]

    def score(e: float, some: list, share: float = 1.0) -> float:
        other = replace(lab, world=replace(lab.world, restitution=float(min(e, 1.0))))
        found = []
        for t, r, lean, f in some:
            n = int(share * r.size)
            found.append(rms(predicted(other, t, lean, 0, f[: 2 * n - 2]), r[:n]))
        return float(np.median(found))

    # Releases tell it without chaos, their first swings without a wrong basin; then all tests have their say.
    best = 0.9
    for half, points, some, share in (
        (0.12, 31, released, 0.4), (0.012, 13, released, 0.7), (0.003, 13, released, 1.0), (0.0012, 17, ready, 1.0)
    ):  # fmt: skip
        fine = np.linspace(best - half, best + half, points)
        best = float(fine[int(np.argmin([score(e, some, share) for e in fine]))])
    polished = minimize_scalar(
        lambda e: score(e, ready), bounds=(best - 2e-4, best + 2e-4), method="bounded", options={"maxiter": 10}
    )
    best = min((best, float(polished.x)), key=lambda e: score(e, ready))
    return replace(lab, world=replace(lab.world, restitution=min(best, 1.0))), score(best, ready)
