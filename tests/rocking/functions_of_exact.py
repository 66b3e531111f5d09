"""What the tests of functions of the exact solver share: plain Python for compiled code, closed forms, followed blocks.

The compiled functions are called by their Python sources, and those for devices with NumPy in place of JAX, so that
nothing is compiled.
"""

import math
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pytest
from numba.core.dispatcher import Dispatcher

from rocking.hybrid import ROTATION
from rocking.solvers.exact import jax_flight, jax_lanes, jax_rounds, kernel, step
from rocking.solvers.exact.kernel import Sine
from rocking.solvers.exact.step import Body
from rocking.solvers.piecewise import polynomial
from rocking.solvers.taylor.records import BLOCK

G = 9.81
PAR = (9.0, 0.23, G, 0.19, 0.8, 1e-3)  # p^2, alpha, g, onset, e, omega_rest
BODY = Body(ROTATION, -1.0, 0.11, 0.37)
WAVE = Sine(5.0, 0.4, 1.7, 6.0)
COEFFICIENTS = tuple((-1.0) ** (n // 2) * (n + 1.3) ** 1.5 for n in range(10))


@pytest.fixture(autouse=True)
def interpreted(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Every function by its Python source; a b + c rounded twice."""
    for module in (polynomial, step, kernel):
        for name, thing in list(vars(module).items()):
            if isinstance(thing, Dispatcher):
                monkeypatch.setattr(module, name, thing.py_func)
        monkeypatch.setattr(module, "fma", lambda a, b, c: a * b + c)
    for module in (jax_flight, jax_lanes, jax_rounds):
        monkeypatch.setattr(module, "jnp", np)
        monkeypatch.setattr(module, "lax", SimpleNamespace(optimization_barrier=lambda x: x), raising=False)
    with np.errstate(all="ignore"):
        yield


def counting(monkeypatch: pytest.MonkeyPatch, module: Any, name: str) -> list[int]:
    """How often a function is called from now on."""
    calls, function = [0], getattr(module, name)

    def counted(*args: Any) -> Any:
        calls[0] += 1
        return function(*args)

    monkeypatch.setattr(module, name, counted)
    return calls


def log_of(save_at: Any = (), room: int = 50) -> Any:
    """Room for a run that is written down."""
    n = len(save_at)
    return SimpleNamespace(
        event_t=np.full(room, np.nan), event_code=np.full((room, 3), -9), event_s=np.zeros(room),
        event_y=np.full((room, 2, 2), np.nan), save_at=np.array(save_at, dtype=float), y=np.full((n, 2), np.nan),
        mode=np.full(n, -9), s=np.zeros(n),
    )  # fmt: skip


def first_fall(c: Any, h: float) -> float:
    """First root in (0, h] where a polynomial with c(0) > 0 turns negative, by numpy.roots; inf if there is none."""
    roots = np.roots(np.trim_zeros(np.asarray(c, dtype=float), "b")[::-1])
    real = roots[np.abs(roots.imag) < 1e-9].real
    real = np.sort(real[(real > 0.0) & (real <= h)])
    if not real.size:
        return math.inf
    plain = np.polynomial.Polynomial(np.asarray(c, dtype=float))
    return float(real[0] - plain(real[0]) / plain.deriv()(real[0]))


def column(c: Any, lane: int) -> np.ndarray:
    return np.array([part[lane] for part in c])


# ------------------------------------------------------------------------------------------------ closed forms


def linear_flight(body: Body, par: Any, a: float, slope: float) -> Any:
    """x(t) = alpha + s (a + slope t)/g + A cosh + B sinh: the solution of x'' = p^2 (x - alpha - s a_x/g)."""
    p, f = mpmath.sqrt(par[0]), body.s / mpmath.mpf(par[2])
    A, B = body.x - par[1] - f * a, (body.v - f * slope) / p
    return lambda t: par[1] + f * (a + slope * t) + A * mpmath.cosh(p * t) + B * mpmath.sinh(p * t)


def sine_flight(body: Body, par: Any, sine: Sine, t0: float) -> Any:
    """The same under rate t sin(omega t + phase): forced part C t sin + D cos, from Wylie & Barrett's tables."""
    p, w = mpmath.sqrt(par[0]), mpmath.mpf(sine.omega)
    C = -body.s * par[0] * sine.rate / par[2] / -(w * w + par[0])
    D = 2 * w * C / (w * w + par[0])

    def forced(t: Any) -> Any:
        return C * t * mpmath.sin(w * t + sine.phase) + D * mpmath.cos(w * t + sine.phase)

    A, B = body.x - par[1] - forced(t0), (body.v - mpmath.diff(forced, t0)) / p
    return lambda t: par[1] + forced(t0 + t) + A * mpmath.cosh(p * t) + B * mpmath.sinh(p * t)


def flown(x: Any, t: Any) -> np.ndarray:
    with mpmath.workdps(30):
        return np.array([[float(x(s)), float(mpmath.diff(x, s))] for s in np.atleast_1d(t)])


# ------------------------------------------------------------------------------------------------ runs


def plan_of(dt: float = 0.02, a_max: float = 4.0, par: Any = PAR, max_events: int = 40) -> Any:
    return kernel.new_plan(par, dt, a_max, max_events)


def fresh(plan: Any, body: Body = BODY, t_end: float = 99.0) -> Any:
    return step.new_tally(body, plan, 0.5, t_end)


def fixed_of(wave: bool) -> Any:
    """Constants of two runs: a record of 40 samples from 0.25 s on, or a sine over 1.5 s."""
    pars = np.array([PAR, (16.0, 0.3, 9.7, 0.25, 0.7, 1e-4)])
    starts = np.array([[0.0, 1.0, 0.1, 0.0, 0.0, 1.0], [1.0, -1.0, 0.2, 0.3, 0.4, 1.3]])
    motions = [[5.0, 0.4, 1.7, 1.5], [9.0, 0.1, 2.0, 1.25]] if wave else [
        [1.5, 0.02, 0.25, 0.0, 40.0, 4.0], [-2.0, 0.03, 0.35, 64.0, 30.0, 3.0]]  # fmt: skip
    return jax_lanes.constants(pars, starts, np.array(motions), wave), starts


def base_of(seed: int = 4) -> Any:
    values = np.random.default_rng(seed).normal(size=192)
    return jax_lanes.Base(values, np.abs(values).reshape(-1, BLOCK).max(axis=1))


# ------------------------------------------------------------------------------------------------ followed blocks


class Followed:
    """One block followed by sampling and bisection of its closed forms: samples every 2e-3 s, piece by piece."""

    def __init__(self, body: Body, par: Any) -> None:
        self.body, self.par, self.t = body, par, 0.0
        self.impacts: list[float] = []
        self.peak = body.x

    def over(self, push: Any, flight: Any, stop: float) -> None:
        """Until stop over a base whose acceleration is push(t), by flight(body, t) -> x(tau)."""
        while self.t < stop:
            x = flight(self.body, self.t)
            tau = np.append(np.arange(0.0, stop - self.t, 2e-3), stop - self.t)
            tilts = x(tau)[0]
            below = np.flatnonzero(tilts[1:] <= 0.0) + 1
            if not below.size:
                self.peak = max(self.peak, tilts.max())
                self.t, self.body = stop, self.body._replace(x=tilts[-1], v=x(tau[-1:])[1][0])
                return
            low, high = tau[below[0] - 1], tau[below[0]]
            for _ in range(60):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if x(np.array([middle]))[0][0] > 0.0 else (low, middle)
            self.peak = max(self.peak, tilts[: below[0]].max())
            v = -self.par[4] * x(np.array([high]))[1][0]
            self.t += high
            self.impacts.append(self.t)
            self.body = Body(ROTATION, -self.body.s, 0.0, v)


def line_flight_of(par: Any, a: float, slope: float, t_0: float) -> Any:
    p = math.sqrt(par[0])

    def flight(body: Body, t: float) -> Any:
        f = body.s / par[2]
        A, B = body.x - par[1] - f * (a + slope * (t - t_0)), (body.v - f * slope) / p

        def x(tau: Any) -> Any:
            u = par[1] + f * (a + slope * (t - t_0 + tau))
            cosh, sinh = np.cosh(p * tau), np.sinh(p * tau)
            return u + A * cosh + B * sinh, f * slope + p * (A * sinh + B * cosh)

        return x

    return flight


def sine_flight_of(par: Any, wave: Sine) -> Any:
    p = math.sqrt(par[0])

    def flight(body: Body, t: float) -> Any:
        C = body.s * par[0] * wave.rate / par[2] / (wave.omega**2 + par[0])
        D = 2.0 * wave.omega * C / (wave.omega**2 + par[0])

        def forced(at: Any) -> Any:
            sine, cosine = np.sin(wave.omega * at + wave.phase), np.cos(wave.omega * at + wave.phase)
            speed = C * sine + C * at * wave.omega * cosine - D * wave.omega * sine
            return C * at * sine + D * cosine, speed

        y, y_v = forced(t)
        A, B = body.x - par[1] - y, (body.v - y_v) / p

        def x(tau: Any) -> Any:
            y, y_v = forced(t + tau)
            cosh, sinh = np.cosh(p * tau), np.sinh(p * tau)
            return par[1] + y + A * cosh + B * sinh, y_v + p * (A * sinh + B * cosh)

        return x

    return flight
