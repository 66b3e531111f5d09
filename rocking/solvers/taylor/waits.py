"""When the base acceleration next exceeds what a standing block bears.

Source   own derivation: t sin(omega t + phase) has one maximum of its modulus in each half cycle, as its logarithm is
         concave there.
"""

from __future__ import annotations

import math

from rocking.solvers.numba.compiling import borrowing
from rocking.solvers.taylor.records import BLOCK

MOST_STEPS = 200
"""Newton steps and halvings."""


@borrowing
def next_push(values, peaks, k, stop, threshold):
    """First sample from k on whose |value| exceeds the threshold; `stop` or more if there is none before."""
    while k < stop:
        if k % BLOCK == 0 and peaks[k // BLOCK] <= threshold:
            k += BLOCK
        elif abs(values[k]) > threshold:
            return k
        else:
            k += 1
    return k


@borrowing
def crest(wt):
    """Angle a in (pi/2, pi) of the largest t |sin|, t >= 0, in the half cycle that begins at omega t = wt >= -pi.

    There sin a + (wt + a) cos a = 0.
    """
    low, high = max(0.5 * math.pi, -wt), math.pi
    a = min(low + 1.0 / (wt + low + 1.0), high)
    for _ in range(MOST_STEPS):
        sine, cosine = math.sin(a), math.cos(a)
        f = sine + (wt + a) * cosine
        if f > 0.0:
            low = a
        else:
            high = a
        change = f / (2.0 * cosine - (wt + a) * sine)
        if abs(change) < 1e-10:
            return a - change
        a = a - change if low < a - change < high else 0.5 * (low + high)
    return a


@borrowing
def rising_through(omega, phase, rate, level, low, high):
    """Time in (low, high] at which rate t |sin(omega t + phase)| rises through the level."""
    t = high
    sign = math.copysign(1.0, math.sin(omega * high + phase))
    for _ in range(MOST_STEPS):
        angle = omega * t + phase
        sine = sign * math.sin(angle)
        f = rate * t * sine - level
        if f > 0.0:
            high = t
        else:
            low = t
        change = f / (rate * (sine + omega * t * sign * math.cos(angle)))
        t_new = t - change
        if not low < t_new < high:
            t_new = 0.5 * (low + high)
            if not low < t_new < high:
                return high
        elif abs(change) <= 1e-9 * t:
            return t_new
        t = t_new
    return high


@borrowing
def wave_exceeds(omega, phase, rate, level, t, stop):
    """First time from t >= 0 to stop at which rate t |sin(omega t + phase)| exceeds the level; inf if it does not."""
    if omega < 0.0:
        omega, phase = -omega, -phase
    if rate * t * abs(math.sin(omega * t + phase)) > level:
        return t
    t = max(t, level / rate) if rate > 0.0 else math.inf
    if omega == 0.0:
        push = rate * abs(math.sin(phase))
        at = level / push if push > 0.0 else math.inf
        return at if at <= stop else math.inf
    while t < stop:
        begin = math.floor((omega * t + phase) / math.pi) * math.pi - phase
        top = (begin + crest(begin)) / omega
        last = min(top, stop)
        if t < last and rate * last * abs(math.sin(omega * last + phase)) > level:
            # From the begin of the half cycle: the bits must not depend on when the wait began.
            return rising_through(omega, phase, rate, level, max(begin / omega, level / rate), last)
        t = max((begin + math.pi) / omega, math.nextafter(t, math.inf))
    return math.inf
