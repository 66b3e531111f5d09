"""A flight of the linear block as a polynomial, and how far along it a search may go: in JAX, without a branch.

All functions act on arrays of one shape, an element for each run.  A search that cannot decide in a fixed number of
operations goes a shorter way, of which a bound of the curvature proves that no root is passed, and is taken up again
from there; near a root such steps converge as fast as Newton's method, and nothing is ever missed.

Source   own derivation, as `rocking.solvers.piecewise.polynomial`; linear equation of Winkler, Meguro & Yamazaki
         (1995).
"""

from __future__ import annotations

import math
from typing import Any

import jax.numpy as jnp

DEGREE = 9
"""Of the polynomial of the tilt: its first term left out is below rounding for the steps of `jax_batch`."""

NEWTON_STEPS = 6
"""Newton steps and halvings in one search; four are usual."""

TOUCH = 0.5
"""A step of so many units of rounding of what was to be searched finds the polynomial at its root."""


def value(c: Any, t: Any) -> Any:
    """The polynomial with the coefficients c, constant first, at t."""
    total = c[-1]
    for part in reversed(c[:-1]):
        total = total * t + part
    return total


def slope(c: Any, t: Any) -> Any:
    """Its derivative at t."""
    return value(differentiated(c), t)


def differentiated(c: Any) -> Any:
    """Coefficients of the derivative, as many of them."""
    return [*(float(n) * c[n] for n in range(1, len(c))), jnp.zeros_like(c[0])]


def flight(x: Any, v: Any, push: Any, p2: Any, alpha: Any, tipped: Any) -> Any:
    """Taylor coefficients of x = s theta in x'' = p^2 (x - alpha - push); push: coefficients of s a_x/g.

    tipped: where the block has just tipped, and rounding may say that something pulls it back.
    """
    c = [x, v]
    for n in range(DEGREE - 1):
        force = c[n] - alpha if n == 0 else c[n]
        force = force - push[n] if n < len(push) else force
        c.append(p2 * force / float((n + 1) * (n + 2)))
        if n == 0:
            c[2] = jnp.where(tipped, jnp.maximum(c[2], 0.0), c[2])
    return c


def push_on_sine(rate: Any, omega: Any, t: Any, sine: Any, cosine: Any) -> Any:
    """Coefficients of rate t sin(omega t + phase), of which sine and cosine are given at t."""
    e = [rate * sine, rate * omega * cosine]
    for n in range(2, DEGREE - 1):
        e.append(-e[n - 2] * omega * omega / float(n * (n - 1)))
    return [t * e[0], *(t * e[n] + e[n - 1] for n in range(1, DEGREE - 1))]


def _deflated(c: Any, where: Any) -> Any:
    """The polynomial divided by t where asked for."""
    return [*(jnp.where(where, c[n + 1], c[n]) for n in range(DEGREE)), jnp.where(where, 0.0, c[DEGREE])]


def _change(c: Any, h: Any, order: int) -> Any:
    """Bound of the change of the derivative of that order on [0, h]."""
    parts = [jnp.zeros_like(h)]
    for n in range(order + 1, DEGREE + 1):
        factor = 1.0
        for j in range(order):
            factor *= n - j
        parts.append(factor * jnp.abs(c[n]))
    return value(parts, h)


def _newton(q: Any, end: Any) -> tuple[Any, Any, Any]:
    """(root, whether it has converged, a time before it) where the polynomial falls once from q(0) > 0 to q(end) <= 0.

    Newton's method within a bracket.
    """
    # A Newton step shorter than this share of the root leaves an error of its square: below rounding.
    sure = 0.5 * math.sqrt(jnp.finfo(end.dtype).eps)
    inner = jnp.maximum(q[1] * q[1] - 4.0 * q[0] * q[2], 0.0)
    guess = 2.0 * q[0] / (jnp.sqrt(inner) - q[1])
    low, high = jnp.zeros_like(end), end
    t = jnp.where((guess > 0.0) & (guess < end), guess, 0.5 * end)
    done = jnp.zeros(end.shape, bool)
    for _ in range(NEWTON_STEPS):
        q_t = value(q, t)
        low, high = jnp.where(q_t > 0.0, t, low), jnp.where(q_t > 0.0, high, t)
        change = q_t / slope(q, t)
        t_new = t - change
        close = (jnp.abs(change) <= sure * t) | (high <= low)
        other = jnp.where(close, jnp.clip(t_new, low, high), 0.5 * (low + high))
        t = jnp.where(done, t, jnp.where((t_new > low) & (t_new < high), t_new, other))
        done = done | close
    return t, done, low


def first_descent(c: Any, h: Any) -> tuple[Any, Any]:
    """(how far to go, whether the polynomial falls below zero there): h where it does not fall within h.

    Short of h and False where it is undecided: no root lies before.  A polynomial that is zero at 0 has just left; one
    that is or turns negative there falls at 0.
    """
    on_zero = c[0] == 0.0
    q = _deflated(c, on_zero)
    for _ in range(2):
        q = _deflated(q, on_zero & (q[0] == 0.0))
    q_h, slope_h = value(q, h), slope(q, h)
    bend, twist = _change(q, h, 1), _change(q, h, 2)
    falls, rises = q[1] + bend < 0.0, q[1] - bend > 0.0
    hollow, round_ = 2.0 * q[2] - twist > 0.0, 2.0 * q[2] + twist < 0.0
    free = rises | ((q_h > 0.0) & (falls | round_ | (hollow & ((slope_h <= 0.0) | (q[1] >= 0.0)))))
    # Where it falls all the way only up to a little beyond the root of the parabola, the root may lie in that part.
    inner = jnp.maximum(q[1] * q[1] - 4.0 * q[0] * q[2], 0.0)
    beyond = jnp.where(q[1] < 0.0, 1.0625 * 2.0 * q[0] / (jnp.sqrt(inner) - q[1]), h)
    part = jnp.minimum(beyond, h)
    falls_in_part = (q[1] + _change(q, part, 1) < 0.0) & (value(q, part) <= 0.0)
    whole = (falls | hollow | round_) & (q_h <= 0.0)
    root, converged, before = _newton(q, jnp.where(whole, h, part))
    found = (whole | falls_in_part) & ~rises & converged
    # The parabola below the polynomial, whose root cannot lie behind the polynomial's.
    M = jnp.maximum(twist - 2.0 * q[2], 0.0)
    reach = jnp.sqrt(q[1] * q[1] + 2.0 * M * q[0])
    ahead = jnp.where(M > 0.0, (reach + q[1]) / jnp.where(M > 0.0, M, 1.0), jnp.inf)
    step = jnp.where(q[1] < 0.0, 2.0 * q[0] / (reach - q[1]), ahead)
    step = jnp.maximum(step, jnp.where(whole | falls_in_part, before, 0.0))
    touches = step <= TOUCH * float(jnp.finfo(h.dtype).eps) * h
    walked = jnp.where(step >= h, h, step)
    at = jnp.where(free, h, jnp.where(found, jnp.minimum(root, h), walked))
    lands = ~free & (found | touches)
    below = q[0] < 0.0
    still = q[0] == 0.0  # the polynomial is zero throughout
    return jnp.where(below, 0.0, jnp.where(still, h, at)), below | (~still & lands)
