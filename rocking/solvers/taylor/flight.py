"""The Taylor polynomial of a flight between two impacts, for several blocks at a time.

With x = s theta, v = s omega, u = s a_x/g the block of Method 1 moves by one equation whichever corner carries:

    x'' = -p^2 (sin psi + u cos psi),   psi = alpha - x                     nonlinear
    x'' = -p^2 (psi + u)                                                    linear

Where u is a polynomial the coefficients of x follow one after the other; those of S = sin psi and C = cos psi obey
S' = -v C, C' = v S.  Sine and cosine are themselves polynomials about pi/4, so nothing drifts along a run.

Source   Winkler, Meguro & Yamazaki (1995), eqs (2)-(3), in the form of `rocking.method1`; recurrences: Moore (1966),
         Interval Analysis, ch. 11, and Griewank & Walther (2008), Evaluating Derivatives, ch. 13.
Status   degree nine; for steps of at most LONGEST in p t the first term left out of a linear flight is below 1e-18 of
         the tilts at play.
"""

from __future__ import annotations

import math
from typing import Any

from numba import types

from rocking.solvers.taylor.vector import emitted, fma_of, lanes_type, most_of, size_of

DEGREE = 9
"""Of the polynomial of x; the functions of `rocking.solvers.piecewise.polynomial` take the same ten coefficients."""

LONGEST = 1.0 / 16.0
"""Longest step in p t; the nonlinear block takes shorter ones where its last terms are not small."""

LONGEST_TURN = 1.0 / 8.0
"""Longest step in omega t of a sinusoid."""

QUARTER = 0.25 * math.pi

POLYNOMIAL = types.UniTuple(lanes_type, DEGREE + 1)
PUSH_ON_SINE = types.UniTuple(lanes_type, DEGREE - 1)
PAIR = types.UniTuple(lanes_type, 2)
TRIPLE = types.UniTuple(lanes_type, 3)


def evaluated(c: Any, t: Any) -> Any:
    """The polynomial with the coefficients c, constant first, at t: pairs, then pairs of pairs (Estrin)."""
    terms, power = list(c), t
    while len(terms) > 1:
        odd = [terms.pop()] if len(terms) % 2 else []
        terms = [fma_of(terms[i + 1], power, terms[i]) for i in range(0, len(terms), 2)] + odd
        power = power * power if len(terms) > 1 else power
    return terms[0]


def multiplied(a: Any, b: Any) -> Any:
    """Coefficient n of the product of two series of which the coefficients 0 to n are given; the newest come last."""
    n = min(len(a), len(b))
    total = None
    middle = sorted(range(n), key=lambda j: max(j, n - 1 - j))
    for j in middle:
        total = a[j] * b[n - 1 - j] if total is None else fma_of(a[j], b[n - 1 - j], total)
    return total


def sine_and_cosine(z: Any) -> tuple[Any, Any]:
    """(sin z, cos z) for |z| up to pi/4 and a little beyond."""
    square = z * z
    sine = [(-1.0) ** k / math.factorial(2 * k + 1) for k in range(8)]
    cosine = [(-1.0) ** k / math.factorial(2 * k) for k in range(9)]
    return z * evaluated([z.like(c) for c in sine], square), evaluated([z.like(c) for c in cosine], square)


@emitted(POLYNOMIAL)
def flight(x: Any, v: Any, push: Any, p2: Any, alpha: Any, turned: Any, floor: Any) -> Any:
    """Taylor coefficients of x.

    push: coefficients of u; turned: (sin, cos) of alpha - pi/4 for the nonlinear block, None for the linear one;
    floor: least value of the second coefficient, 0 where the block has just tipped (where rounding may say less).
    """
    c = [x, v]
    if turned is None:
        for n in range(DEGREE - 1):
            psi = alpha - x if n == 0 else -c[n]
            force = psi + push[n] if n < len(push) else psi
            part = force * (p2 * (-1.0 / ((n + 1) * (n + 2))))
            c.append(most_of(part, floor) if n == 0 else part)
        return tuple(c)
    sine, cosine = sine_and_cosine(x - QUARTER)
    S, C = [fma_of(turned[0], cosine, -(turned[1] * sine))], [fma_of(turned[1], cosine, turned[0] * sine)]
    slope = [v]
    for n in range(DEGREE - 1):
        pushed = multiplied(push[: n + 1], C[max(0, n + 1 - len(push)) :])
        part = (S[n] + pushed) * (p2 * (-1.0 / ((n + 1) * (n + 2))))
        c.append(most_of(part, floor) if n == 0 else part)
        slope.append(c[n + 2] * float(n + 2))
        S_next, C_next = multiplied(slope[: n + 1], C), multiplied(slope[: n + 1], S)
        S.append(S_next * (-1.0 / (n + 1)))
        C.append(C_next * (1.0 / (n + 1)))
    return tuple(c)


