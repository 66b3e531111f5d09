"""Impacts and other zeros of the flights of several blocks at a time, none of them missed.

A lane is decided at once where bounds of the coefficients prove that its polynomial rises, falls or curves one way
only, which leaves one root or none; Newton's method within a bracket finds it.  The rest, some in a thousand, walk in
steps too short to pass a root (`rocking.solvers.piecewise.polynomial`).  Each lane stops when it has converged itself,
so its bits do not depend on its neighbours.

Source   own derivation.
"""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np

from rocking.solvers.numba.compiling import borrowing
from rocking.solvers.piecewise.polynomial import NONE, SURE, derivative, root_by_walking
from rocking.solvers.taylor.flight import DEGREE, POLYNOMIAL, evaluated, slope, value
from rocking.solvers.taylor.vector import (
    LANES,
    bits,
    emitted,
    lanes_type,
    least,
    load,
    most,
    root_of,
    size,
    size_of,
    store,
    where,
    where_of,
)

CHORDS = 4
"""Steps with one slope; two or three are usual."""

ROUNDING = 1e-16
"""Share of the root that the last step with one slope may leave."""

MOST_STEPS = 100
"""Newton steps and halvings; four are usual."""


@emitted(POLYNOMIAL)
def deflated(c: Any, mask: Any) -> Any:
    """The polynomial divided by t where the mask holds."""
    return (*(where_of(mask, c[n + 1], c[n]) for n in range(DEGREE)), where_of(mask, c[0] * 0.0, c[DEGREE]))


@emitted(POLYNOMIAL)
def less(level: Any, c: Any) -> Any:
    """Coefficients of level minus the polynomial."""
    return (level - c[0], *(-part for part in c[1:]))


@emitted(POLYNOMIAL)
def differentiated(c: Any) -> Any:
    """Coefficients of the derivative."""
    return (*(c[n] * float(n) for n in range(1, DEGREE + 1)), c[0] * 0.0)


@emitted(lanes_type)
def change_of_slope(c: Any, h: Any) -> Any:
    """Bound of |c'(t) - c'(0)| on [0, h]."""
    return h * evaluated([size_of(c[n]) * float(n) for n in range(2, DEGREE + 1)], h)


@emitted(lanes_type)
def change_of_curvature(c: Any, h: Any) -> Any:
    """Bound of |c''(t) - c''(0)| on [0, h]."""
    return h * evaluated([size_of(c[n]) * float(n * (n - 1)) for n in range(3, DEGREE + 1)], h)


@emitted(lanes_type)
def first_guess(q: Any) -> Any:
    """Where the parabola at 0 descends through zero, or its foremost point."""
    inner = q[1] * q[1] - 4.0 * (q[0] * q[2])
    return (2.0 * q[0]) / (root_of(where_of(inner > 0.0, inner, 0.0)) - q[1])


@borrowing
def newton(q, h, wanted):
    """A root in [0, h] of each wanted polynomial, which is positive at 0 and not at h; inf in the other lanes.

    After one step the slope serves for all that follow: no division waits for another.  A step that is the share r of
    the one before leaves about r of itself.
    """
    t = first_guess(q)
    t = t - value(q, t) / slope(q, t)
    per_slope = 1.0 / slope(q, t)
    last = value(q, t) * per_slope
    t = t - last
    active, found = wanted, wanted & ~wanted
    for _ in range(CHORDS):
        change = value(q, t) * per_slope
        t = where(active, t - change, t)
        done = active & (change * change <= ROUNDING * (t * size(last))) & (t > 0.0) & (t <= h)
        active, found, last = active & ~done, found | done, change
        if bits(active) == 0:
            break
    if bits(active) != 0:
        t = where(found, t, within_bracket(q, h, active))
    return where(wanted, t, math.inf)


@borrowing
def within_bracket(q, h, wanted):
    """`newton` with a slope for each step, and halvings where a step would leave what is known to hold the root."""
    low, high = h * 0.0, h
    t = first_guess(q)
    t = where((t > low) & (t < high), t, 0.5 * h)
    active = wanted
    for _ in range(MOST_STEPS):
        q_t = value(q, t)
        positive = q_t > 0.0
        low, high = where(positive, t, low), where(positive, high, t)
        change = q_t / slope(q, t)
        t_new = t - change
        close = ((change <= SURE * t) & (change >= -SURE * t)) | (high <= low)
        other = where(close, least(most(t_new, low), high), 0.5 * (low + high))
        t = where(active, where((t_new > low) & (t_new < high), t_new, other), t)
        active = active & ~close
        if bits(active) == 0:
            break
    return where(wanted, t, math.inf)


@borrowing
def walk(q, h, lanes, scratch):
    """First root in (0, h) of the polynomials in the lanes given by their bits; inf in the others."""
    for n in range(DEGREE + 1):
        store(scratch, n, q[n])
    store(scratch, DEGREE + 1, h)
    for lane in range(LANES):
        root = NONE
        if (lanes >> lane) & 1:
            c = (
                scratch[0, lane], scratch[1, lane], scratch[2, lane], scratch[3, lane], scratch[4, lane],
                scratch[5, lane], scratch[6, lane], scratch[7, lane], scratch[8, lane], scratch[9, lane],
            )  # fmt: skip
            root = root_by_walking(c, derivative(c), scratch[DEGREE + 1, lane])
        scratch[DEGREE + 2, lane] = root
    return load(scratch, DEGREE + 2)


SCRATCH = DEGREE + 3
"""Rows that `walk` wants."""


@borrowing
def first_landing(c, x, h, near, scratch):
    """First time in [0, h] at which each near flight descends through zero; inf where it does not.

    A flight that begins at zero has just left: that root is divided out.  One that goes down at once lands at 0.
    """
    on_floor = (x <= 0.0) & (x >= 0.0)
    q = deflated(c, on_floor)
    still = on_floor & (q[0] >= 0.0) & (q[0] <= 0.0)
    if bits(still & near) != 0:
        q = deflated(q, still)
        q = deflated(q, still & (q[0] >= 0.0) & (q[0] <= 0.0))
    h_value, h_slope = value(q, h), slope(q, h)
    bend, twist = change_of_slope(q, h), change_of_curvature(q, h)
    curvature = 2.0 * q[2]
    falls, rises = q[1] + bend < 0.0, q[1] - bend > 0.0
    hollow, round_ = curvature - twist > 0.0, curvature + twist < 0.0
    plain = falls | hollow | round_
    lands = plain & (h_value <= 0.0)
    flies = (h_value > 0.0) & (falls | round_ | (hollow & ((h_slope <= 0.0) | (q[1] >= 0.0))))
    aloft = near & (q[0] > 0.0)
    sure = aloft & lands & ~rises
    root = where(near & (q[0] < 0.0), 0.0, math.inf)
    if bits(sure) != 0:
        root = least(root, newton(q, h, sure))
    doubtful = bits(aloft & ~rises & ~lands & ~flies)
    if doubtful != 0:
        root = least(root, walk(q, h, doubtful, scratch))
    return root


@numba.njit(error_model="numpy")
def empty_scratch():
    """Room for `first_landing`."""
    return np.zeros((SCRATCH, LANES))
