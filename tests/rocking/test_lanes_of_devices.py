"""Parts of the batches on devices by themselves: what they answer, and that they do answer where they can."""

import math
from types import SimpleNamespace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from rocking.solvers.exact.jax_flight import DEGREE, first_descent
from rocking.solvers.exact.jax_lanes import RUNNING, Base, begun, constants
from rocking.solvers.exact.jax_rounds import TIP, Step, chatter, one_step, wanted

LANES = 4000
G = 9.81


def flown(v: np.ndarray, pull: np.ndarray, tilt: np.ndarray, bow: np.ndarray, p2: np.ndarray) -> Any:
    """Time and speed of the landing of x'' = -(pull + tilt t + bow t^2/2) + p2 x from x = 0 with v > 0.

    Its power series to the eighth order: a flight takes a few hundredths of 1/p.
    """
    x = [0.0 * v, v]
    forces = [pull, tilt, 0.5 * bow]
    for n in range(8):
        x.append((p2 * x[n] - (forces[n] if n < 3 else 0.0)) / ((n + 1) * (n + 2)))
    t = 2.0 * v / pull
    for _ in range(30):
        position = sum(c * t**n for n, c in enumerate(x))
        t = t - position / sum(n * c * t ** (n - 1) for n, c in enumerate(x) if n)
    return t, -sum(n * c * t ** (n - 1) for n, c in enumerate(x) if n)


