"""What a lane of the exact solver in JAX holds, where its base is, and how a run begins.

A lane is one run under way.  Time is counted in intervals of the base: those of the record and, before and after it,
others of the same length in which the base is at rest; or those of a grid laid over the sinusoid.

Source   as of `rocking.solvers.exact.kernel`, whose bounds these are.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import jax.numpy as jnp
from jax import lax

from rocking.hybrid import REST
from rocking.solvers.recording import REACHED_END

LONGEST_STEP, LONGEST_TURN = 1.0 / 16.0, 1.0 / 8.0
"""Longest step of a polynomial in p t, and in omega t of a sinusoid."""

RUNNING = -1
"""Status of a run under way; the others are those of `rocking.solvers.recording`."""


class Base(NamedTuple):
    """Samples that all lanes share; of no length for sinusoids."""

    values: Any  # [m/s^2], record after record, each filled up to whole blocks
    peaks: Any  # largest |value| of each block


class Fixed(NamedTuple):
    """Constants of a run, shape (lane,); accelerations are in g."""

    p: Any
    p2: Any
    alpha: Any
    onset: Any
    e: Any
    omega_rest: Any
    t_end: Any
    dt: Any  # interval [s]
    origin: Any  # begin of interval 0 [s]
    k_last: Any  # interval in which the run ends
    stop_last: Any  # where in it [s]
    count: Any  # intervals in which the base moves: 0 to count - 1
    limit: Any  # longest step of a polynomial [s]
    bulge: Any  # a flight leaves the tilts at both ends of a step by no more than this
    clear: Any  # with tilts above this at both ends of an interval, no impact lies within
    swell: Any  # a maximum exceeds the tilts at both ends of an interval by no more than this
    grow: Any  # exp(p dt)
    first: Any  # record: where its samples begin
    scale: Any  # record: factor on the samples [s^2/m]
    omega: Any  # sinusoid
    phase: Any
    rate: Any


class Moving(NamedTuple):
    """What changes on the way, shape (lane,)."""

    x: Any  # s theta
    v: Any  # s omega
    s: Any
    rests: Any
    tipped: Any  # whether it has just left rest
    k: Any  # interval
    tau: Any  # time in it [s]
    cap: Any  # not to be gone beyond in this interval [s]
    peak: Any
    passage: Any
    onset_time: Any
    impacts: Any
    events: Any
    stalls: Any
    last: Any  # time of the last event
    status: Any


def unit(x: Any) -> float:
    """Unit of rounding of the numbers of x [1]: the distance from 1 to the next."""
    return float(jnp.finfo(x.dtype).eps)


def least(x: Any) -> float:
    """The smallest positive number of the kind of x that has all its digits."""
    return float(jnp.finfo(x.dtype).tiny)


def stop_of(F: Fixed, k: Any) -> Any:
    """Where in interval k the run leaves it [s]."""
    return jnp.where(k == F.k_last, F.stop_last, F.dt)


def moment(F: Fixed, k: Any, tau: Any) -> Any:
    """Time [s]."""
    return F.origin + (k * F.dt + tau)


def ends_of_interval(F: Fixed, base: Base, k: Any) -> tuple[Any, Any]:
    """a_x/g of a record at both ends of interval k."""
    at = F.first + jnp.clip(k, 0, F.count - 1)
    moves = (k >= 0) & (k < F.count)
    return tuple(jnp.where(moves, F.scale * base.values[at + j], 0.0) for j in (0, 1))  # type: ignore[return-value]


def rate_at(F: Fixed, k: Any) -> Any:
    """How fast the sinusoid grows in interval k."""
    return jnp.where((k >= 0) & (k < F.count), F.rate, 0.0)


def turns(F: Fixed, k: Any, tau: Any) -> tuple[Any, Any, Any]:
    """(t, sine, cosine) of the sinusoid."""
    t = k * F.dt + tau
    return t, jnp.sin(F.omega * t + F.phase), jnp.cos(F.omega * t + F.phase)


def constants(pars: Any, starts: Any, motions: Any, wave: bool) -> Fixed:
    """Constants of the runs whose rows are given, shape (lane, column)."""
    p2, alpha, g, onset, e, omega_rest = pars.T
    p, t_end = jnp.sqrt(p2), starts[:, 5]
    zero = jnp.zeros_like(p)
    if wave:
        omega, phase, rate, duration = motions.T
        fastest = jnp.maximum(jnp.abs(omega), least(omega))
        count = jnp.ceil(duration / jnp.minimum(LONGEST_STEP / p, LONGEST_TURN / fastest))
        dt, origin, rate = duration / count, zero, rate / g
        most = jnp.abs(rate) * jnp.clip(t_end, 0.0, duration)
        limit = jnp.minimum(LONGEST_STEP / p, LONGEST_TURN / fastest)
        first = scale = zero
    else:
        scale, dt, origin, first, samples, largest = motions.T
        # A base that never moves is one whose record begins at the end.
        origin = jnp.where(jnp.isfinite(origin), origin, t_end)
        count, scale, limit = samples - 1.0, scale / g, LONGEST_STEP / p
        most, (omega, phase, rate) = jnp.abs(scale) * largest, (zero, zero, zero)
    # One number for all that hang on it: XLA may otherwise make it twice, rounded in two ways.
    dt, origin, limit = lax.optimization_barrier((dt, origin, limit))
    k_last = lax.optimization_barrier(jnp.floor((t_end - origin) / dt))
    stop_last = lax.optimization_barrier(t_end - (origin + k_last * dt))
    k_last, stop_last = jnp.where(stop_last > 0.0, k_last, k_last - 1.0), jnp.where(stop_last > 0.0, stop_last, dt)
    # The small additions cover the rounding of the bounds themselves.
    half = jnp.sinh(0.25 * p * jnp.maximum(dt, LONGEST_STEP / p))
    force = jnp.maximum(most - alpha, 0.0)
    step, more, rounding = jnp.minimum(dt, limit), 1.0 + 1e-6 + 16.0 * unit(p), 4.0 * unit(p)
    whole = jnp.int64
    return Fixed(
        p=p, p2=p2, alpha=alpha, onset=onset, e=e, omega_rest=omega_rest, t_end=t_end, dt=dt, origin=origin,
        k_last=k_last.astype(whole), stop_last=stop_last, count=count.astype(whole), limit=limit,
        bulge=0.125 * p2 * (0.5 * math.pi + most) * step * step * more + rounding,
        clear=2.0 * half * half * force * more + rounding * jnp.sign(force),
        swell=0.125 * p2 * (alpha + most) * dt * dt * more,
        grow=jnp.exp(p * dt), first=first.astype(whole), scale=scale, omega=omega, phase=phase, rate=rate,
    )  # fmt: skip


def begun(F: Fixed, starts: Any) -> Moving:
    """The runs at their start; starts: rows (mode, s, s theta, s omega, t_start, t_end)."""
    mode, s, x, v, t_start, _ = starts.T
    k = lax.optimization_barrier(jnp.minimum(jnp.floor((t_start - F.origin) / F.dt), F.k_last))
    tau = jnp.maximum(t_start - (F.origin + k * F.dt), 0.0)
    none = jnp.zeros(s.shape, jnp.int64)
    return Moving(
        x=x, v=v, s=s, rests=mode == REST, tipped=s > 2.0, k=k.astype(jnp.int64), tau=tau,
        cap=jnp.full_like(s, jnp.inf), peak=jnp.abs(x), passage=t_start, onset_time=jnp.full_like(s, jnp.nan),
        impacts=none, events=none, stalls=none, last=jnp.full_like(s, -jnp.inf), status=none + RUNNING,
    )  # fmt: skip


def idle(M: Moving) -> Moving:
    """Lanes without a run."""
    return M._replace(status=jnp.full_like(M.status, REACHED_END))
