"""Method 2 with effects: a block of any form that slides and jumps as well as rocks, with what effects add.

The form is Method 2's own (`rocking.method2_equations`).  An effect that adds an angular acceleration to a block on a
fixed corner is a couple of so much times its inertia there, which acts in every mode; one that changes restitution has
its say at the rocking impacts of the law "two_corner".

Source   own derivation; what the effects add is what `rocking.composed` has of them.
Status   equal to `rocking.composed` where friction does not give way, and to the laboratory of `studies` where it does
         (tests).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

from rocking.composed import added, changed
from rocking.form import Form
from rocking.hybrid import Anchor, Base, Discrete, Hooks
from rocking.method2 import Method2
from rocking.method2_equations import balance, flow_with, guards_with
from rocking.method2_transitions import jump_with


class Parameters(NamedTuple):
    """Those of `rocking.method2_equations`, and the hooks of the effects."""

    a: float
    r: float
    o: float
    H: float
    rho2: float
    g: float
    hold: float
    mu_s: float
    mu_k: float
    e_n: float
    e_t: float
    law: float
    e_right: float
    e_left: float
    ratio_kept: float
    omega_rest: float
    chatter_time: float
    balance_right: float
    balance_left: float
    hooks: Any  # Hooks


def turning(xp: Any, theta: Any, omega: Any, s: Any, base: Base, par: Any) -> Any:
    """Angular acceleration [rad/s^2] that the effects add on a fixed corner."""
    return added(theta, omega, s, base, par)


def flow(xp: Any, y: Any, q: Discrete, base: Base, par: Any) -> tuple[Any, ...]:
    """dy/dt in the mode q.mode."""
    return flow_with(xp, y, q, base, par, turning)


def guards(xp: Any, y: Any, q: Discrete, base: Base, par: Any) -> tuple[Any, ...]:
    """Positive while the mode holds, as of `rocking.method2_equations.guards`."""
    return guards_with(xp, y, q, base, par, turning)


def jump(xp: Any, y: Any, q: Discrete, base: Base, par: Any, k: Any) -> tuple[tuple[Any, ...], Discrete]:
    """State and mode after guard k has ended the mode q.mode."""
    return jump_with(xp, y, q, base, par, k, turning, changed)


@dataclass(frozen=True)
class ComposedMethod2:
    """Method 2 with hooks; made by `rocking.effects.compose`.

    Args:
        method: the block under Method 2, with its form.
        hooks: what effects add to flow and impact.
        effects: for the record, what was composed.

    Raises:
        ValueError: an effect changes the restitution, and the method's impacts have none of their own.
    """

    method: Method2
    hooks: Hooks
    effects: tuple[Any, ...] = field(default=())

    name = Method2.name
    state_names = Method2.state_names
    guard_names = Method2.guard_names
    carries_pitch = True
    inadmissible_reason = Method2.inadmissible_reason
    flow = staticmethod(flow)
    guards = staticmethod(guards)
    jump = staticmethod(jump)
    balance = staticmethod(balance)

    def __post_init__(self) -> None:
        if self.hooks.striking > 0 and self.method.impact_law != "two_corner":
            raise ValueError(
                f"impact_law={self.method.impact_law!r}: an effect changes the restitution, which only impacts of the "
                "law 'two_corner' have as a number"
            )

    @property
    def block(self) -> Any:
        """The ideal block."""
        return self.method.block

    @property
    def form(self) -> Form:
        """Its form."""
        return self.method.shape

    @property
    def g(self) -> float:
        """Acceleration of gravity [m/s^2]."""
        return self.method.g

    @property
    def theta_c(self) -> float:
        """The smaller of the two tilts of unstable balance [rad]."""
        return self.method.theta_c

    @cached_property
    def parameters(self) -> Parameters:
        """The numbers that the equations take."""
        return Parameters(*self.method.parameters, self.hooks)

    def initial_state(self, theta: float = 0.0, omega: float = 0.0, **more: float) -> tuple[Any, Discrete]:
        """As of `Method2.initial_state`."""
        return self.method.initial_state(theta, omega, **more)

    def anchor(self, y: Any, rate: Any, s: Any) -> Anchor:
        """As of `Method2.anchor`."""
        return self.method.anchor(y, rate, s)
