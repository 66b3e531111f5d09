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

WITHIN = 1e-14
"""A block at rest, or sliding on both corners, bears a push that exceeds what holds it by this share [1]: the two count
as equal.  One and the same product is rounded in one place, and fused with the sum behind it by a compiler in another.
Guards let twice as much pass, so that a block which a jump has judged to stand does so in the mode that follows."""

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
    """What the base does: acceleration, gravity not in it, and pitch about the middle of where the block stands."""

    a_x: Any  # [m/s^2], horizontal
    a_z: Any  # [m/s^2], vertical
    pitch: Any = 0.0  # [rad], clockwise positive like theta
    pitch_acceleration: Any = 0.0  # [rad/s^2]


def in_floor_axes(xp: Any, base: Base, g: Any) -> tuple[Any, Any]:
    """(A_x, A_z) [m/s^2]: acceleration of the base less gravity, along the floor and normal to it.

    On a level floor that is (a_x, g + a_z).  A body in the frame of the floor feels the opposite of it.
    """
    cos, sin = xp.cos(base.pitch), xp.sin(base.pitch)
    G = g + base.a_z
    return base.a_x * cos - G * sin, base.a_x * sin + G * cos


class Hooks(NamedTuple):
    """What effects add to the equations of a system; the last field, `hooks`, of parameters that have any.

    A system calls `accelerations[i](theta, omega, s, base, values[i])` for an angular acceleration [rad/s^2] and
    `restitutions[i](e, omega, s, values[slots + i])` for a restitution.  The functions are written with an array
    namespace `xp` before these arguments; a solver binds it (`bind_hooks`).
    """

    accelerations: tuple[Callable[..., Any], ...]
    restitutions: tuple[Callable[..., Any], ...]
    values: tuple[tuple[Any, ...], ...]  # a row for each function, 2 slots of them of one length
    pushing: int  # how many of the accelerations are there; the rest of the tuple only fills it up
    striking: int  # how many of the restitutions


def bind_hooks(par: Any, bind: Callable[[Callable[..., Any]], Callable[..., Any]]) -> Any:
    """Parameters whose hooks have their namespace bound; parameters without hooks as they are."""
    hooks = getattr(par, "hooks", None)
    if hooks is None:
        return par
    accelerations, restitutions = tuple(map(bind, hooks.accelerations)), tuple(map(bind, hooks.restitutions))
    return par._replace(hooks=hooks._replace(accelerations=accelerations, restitutions=restitutions))


def numbers_of(par: Any) -> Any:
    """Parameters with the values of their hooks in place of these: numbers alone."""
    return par._replace(hooks=par.hooks.values) if hasattr(par, "hooks") else par


class Discrete(NamedTuple):
    """Discrete part of the state."""

    mode: Any  # one of Mode
    s: Any  # carrying corner: +1.0 the +x corner, -1.0 the other
    slip: Any  # direction in which the carrying corner slips: +1.0 or -1.0; meaningless where it sticks


class Anchor(NamedTuple):
    """A point of the block whose motion relative to the base the state tells at once."""

    X: Any  # where it is in the block frame [m]
    Z: Any
    x: Any  # where it is over the base [m]
    z: Any
    a_x: Any  # its acceleration relative to the base [m/s^2], in the axes of the floor
    a_z: Any


class System(Protocol):
    """A block under one method: what a solver needs to know of it."""

    @property
    def name(self) -> str:
        """Name of the method."""

    @property
    def state_names(self) -> tuple[str, ...]:
        """Names of the entries of `y`, `theta` and `omega` among them.

        A system with states of its own may have `state_labels`, a mapping from their names to (units, long name).
        """

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
    def g(self) -> float:
        """Acceleration of gravity [m/s^2]."""

    @property
    def carries_pitch(self) -> bool:
        """Whether its equations have the pitch of the base in them."""

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

    def anchor(self, y: Any, rate: Any, s: Any) -> Anchor:
        """The point that instruments take as known, from a state, its rate of change and the carrying side."""