@emitted(TRIPLE)
def glide(x: Any, v: Any, push: Any, h: Any, p2: Any, alpha: Any, floor: Any) -> Any:
    """(x, v, largest x'' or 0) at the end of a linear flight of length h, where u = push[0] + push[1] t.

    z = x - alpha - u obeys z'' = p^2 z, so z = z_0 cosh + z_0' sinh / p; where it is positive it is greatest at an end.
    What is added to x and v is computed as such: no rounding of alpha gets into a small tilt.
    """
    z = most_of((x - alpha) - push[0], floor)
    d = v - push[1]
    square = h * h
    q = p2 * square
    cosh_less_1 = q * fma_of(q, fma_of(q, fma_of(q, 1.0 / 40320.0, 1.0 / 720.0), 1.0 / 24.0), 0.5)
    sinh_less_h = (h * q) * fma_of(q, fma_of(q, fma_of(q, 1.0 / 362880.0, 1.0 / 5040.0), 1.0 / 120.0), 1.0 / 6.0)
    on = fma_of(cosh_less_1, z, fma_of(sinh_less_h, d, h * v))
    faster = fma_of(p2 * (h + sinh_less_h), z, cosh_less_1 * d)
    z_end = z + (on - push[1] * h)
    return x + on, v + faster, p2 * most_of(most_of(z, z_end), h * 0.0)


@emitted(lanes_type)
def largest_curvature(c: Any, h: Any) -> Any:
    """A bound of x'' on [0, h]; 0 where that is negative."""
    at_ends = most_of(most_of(c[2] * 2.0, fma_of(c[3] * 6.0, h, c[2] * 2.0)), h * 0.0)
    beyond = evaluated([size_of(c[n]) * float(n * (n - 1)) for n in range(4, DEGREE + 1)], h)
    return fma_of(beyond, h * h, at_ends)


@emitted(PUSH_ON_SINE)
def push_on_sine(s_rate: Any, omega: Any, t: Any, sine: Any, cosine: Any) -> Any:
    """Coefficients of s_rate t sin(omega t + phase), of which sine and cosine are given at t."""
    e = [s_rate * sine, s_rate * omega * cosine]
    fall = omega * omega
    for n in range(2, DEGREE - 1):
        e.append(e[n - 2] * (fall * (-1.0 / (n * (n - 1)))))
    return (t * e[0], *(fma_of(t, e[n], e[n - 1]) for n in range(1, DEGREE - 1)))


@emitted(PAIR)
def turn(sine: Any, cosine: Any, angle: Any) -> Any:
    """(sin, cos) of an angle greater by `angle`, which is LONGEST_TURN at most."""
    square = angle * angle
    sin_parts = [angle.like((-1.0) ** k / math.factorial(2 * k + 1)) for k in range(6)]
    cos_parts = [angle.like((-1.0) ** (k + 1) / math.factorial(2 * k + 2)) for k in range(6)]
    s, c = angle * evaluated(sin_parts, square), square * evaluated(cos_parts, square)  # c: cosine less one
    return fma_of(sine, c, fma_of(cosine, s, sine)), fma_of(cosine, c, fma_of(-sine, s, cosine))


@emitted(lanes_type)
def value(c: Any, t: Any) -> Any:
    """The polynomial at t."""
    return evaluated(c, t)


@emitted(lanes_type)
def slope(c: Any, t: Any) -> Any:
    """The derivative of the polynomial at t."""
    return evaluated([c[1], *(c[n] * float(n) for n in range(2, len(c)))], t)
