"""One step of Diffrax's Dormand-Prince 8(7), its dense output, and what is looked for within a step.

Diffrax loops over the stages of a Runge-Kutta method; here the loop is written out, which XLA fuses into one kernel
(five times faster on small states).  Coefficients and dense output are Diffrax's own.

Source   Prince & Dormand (1981), J. Comput. Appl. Math. 7, 67-75, for the pair; Bogacki & Shampine (1990), Comput.
         Math. Appl. 20, 15-24, for the dense output; Dowell & Jarratt (1971), BIT 11, 168-174, for the Illinois method.
Status   explicit steps alone: the systems are not stiff.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import diffrax
import jax
import jax.numpy as jnp
from jax import lax

from rocking.solvers.recording import CHECKS_PER_STEP

ERROR_ORDER = 8
"""The error of a step grows with this power of its length."""

SHARE_TOLERANCE = 1e-10
"""Share of a step to which a zero is bracketed on the dense output; a true step makes it exact."""

MAX_BRACKETINGS = 100
"""More than bisection alone would need for SHARE_TOLERANCE; a guard that is not finite ends here."""


class WrittenOutDopri8(diffrax.Dopri8):
    """Diffrax's Dopri8 with its stages written out."""

    def step(
        self, terms: Any, t0: Any, t1: Any, y0: Any, args: Any, solver_state: Any, made_jump: Any
    ) -> tuple[Any, Any, dict[str, Any], Any, Any]:
        """One step from t0 to t1; nothing is carried over from the step before, so a jump in between does no harm."""
        h = t1 - t0
        k = [terms.vf(t0, y0, args) * h]
        y = y0
        for weights, c in zip(self.tableau.a_lower, self.tableau.c, strict=True):
            y = y0 + _combination(weights, k)
            k.append(terms.vf(jnp.where(c == 1.0, t1, t0 + c * h), y, args) * h)
        # The last stage stands at the end of the step: its argument is the solution of order 8.
        error = _combination(self.tableau.b_error, k)
        return y, error, {"y0": y0, "y1": y, "k": jnp.stack(k)}, solver_state, diffrax.RESULTS.successful


def _combination(weights: Any, k: list[Any]) -> Any:
    return sum(float(w) * slope for w, slope in zip(weights, k, strict=True) if w != 0.0)


SOLVER = WrittenOutDopri8()


class Attempt(NamedTuple):
    """A step that has been tried."""

    t0: Any  # [s]
    t1: Any  # [s]
    y1: Any  # shape (state,)
    slope: Any  # dy/dt at the end, shape (state,)
    error: Any  # estimate, shape (state,)
    dense: Any  # Diffrax's interpolation

    def at(self, t: Any) -> Any:
        """State at the time t [s] within the step."""
        return self.dense.evaluate(t)

    def time(self, share: Any) -> Any:
        """Time [s] at a share of the step."""
        return self.t0 + share * (self.t1 - self.t0)


def attempt(flow: Callable[..., Any], t0: Any, t1: Any, y0: Any) -> Attempt:
    """Try a step of `flow(t, y)` from (t0, y0) to t1."""
    term = diffrax.ODETerm(lambda t, y, args: flow(t, y))
    y1, error, info, _, _ = SOLVER.step(term, t0, t1, y0, None, None, True)
    return Attempt(t0, t1, y1, info["k"][-1] / (t1 - t0), error, SOLVER.interpolation_cls(t0=t0, t1=t1, **info))


def error_norm(error: Any, y0: Any, y1: Any, rtol: Any, atol: Any) -> Any:
    """Root mean square of the error against the tolerance; 1 is just accepted."""
    scale = atol + rtol * jnp.maximum(jnp.abs(y0), jnp.abs(y1))
    return jnp.sqrt(jnp.mean((error / scale) ** 2))


class Bracket(NamedTuple):
    """Shares of a step between which something falls through zero."""

    low: Any
    at_low: Any
    high: Any
    at_high: Any
    unknown: Any  # whether at_low only stands for "positive"
    moved: Any  # the end that moved last: -1 low, +1 high, 0 neither
    tries: Any


def _narrower(f: Callable[[Any], Any], b: Bracket) -> Bracket:
    """One evaluation more.  An end that stays twice running counts for half, so that it moves soon."""
    secant = (b.low * b.at_high - b.high * b.at_low) / (b.at_high - b.at_low)
    inside = ~b.unknown & (secant > b.low) & (secant < b.high)
    x = jnp.where(inside, secant, 0.5 * (b.low + b.high))
    value = f(x)
    positive = value > 0.0
    half_high = jnp.where(b.moved == -1, 0.5, 1.0)
    half_low = jnp.where((b.moved == 1) & ~b.unknown, 0.5, 1.0)
    return Bracket(
        jnp.where(positive, x, b.low),
        jnp.where(positive, value, half_low * b.at_low),
        jnp.where(positive, b.high, x),
        jnp.where(positive, half_high * b.at_high, value),
        b.unknown & ~positive,
        jnp.where(positive, -1, 1),
        b.tries + 1,
    )


def fall_through_zero(
    f: Callable[[Any], Any], wanted: Any, low: Any, at_low: Any, high: Any, at_high: Any, just_left: Any = False
) -> Any:
    """Share of the step in (low, high] at which f falls through zero (Illinois method); of no use if not wanted.

    f(high) is not positive; just_left: f(low) is zero because the mode began there, and counts as positive.
    """
    just_left = jnp.asarray(just_left)
    begin = Bracket(low, jnp.where(just_left, 1.0, at_low), high, at_high, just_left, 0, 0)

    def undecided(b: Bracket) -> Any:
        wide = (b.high - b.low > SHARE_TOLERANCE) & (b.tries < MAX_BRACKETINGS)
        return wanted & wide & (b.at_low > 0.0) & (b.at_high < 0.0)

    end = lax.while_loop(undecided, lambda b: _narrower(f, b), begin)
    # A zero that already stands at the low end, and was not seen below zero there, is where it falls.
    return jnp.where(end.at_low > 0.0, end.high, jnp.maximum(end.low, SHARE_TOLERANCE))


def first_guard(guards: Callable[[Any, Any], Any], now: Any, step: Attempt, search: Any, fresh: Any) -> tuple[Any, Any]:
    """(guard, share of the step) of the first guard to fall below zero within the step; guard -1 if none does.

    `guards(t, y)`, shape (guard,), are `now` at the start and looked at CHECKS_PER_STEP times; fresh: the mode begins
    with the step.
    """

    def at_share(share: Any) -> Any:
        t = step.time(share)
        return guards(t, step.at(t))

    shares = jnp.arange(CHECKS_PER_STEP + 1) / CHECKS_PER_STEP
    within = jax.vmap(at_share)(shares[1:-1])
    looks = jnp.concatenate([now[None], within, guards(step.t1, step.y1)[None]])
    seen = jnp.any(looks[1:] < 0.0, axis=1)
    found = search & jnp.any(seen)
    look = jnp.argmax(seen)
    crossing = looks[look + 1] < 0.0

    def least(values: Any) -> Any:
        return jnp.min(jnp.where(crossing, values, jnp.inf))

    share = fall_through_zero(
        lambda share: least(at_share(share)),
        found,
        shares[look],
        least(looks[look]),
        shares[look + 1],
        least(looks[look + 1]),
        fresh & (look == 0),
    )
    first = jnp.argmin(jnp.where(crossing, at_share(share), jnp.inf))
    return jnp.where(found, first, -1), share
