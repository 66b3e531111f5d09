"""The table's frame step by step: acceleration and gravity in its axes, pitch rate, from a prescribed motion.

Source  kinematics of a rotating frame; signs as in the package head (pitch clockwise positive)
Status  a pitching table against Newton's law in the inertial frame (tests)

A motion is called with times and gives (a_x, a_z) of the point about which the table pitches, in inertial axes. One
that has a method `pitch(t) -> (angle [rad], acceleration [rad/s^2])` also turns the table. The pitch rate is the
central difference of the angle over two steps.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dem.shapes import FloatArray

Motion = Callable[[FloatArray], tuple[npt.ArrayLike, npt.ArrayLike]]


class Frame(NamedTuple):
    """x, z: acceleration of the frame and gravity in its axes [m/s^2]; rate [rad/s]; turn [rad/s^2]: shape (step,)."""

    x: FloatArray
    z: FloatArray
    rate: FloatArray
    turn: FloatArray


def check_motion(motion: object) -> None:
    """ValueError unless it can be called or is None."""
    if motion is not None and not callable(motion):
        raise ValueError(f"motion={motion!r}: want a function of the times [s] that gives (a_x, a_z), or None")


def pitches(motion: Motion | None) -> bool:
    """Does the motion have a pitch?"""
    return callable(getattr(motion, "pitch", None))


def pitch_angle(motion: Motion | None, times: FloatArray) -> FloatArray:
    """Angle of the table at these times [rad]; 0 where it does not pitch."""
    if not pitches(motion) or not times.size:
        return np.zeros_like(times)
    angle, _ = _pair(motion.pitch(times), times, ("pitch", "pitch acceleration"), ("rad", "rad/s^2"))  # type: ignore[union-attr]
    return angle


def refuse_pitch(motion: Motion | None, times: FloatArray) -> None:
    """ValueError where the motion pitches the table at one of these times [s]."""
    angle = pitch_angle(motion, times)
    if angle.any():
        first = int(np.flatnonzero(angle)[0])
        raise ValueError(
            f"motion={motion!r}: pitches by {angle[first]:.3g} rad at t={times[first]:.6g} s, which a single body does "
            "not feel; want one that does not pitch, or simulate_assembly, which carries it"
        )


def frame_at(motion: Motion | None, times: FloatArray, dt: float, g: float) -> Frame:
    """The frame at these times [s]; dt: step [s], g: gravity [m/s^2].

    Raises ValueError where the motion gives the wrong shape or a number that is not finite.
    """
    a_x, a_z = accelerations(motion, times)
    still = np.zeros_like(times)
    if not pitches(motion):
        return Frame(a_x, a_z + g, still, still)
    pitch: Callable[[FloatArray], object] = motion.pitch  # type: ignore[union-attr]
    units = ("rad", "rad/s^2")
    angle, turn = _pair(pitch(times), times, ("pitch", "pitch acceleration"), units)
    before, after = np.maximum(times - dt, 0.0), times + dt
    earlier, _ = _pair(pitch(before), times, ("pitch", "pitch acceleration"), units)
    later, _ = _pair(pitch(after), times, ("pitch", "pitch acceleration"), units)
    rate = (later - earlier) / (after - before)
    cos, sin = np.cos(angle), np.sin(angle)
    return Frame(cos * a_x - sin * (a_z + g), sin * a_x + cos * (a_z + g), rate, turn)


def accelerations(motion: Motion | None, times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(a_x, a_z) [m/s^2] at these times [s], checked."""
    if motion is None or not times.size:
        return np.zeros_like(times), np.zeros_like(times)
    return _pair(motion(times), times, ("a_x", "a_z"), ("m/s^2", "m/s^2"))


def _pair(
    pair: object, times: FloatArray, names: tuple[str, str], units: tuple[str, str]
) -> tuple[FloatArray, FloatArray]:
    if not isinstance(pair, (tuple, list)) or len(pair) != 2:
        raise ValueError(f"motion gave {type(pair).__name__}: want a pair of arrays ({', '.join(names)}) [{units[0]}]")
    checked = []
    for name, unit, values in zip(names, units, pair, strict=True):
        array = np.asarray(values, dtype=np.float64)
        if array.shape != times.shape:
            raise ValueError(f"motion gave {name} of shape {array.shape}: want {times.shape}, one per time")
        if not np.isfinite(array).all():
            first = int(np.argmin(np.isfinite(array)))
            raise ValueError(f"motion gave {name}={array[first]} {unit} at t={times[first]:.6g} s: want finite numbers")
        # Arrays that cannot be written to are of another type to the compiled loops, which would be compiled again.
        checked.append(np.require(array, requirements=["C", "W"]))
    return checked[0], checked[1]
