"""When a block starts to rock and when it falls, read off the vertical accelerometer fixed to it.

A pickup on the block reads (a - g_vector) along the block: g plus the vertical base motion while it stands, shocks and
swings once it rocks, and on its side no gravity any more but the base's horizontal acceleration.

- The start is the first reading outside the noise that is followed by more of them.  Noise, level and what the pickup
  catches of the base (a tilted pickup catches g's change and a share of a_x, a table moves up and down too) are
  measured while the block is known to stand, and taken off.
- The fall is the moment from which "the reading has lost g" explains the rest of the record better than "it has not":
  the change point of a sum of log-likelihood ratios (Hinkley 1970), each bounded so that no shock decides.

Source   Winkler, Meguro & Yamazaki (1995), "Shaking table experiments", Figs 2 and 3: both moments were read off the
         vertical records, as the pickups turn with the block.  They give no rule; these two are stated here.  Hinkley
         (1970), Inference about the change-point in a sequence of random variables, Biometrika 57, 1-17.
Status   a start is found late, since first swings drown in the noise, and early by a window of averaging at most, but
         for a false alarm: the mean over a window is that of its middle, and the start is sought back from the reading
         that counts to where it left the noise.  On bases that grow by 12 m/s^2 in 90 s it is late by 0.01 to 0.2 s
         with 0.01 m/s^2 of noise, up to 0.9 s with 0.05, up to 2 s with 0.2.
         A fall is found 0.1/p to 3.3/p after the passage of theta_c (median 1.5/p) and before the block lies: near the
         balance the vertical record shows little.  Simulated pickups, see tests/rocking/test_detection.py.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rocking.arguments import array_of
from rocking.block import G_STANDARD
from rocking.validation import positive, real

Array = NDArray[np.float64]

MAD_TO_SIGMA = 1.4826
"""Standard deviation of a normal variable over the median of its absolute deviation."""

LEAST_WINDOWS = 20
"""Independent windows without rocking that are needed to know the noise."""


@dataclass(frozen=True)
class Onset:
    """Start of rocking."""

    time: float  # when the reading first left the noise [s]; NaN if it never did
    level: float  # reading of the standing block [m/s^2]
    noise: float  # standard deviation of the averaged reading of the standing block [m/s^2]
    threshold: float  # departure from the level that counts [m/s^2]
    departure: float  # largest departure in the second from `time` on [m/s^2]; NaN if there is none
    shares: Array  # what the pickup catches of each reference [1], shape (reference,)

    @property
    def found(self) -> bool:
        """Whether the block started to rock."""
        return not math.isnan(self.time)


@dataclass(frozen=True)
class Fall:
    """Overturning."""

    time: float  # from when on the reading has lost g [s]; NaN if it has not
    upright_until: float  # last time before it with a reading of the standing block or more [s]; NaN if none
    evidence: float  # sum of the bounded ratios from `time` on [m/s]: time without gravity times g/2
    side: int  # +1 or -1: the side it lies on, by an a_x that goes on after the fall; 0 if both sides fit alike

    @property
    def found(self) -> bool:
        """Whether the block fell."""
        return not math.isnan(self.time)


def _checked(t: ArrayLike, a_z: ArrayLike) -> tuple[Array, Array, float]:
    """(t, a_z, time step) of a record with equal steps."""
    times, values = array_of("t", t), array_of("a_z", a_z)
    if times.ndim != 1 or times.size < 3 or values.shape != times.shape:
        raise ValueError(f"t, a_z: shapes {times.shape} and {values.shape}, want one shape (time,), three or more")
    if not (np.all(np.isfinite(times)) and np.all(np.isfinite(values))):
        raise ValueError("t, a_z: want finite numbers")
    step = float(times[-1] - times[0]) / (times.size - 1)
    if step <= 0.0 or np.any(np.abs(np.diff(times) - step) > 1e-3 * step):
        raise ValueError("t: want ascending times at equal steps")
    return times, values, step


def _quiet(t: Array, quiet: tuple[float, float] | None, window: float) -> NDArray[np.bool_]:
    """Where the block is known to stand."""
    given = (float(t[0]), float(t[0] + 0.1 * (t[-1] - t[0]))) if quiet is None else quiet
    pair = array_of("quiet", given)
    if pair.shape != (2,) or not np.all(np.isfinite(pair)):
        raise ValueError(f"quiet={quiet!r} s: want two finite times")
    start, end = pair.tolist()
    if end - start < LEAST_WINDOWS * window:
        raise ValueError(f"quiet=({start:g}, {end:g}) s: want at least {LEAST_WINDOWS} windows of {window:g} s")
    inside = (t >= start) & (t <= end)
    if np.count_nonzero(inside) < LEAST_WINDOWS:
        raise ValueError(f"quiet=({start:g}, {end:g}) s: want at least {LEAST_WINDOWS} samples of the record in it")
    return np.asarray(inside)


def _averaged(values: Array, count: int) -> Array:
    """Running mean over `count` samples, the window in the middle; at the ends over what there is."""
    before, after = count // 2, count - 1 - count // 2
    padded = np.pad(values, (before, after), mode="edge")
    return np.convolve(padded, np.full(count, 1.0 / count), mode="valid")


def _without_base(values: Array, references: Array, standing: NDArray[np.bool_]) -> tuple[Array, float, Array]:
    """(departure from what a standing block reads, level, shares of the references), by least squares."""
    terms = np.vstack([np.ones_like(values), references])
    found, _, rank, _ = np.linalg.lstsq(terms[:, standing].T, values[standing], rcond=None)
    if rank < terms.shape[0]:
        raise ValueError(
            "reference: tells nothing while the block stands (zero or proportional to another); leave it out"
        )
    return np.asarray(values - found @ terms), float(found[0]), np.asarray(found[1:])


def detect_onset(
    t: ArrayLike,
    a_z: ArrayLike,
    *,
    quiet: tuple[float, float] | None = None,
    reference: ArrayLike | None = None,
    window: float = 0.01,
    false_alarm: float = 0.01,
    count: int = 3,
    apart: float = 0.05,
    within: float = 1.5,
    resolution: float = 1e-3,
) -> Onset:
    """The start of rocking from a vertical record.

    Args:
        t: times of the record [s], at equal steps, shape (time,).
        a_z: reading of the pickup along the block [m/s^2], with gravity or without, shape (time,).
        quiet: (start, end) [s] in which the block is known to stand; the first tenth of the record if not given.
        reference: base accelerations [m/s^2] of which the pickup may catch a share (a_x, a_z of the table), shape
            (time,) or (reference, time); none if not given.
        window: time [s] over which readings are averaged before they are compared with the noise.
        false_alarm: chance, at most, that noise alone exceeds the threshold once in the whole record, if it is normal.
        count: readings beyond the threshold that it takes: a knock is not rocking ...
        apart: ... with this time [s] between them, longer than a knock rings ...
        within: ... all in this time [s] from the first one on, long enough for a period or two of the base.
        resolution: least threshold [m/s^2], for a record without noise.

    Raises:
        ValueError: the record is not one of equal steps, or an argument is out of range.
    """
    times, values, step = _checked(t, a_z)
    for name, value in (("window", window), ("apart", apart), ("within", within)):
        positive(name, value, "s")
    positive("resolution", resolution, "m/s^2")
    if not 0.0 < real(false_alarm) < 1.0:
        raise ValueError(f"false_alarm={false_alarm!r}: want above 0 and below 1")
    if not (real(count) >= 1.0 and real(count) % 1.0 == 0.0):
        raise ValueError(f"count={count!r}: want 1 or more, a whole number")
    standing = _quiet(times, quiet, window)
    others = np.empty((0, times.size)) if reference is None else np.atleast_2d(array_of("reference", reference))
    if others.shape[1] != times.size or not np.all(np.isfinite(others)):
        raise ValueError(f"reference: shape {others.shape}, want finite numbers of shape (reference, {times.size})")
    rest, level, shares = _without_base(values, others, standing)
    averaged = _averaged(rest, max(1, round(window / step)))
    noise = MAD_TO_SIGMA * float(np.median(np.abs(averaged[standing])))
    # Sliding windows overlap: to count each sample as a trial of its own bounds the chance from above.
    threshold = max(noise * _normal_quantile(false_alarm, times.size), resolution)
    first = _first_of_several(times, np.abs(averaged) > threshold, count, apart, within)
    if first is None:
        return Onset(math.nan, level, noise, threshold, math.nan, shares)
    while first > 0 and abs(averaged[first - 1]) > max(noise, 0.1 * threshold):
        first -= 1
    soon = np.abs(averaged[first : first + max(1, round(1.0 / step))])
    return Onset(float(times[first]), level, noise, threshold, float(soon.max()), shares)


def _normal_quantile(false_alarm: float, trials: int) -> float:
    """Multiple of the standard deviation that the largest of so many normal numbers exceeds with this chance."""
    from scipy.special import ndtri

    return float(-ndtri(-0.5 * math.expm1(math.log1p(-false_alarm) / trials)))


def _first_of_several(t: Array, beyond: NDArray[np.bool_], count: int, apart: float, within: float) -> int | None:
    """Index of the first reading beyond from which on there are `count` of them, `apart`, in the time `within`."""
    candidates = np.flatnonzero(beyond)
    times = t[candidates]
    for i, start in zip(candidates.tolist(), times.tolist(), strict=True):
        last, seen = start, 1
        while seen < count:
            k = int(np.searchsorted(times, last + apart))
            if k == times.size or times[k] > start + within:
                break
            last, seen = float(times[k]), seen + 1
        if seen >= count:
            return i
    return None


def detect_overturning(
    t: ArrayLike,
    a_z: ArrayLike,
    *,
    quiet: tuple[float, float] | None = None,
    a_x: ArrayLike | None = None,
    g: float = G_STANDARD,
    window: float = 0.02,
    evidence: float = 0.3,
) -> Fall:
    """The fall from a vertical record of a pickup that reads steady acceleration, gravity with it.

    Args:
        t: times of the record [s], at equal steps, shape (time,); it should go on for a second after the fall.
        a_z: reading of the pickup along the block [m/s^2], shape (time,); an offset does not matter.
        quiet: (start, end) [s] in which the block is known to stand; the first tenth of the record if not given.
        a_x: horizontal base acceleration [m/s^2], shape (time,): the lying pickup reads it, and which way tells the
            side.  Without it, a strong motion that goes on after the fall blurs the moment by up to half a period.
        g: gravity [m/s^2].
        window: time [s] over which readings are averaged for `upright_until`.
        evidence: time without gravity times g/2 [m/s] from which a block counts as fallen; a swing in which turning
            outweighs g/2 for 0.05 s has 0.25.

    Raises:
        ValueError: the record is not one of equal steps, or an argument is out of range.
    """
    times, values, step = _checked(t, a_z)
    for name, value, unit in (("g", g, "m/s^2"), ("window", window, "s"), ("evidence", evidence, "m/s")):
        positive(name, value, unit)
    standing = _quiet(times, quiet, step)
    push = np.zeros_like(times) if a_x is None else array_of("a_x", a_x)
    if push.shape != times.shape or not np.all(np.isfinite(push)):
        raise ValueError(f"a_x: shape {push.shape}, want finite numbers of shape {times.shape}")
    level = float(np.median(values[standing]))
    found = []
    for side in (0,) if a_x is None else (1, -1):
        # Standing the pickup reads the level; lying on the +x side its axis points to +x and reads level - g + a_x.
        ratio = ((values - level) ** 2 - (values - level + g - side * push) ** 2) / (2.0 * g)
        sums = np.cumsum(np.clip(ratio, -0.5 * g, 0.5 * g)[::-1])[::-1] * step
        i = int(np.argmax(sums))
        found.append((float(sums[i]), i, side))
    best, i, side = max(found)
    if len(found) == 2 and found[0][0] == found[1][0]:
        side = 0  # a base at rest from the fall on, say
    if best < evidence:
        return Fall(math.nan, math.nan, best, 0)
    upright = np.flatnonzero(_averaged(values, max(1, round(window / step)))[:i] >= level)
    return Fall(float(times[i]), float(times[upright[-1]]) if upright.size else math.nan, best, side)