def counted(
    v: np.ndarray, s: np.ndarray, e: np.ndarray, p2: np.ndarray, alpha: np.ndarray, a: np.ndarray, rise: np.ndarray,
    bow: np.ndarray, last: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """Impacts until one leaves less than `last`, flight by flight; the first has left v."""
    v, s, t, out = v.copy(), s.copy(), np.zeros(LANES), np.zeros(LANES, dtype=int)
    for _ in range(2000):
        flies = v >= last
        if not flies.any():
            return out
        push = a + rise * t + 0.5 * bow * t * t
        took, landed = flown(v, p2 * (alpha + s * push), p2 * s * (rise + bow * t), p2 * s * bow, p2)
        out, t = out + flies, np.where(flies, t + took, t)
        v, s = np.where(flies, e * landed, v), np.where(flies, -s, s)
    raise AssertionError("chatter without an end")


# The flights of the linear block, one by one.  It must not answer where it is unsure, and must answer often.
@pytest.mark.slow
def test_chatter_has_as_many_impacts_as_flights_followed_one_by_one() -> None:
    rng = np.random.default_rng(7)
    p2, alpha = rng.uniform(2.0, 30.0, LANES), rng.uniform(0.05, 0.4, LANES)
    e, s = rng.uniform(0.3, 0.97, LANES), rng.choice([-1.0, 1.0], LANES)
    last = 1e-6 * np.sqrt(p2) * alpha
    a = rng.uniform(-0.6, 0.6, LANES) * alpha
    v = last * 10.0 ** rng.uniform(0.5, 4.3, LANES)
    series = 2.0 * v / (p2 * alpha * (1.0 - e))
    # From steady pulls to those that change by a tenth of the tilt, with and without a bow.
    rise = rng.choice([-1.0, 1.0], LANES) * alpha * 10.0 ** rng.uniform(-6.0, -1.0, LANES) / series
    bow = rng.choice([-1.0, 0.0, 1.0], LANES) * alpha * 10.0 ** rng.uniform(-5.0, -1.3, LANES) / series**2
    # Of a third both are left out to the same amount, so that a bound has to take their sum.
    bow[::3] = (
        alpha[::3] * rng.choice([-1.0, 1.0], LANES)[::3] * rng.uniform(0.005, 0.08, LANES)[::3] / series[::3] ** 2
    )
    rise[::3] = np.sign(rise[::3]) * alpha[::3] * np.sqrt(0.5 * np.abs(bow) * series**2 / alpha)[::3] / series[::3]
    with jax.enable_x64(True):
        fixed: Any = SimpleNamespace(p2=p2, alpha=alpha, e=e, omega_rest=last)
        moving: Any = SimpleNamespace(peak=jnp.full(LANES, math.inf), impacts=jnp.zeros(LANES, dtype=int))
        told = np.asarray(chatter(fixed, moving, jnp.asarray(v), s, a, rise, np.abs(bow)))
    sure = told > 0
    np.testing.assert_array_equal(told[sure], counted(v, s, e, p2, alpha, a, rise, bow, last)[sure])
    steady = (np.abs(rise) * series < 1e-4 * alpha) & (np.abs(bow) * series**2 < 1e-4 * alpha) & (v > 10.0 * last)
    # Unsure by 1e-4 of ln(1/e) at most: few numbers lie so near to a whole one.
    assert np.mean(sure[steady & (e < 0.9)]) > 0.95


# The grid of a ramped sinusoid: as few intervals as keep p t below 1/16 and omega t below 1/8 in each.
@pytest.mark.parametrize("omega", [0.0, 2.0, 40.0])
def test_intervals_of_a_sinusoid_are_as_long_as_a_step_may_be(omega: float) -> None:
    p, duration = np.array([0.9, 4.0, 12.0]), 10.0
    pars = np.column_stack([p * p, *(np.full(3, x) for x in (0.2, G, 0.2, 0.9, 1e-6))])
    starts = np.zeros((3, 6))
    starts[:, 5] = 12.0
    motions = np.tile([omega, 0.3, 0.5, duration], (3, 1))
    with jax.enable_x64(True):
        fixed = constants(jnp.asarray(pars), jnp.asarray(starts), jnp.asarray(motions), True)
    dt, count = np.asarray(fixed.dt), np.asarray(fixed.count)
    np.testing.assert_allclose(dt * count, duration, rtol=1e-15)
    longest = np.minimum(1.0 / 16.0 / p, 1.0 / 8.0 / max(omega, 1e-300))
    assert np.all(dt <= longest * (1.0 + 1e-15))
    assert np.all(duration / (count - 1.0) > longest)


# A parabola that falls, turns and is above zero again at the end: its first root is told at once and not walked to.
def test_the_first_root_of_a_flight_that_turns_is_found_in_one_go() -> None:
    first, second = np.array([0.1, 0.4, 0.9]), np.array([2.0, 2.6, 1.5])
    with jax.enable_x64(True):
        c = [jnp.asarray(x) for x in (first * second, -(first + second), np.ones(3))]
        c += [jnp.zeros(3) for _ in range(DEGREE - 2)]
        at, lands = first_descent(c, jnp.full(3, 3.0))
    assert np.all(np.asarray(lands))
    # Coefficients that are rounded by half a unit each move the root by so much.
    rounding = 0.5 * np.finfo(float).eps * (first * second + (first + second) * first + first**2) / (second - first)
    assert np.all(np.abs(np.asarray(at) - first) <= rounding + np.finfo(float).eps * first)


# From level a parabola lands at the root of its own first guess; from the middle Newton would halve its way there.
def test_a_parabola_that_falls_from_level_is_landed_on_in_one_go() -> None:
    root = np.array([1e-6, 1e-3, 0.1])
    with jax.enable_x64(True):
        c = [jnp.asarray(root**2), jnp.zeros(3), -jnp.ones(3)]
        c += [jnp.zeros(3) for _ in range(DEGREE - 2)]
        at, lands = first_descent(c, jnp.ones(3))
    assert np.all(np.asarray(lands))
    np.testing.assert_allclose(np.asarray(at), root, rtol=1e-15)


# Hollow at first and round at the end: it dips below zero and comes back, and its slope at the end is down again.
def test_a_dip_of_a_flight_that_is_not_hollow_throughout_is_not_passed_over() -> None:
    dips = [np.array([float(q0), -0.7, 1.0, -0.45]) for q0 in np.linspace(0.151, 0.156, 6)]
    first = np.array([min(x.real for x in np.roots(c[::-1]) if abs(x.imag) < 1e-9 and x.real > 0.0) for c in dips])
    assert all(c.sum() > 0.0 for c in dips) and np.all(first < 0.6)
    with jax.enable_x64(True):
        c = [jnp.asarray(column) for column in np.transpose(dips)]
        c += [jnp.zeros(6) for _ in range(DEGREE - 3)]
        at, _ = first_descent(c, jnp.ones(6))
    assert np.all(np.asarray(at) <= first * (1.0 + 1e-12))


# The record begins with a jump beyond what the block stands and ends its first interval as far to the other side.
@pytest.mark.parametrize("start", [0.3, -0.3])
def test_a_block_that_stands_tips_at_once_where_the_base_jumps(start: float) -> None:
    with jax.enable_x64(True):
        none = jnp.zeros(1)
        fixed: Any = SimpleNamespace(bulge=none, alpha=none + 0.2, onset=none + 0.2)
        moving: Any = SimpleNamespace(x=none, v=none, peak=none, rests=none == 0.0)
        step = Step([none] * (DEGREE + 1), [none + start, none - 2.0 * start], none + 1.0, none == 0.0)
        kind, q = wanted(fixed, moving, step)
        at, tips = first_descent(q, step.h)
    assert (int(kind[0]), float(at[0]), bool(tips[0])) == (TIP, 0.0, True)


# Rounding alone may lift a crest above the balance and the search for the passage not find it: such a lane turned in a
# circle.  States a few units of rounding beside where something happens.
@pytest.mark.parametrize("wave", [False, True])
@pytest.mark.parametrize("precision", [pytest.param("float32", marks=pytest.mark.slow), "float64"])
def test_no_lane_stands_still(precision: str, wave: bool) -> None:
    rng, kind = np.random.default_rng(3), np.dtype(precision).type
    alpha, p2 = 10.0 ** rng.uniform(-1.7, -0.1, LANES), 10.0 ** rng.uniform(-0.5, 2.0, LANES)
    ones, none = np.ones(LANES), np.zeros(LANES)
    pars = np.stack([p2, alpha, G * ones, alpha, rng.uniform(0.2, 1.0, LANES), 1e-6 * np.sqrt(p2) * alpha], axis=1)
    starts = np.stack([ones, ones, none, none, none, 30.0 * ones], axis=1)
    push = rng.uniform(0.0, 2.0, LANES) * alpha * G
    record = (push, 0.005 * ones, none, none, 64.0 * ones, ones)
    sinusoid = (rng.uniform(5.0, 50.0, LANES), none, push, ones)
    beside = np.arange(LANES) % 3
    x = np.choose(beside, [none, alpha, 0.5 * math.pi * ones]).astype(kind)
    for _ in range(4):
        x = np.where(rng.random(LANES) < 0.6, np.nextafter(x, np.where(beside == 0, kind(1.0), kind(0.0))), x)
    with jax.enable_x64(True):
        rows = [jnp.asarray(table, kind) for table in (pars, starts, np.stack(sinusoid if wave else record, axis=1))]
        base = Base(jnp.asarray(np.cos(np.arange(64.0)), kind), jnp.ones(8, kind))
        F = constants(*rows, wave)
        M = begun(F, rows[1])._replace(
            x=jnp.asarray(x), v=jnp.asarray(kind(10.0) ** rng.uniform(-10.0, -1.0, LANES).astype(kind)),
            k=jnp.asarray(rng.integers(0, 20, LANES)), tau=jnp.asarray(rng.random(LANES).astype(kind)) * F.dt,
            peak=jnp.asarray(np.where(rng.random(LANES) < 0.5, x, kind(0.0))),
        )  # fmt: skip
        step = jax.jit(lambda M: one_step(F, base, M, jnp.asarray(10**6), wave))
        for _ in range(30):
            M = step(M)
        later = step(step(M))  # what turned in a circle did so in two steps
    same = [np.array_equal(a, b, equal_nan=True) for a, b in zip(_columns(M), _columns(later), strict=True)]
    assert not np.any(same & (np.asarray(later.status) == RUNNING))


def _columns(M: Any) -> Any:
    """What each lane holds, shape (lane, number)."""
    return np.stack([np.asarray(column, np.float64) for column in M], axis=1)
