"""Compiled polynomials of degree nine and their first descent through zero, found without a chance to miss it.

A flight between impacts is its own Taylor polynomial over a short step (`rocking.solvers.exact.step`).  Where bounds of
the slope prove that the polynomial falls, its root is unique and Newton's method finds it; elsewhere the search walks
in steps that a bound of the curvature proves to be too short to pass a root.

Source   own derivation; Estrin (1960), Proc. Western Joint Computer Conference, for the order of evaluation.
Status   fused multiply-adds are asked for by name, so that every compilation gives the same bits.
"""

from __future__ import annotations

import math
from typing import Any

import numba
from numba import types
from numba.extending import intrinsic

NONE = math.inf
"""No root within the step."""

SURE = 1e-8
"""A Newton step shorter than this share of the root leaves an error of its square: below rounding."""

MAX_STEPS = 10_000
"""Walking steps; some ten are usual, a near touch takes some tens."""


def _fma(typing_context, a, b, c):
    """a b + c, rounded once."""

    def codegen(context, builder, signature, arguments):
        return builder.fma(*arguments)

    return types.float64(types.float64, types.float64, types.float64), codegen


fma: Any = intrinsic(_fma)


@numba.njit(error_model="numpy", forceinline=True)
def value(c, t):
    """Value at t of the polynomial with the ten coefficients c, constant first."""
    t2 = t * t
    t4 = t2 * t2
    low = fma(t2, fma(c[3], t, c[2]), fma(c[1], t, c[0]))
    middle = fma(t2, fma(c[7], t, c[6]), fma(c[5], t, c[4]))
    return fma(t4, fma(t4, fma(c[9], t, c[8]), middle), low)


@numba.njit(error_model="numpy", forceinline=True)
def derivative(c):
    """Coefficients of the derivative."""
    return (
        c[1], 2.0 * c[2], 3.0 * c[3], 4.0 * c[4], 5.0 * c[5], 6.0 * c[6], 7.0 * c[7], 8.0 * c[8], 9.0 * c[9], 0.0,
    )  # fmt: skip


@numba.njit(error_model="numpy", forceinline=True)
def below(level, c):
    """Coefficients of level minus the polynomial."""
    return (level - c[0], -c[1], -c[2], -c[3], -c[4], -c[5], -c[6], -c[7], -c[8], -c[9])


@numba.njit(error_model="numpy", forceinline=True)
def deflated(c):
    """Coefficients without the roots at zero, three at most."""
    if c[0] != 0.0:
        return c
    if c[1] != 0.0:
        return (c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8], c[9], 0.0)
    if c[2] != 0.0:
        return (c[2], c[3], c[4], c[5], c[6], c[7], c[8], c[9], 0.0, 0.0)
    return (c[3], c[4], c[5], c[6], c[7], c[8], c[9], 0.0, 0.0, 0.0)


@numba.njit(error_model="numpy", forceinline=True)
def departure(c, h):
    """Bound of |polynomial - c[0]| on [0, h]."""
    moduli = (0.0, abs(c[1]), abs(c[2]), abs(c[3]), abs(c[4]), abs(c[5]), abs(c[6]), abs(c[7]), abs(c[8]), abs(c[9]))
    return value(moduli, h)


@numba.njit(error_model="numpy")
def root_of_falling(q, slope, h):
    """The root in (0, h] of a polynomial that falls all the way from q(0) > 0 to q(h) <= 0: Newton within a bracket."""
    low, high = 0.0, h
    t = 0.5 * h
    for _ in range(200):
        q_t = value(q, t)
        if q_t > 0.0:
            low = t
        else:
            high = t
        change = q_t / value(slope, t)
        t_new = t - change
        if abs(change) <= SURE * t:
            return min(t_new, h)
        if not low < t_new < high:
            t_new = 0.5 * (low + high)
            if not low < t_new < high:
                return high
        t = t_new
    return high


@numba.njit(error_model="numpy")
def root_by_walking(q, slope, h):
    """First root in (0, h) of a polynomial with q(0) > 0, or NONE, in steps that cannot pass one.

    From t on it is at least q + q' d - M d^2/2 while -q'' <= M: the step goes to the root of that parabola.  Near a
    root this converges as fast as Newton's method.
    """
    curvature = derivative(slope)
    M = max(departure(curvature, h) - curvature[0], 0.0)
    t = 0.0
    for _ in range(MAX_STEPS):
        q_t, slope_t = value(q, t), value(slope, t)
        if q_t <= 0.0:
            return t
        reach = math.sqrt(slope_t * slope_t + 2.0 * M * q_t)
        if slope_t < 0.0:
            step = 2.0 * q_t / (reach - slope_t)
        elif M > 0.0:
            step = (reach + slope_t) / M
        else:
            return NONE
        if t + step >= h:
            return NONE
        if step <= 4e-16 * t:
            return t
        t += step
    return t


@numba.njit(error_model="numpy", forceinline=True)
def root_by_parabola(q, slope, h):
    """Root of a polynomial with q(0) > 0 and q'(0) < 0 where it surely falls; NONE if there is none, -1 if unsure.

    The first guess is the root of the parabola, and the slope of the parabola there serves for the steps that follow:
    no division waits for another.
    """
    fall = math.sqrt(max(q[1] * q[1] - 4.0 * q[0] * q[2], 0.0))
    t = 2.0 * q[0] / (fall - q[1])
    end = min(1.0625 * t, h)
    if slope[0] + departure(slope, end) >= 0.0:
        return -1.0
    if t < h:
        per_fall = 1.0 / fall
        change = value(q, t) * per_fall
        last = change
        for _ in range(4):
            t += change
            # The slope stays the same: a step that is the share r of the one before leaves about r of itself.
            if change * change <= (SURE * SURE * t) * abs(last):
                if 0.0 < t <= end:
                    return t
                break  # beyond what is certain
            last, change = change, value(q, min(t, h)) * per_fall
    if value(q, end) <= 0.0:
        return root_of_falling(q, slope, end)
    return NONE if end == h else -1.0


@numba.njit(error_model="numpy", forceinline=True)
def first_descent(c, h):
    """First time in [0, h] at which the polynomial falls below zero, or NONE.

    c[0] = 0 counts as just left: that root is divided out.  Zero is the answer if the polynomial is or turns negative
    at once.
    """
    q = deflated(c)
    if q[0] <= 0.0:
        return 0.0 if q[0] < 0.0 else NONE
    slope = derivative(q)
    if slope[0] < 0.0:
        root = root_by_parabola(q, slope, h)
        if root >= 0.0:
            return root
    elif slope[0] > departure(slope, h):
        return NONE
    return root_by_walking(q, slope, h)
