"""A block as a hybrid system: modes, what flows within a mode, what ends it and what happens then.

This is the narrow waist between the physics and the solvers.  A system is four plain functions of an array
namespace `xp`, the continuous state `y`, the discrete state `q`, the base acceleration and the parameters:

- `flow(xp, y, q, base, par)` gives dy/dt as a tuple;
- `guards(xp, y, q, base, par)` gives numbers that are positive while the mode holds (inactive ones are 1);
- `jump(xp, y, q, base, par, k)` gives the state after guard `k` has fallen to zero, as (y, q);
- `balance(xp, y, par)` rises through zero when the block passes its tilt of unstable balance.

They use `xp`, arithmetic and each other, and no Python branch on a value, so one source runs on plain floats, compiles
under numba and traces under JAX.  The carrying corner `s`, the mode and the direction of slip are carried as state: the
sign of a number that may be zero is never asked for.

Two conventions hold for every system: guard 0 is the fall (the run ends there), and a guard that is zero
when a mode begins is taken as just left.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import IntEnum
from typing import Any, NamedTuple, Protocol

REST, SLIDE, ROTATION, SLIDE_ROTATION, TRANSLATION_JUMP, ROTATION_JUMP = range(6)

INADMISSIBLE = -1
"""Mode of a state that the model cannot carry on from; the system says why in `inadmissible_reason`."""


class Mode(IntEnum):
    """The six modes of Ishiyama (1982); Method 1 knows rest and rotation only."""

    REST = REST
    SLIDE = SLIDE
    ROTATION = ROTATION
    SLIDE_ROTATION = SLIDE_ROTATION
    TRANSLATION_JUMP = TRANSLATION_JUMP
    ROTATION_JUMP = ROTATION_JUMP


class Base(NamedTuple):
    """Acceleration of the base [m/s^2], gravity not in it."""

    a_x: Any
    a_z: Any


class Discrete(NamedTuple):
    """Discrete part of the state."""

    mode: Any  # one of Mode
    s: Any  # carrying corner: +1.0 the +x corner, -1.0 the other
    slip: Any  # direction in which the carrying corner slips: +1.0 or -1.0; meaningless where it sticks


class System(Protocol):
    """A block under one method: what a solver needs to know of it."""

    @property
    def name(self) -> str:
        """Name of the method."""

    @property
    def state_names(self) -> tuple[str, ...]:
        """Names of the entries of `y`, `theta` and `omega` among them."""

    @property
    def guard_names(self) -> tuple[str, ...]:
        """What each guard watches; the first is the fall."""

    @property
    def parameters(self) -> Any:
        """NamedTuple of floats that the four functions take as `par`."""

    @property
    def theta_c(self) -> float:
        """Tilt of unstable balance [rad]."""

    @property
    def inadmissible_reason(self) -> str:
        """A sentence on what happened when a run ends in the mode INADMISSIBLE."""

    @property
    def flow(self) -> Callable[..., Any]:
        """dy/dt."""

    @property
    def guards(self) -> Callable[..., Any]:
        """Positive while the mode holds."""

    @property
    def jump(self) -> Callable[..., Any]:
        """State after a guard has fallen to zero."""

    @property
    def balance(self) -> Callable[..., Any]:
        """Rises through zero at the tilt of unstable balance."""

    def initial_state(self, theta: float, omega: float) -> tuple[tuple[float, ...], Discrete]:
        """State (y, q) at the start: released at `theta` [rad] with `omega` [rad/s], or at rest."""
