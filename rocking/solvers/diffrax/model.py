"""The types of the traced loop: the functions of a system on a motion, the numbers of a run, and where a run is.

Status   all but `Model`, `Recorder` and `Physics` are nests of arrays, as JAX carries them round a loop.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple, Protocol

import jax.numpy as jnp
from jax import lax

from rocking.hybrid import Base, Discrete, Hooks, System, bind_hooks
from rocking.motion import BaseMotion, pitch_kernel
from rocking.solvers.diffrax.steps import Attempt

RUNNING = -1
"""Status of a run that is not over."""


class Model(NamedTuple):
    """What a compiled loop is made for: functions, and where in the state to look.  Hashable."""

    flow: Callable[..., Any]
    guards: Callable[..., Any]
    jump: Callable[..., Any]
    balance: Callable[..., Any]
    motion: Callable[..., Any]
    theta: int
    omega: int
    impacts: tuple[int, ...]  # the guards that are impacts
    pitch: Callable[..., Any] | None = None  # pitch_kernel of the motion
    accelerations: tuple[Callable[..., Any], ...] = ()  # hooks of the system, if it has any
    restitutions: tuple[Callable[..., Any], ...] = ()
    pushing: int = 0  # how many of them are there
    striking: int = 0

    def with_hooks(self, numbers: Any) -> Any:
        """The parameters that the system's functions take, from their numbers alone (`hybrid.numbers_of`)."""
        if not hasattr(numbers, "hooks"):
            return numbers
        hooks = Hooks(self.accelerations, self.restitutions, numbers.hooks, self.pushing, self.striking)
        whole = numbers._replace(hooks=hooks)
        return bind_hooks(whole, lambda hook: partial(hook, jnp))


def model_of(system: System, motion: BaseMotion) -> Model:
    """The functions of a system on a motion."""
    states, guards = system.state_names, system.guard_names
    impacts = tuple(guards.index(name) for name in ("impact", "landing", "contact") if name in guards)
    functions = (system.flow, system.guards, system.jump, system.balance, motion.kernel)
    hooks = getattr(system.parameters, "hooks", Hooks((), (), (), 0, 0))
    return Model(
        *functions, states.index("theta"), states.index("omega"), impacts,
        pitch_kernel(motion), hooks.accelerations, hooks.restitutions, hooks.pushing, hooks.striking,
    )  # fmt: skip


class Inputs(NamedTuple):
    """The numbers of a run."""

    par: Any  # parameters of the system, as numbers alone
    motion_par: Any  # shape (parameter,)
    edges: Any  # times [s] between which the motion is smooth, ascending, shape (stretch + 1,)
    max_step: Any  # [s]
    rtol: Any
    atol: Any
    save_at: Any  # [s], ascending, shape (time,)
    max_events: Any


class Progress(NamedTuple):
    """Where a run is."""

    t: Any  # [s]
    y: Any  # shape (state,)
    q: Discrete
    h: Any  # length [s] that the error control proposes
    aim: Any  # time [s] from t to the event that the next step leads to
    guard: Any  # the guard of that event; -1 if there is none
    stretch: Any
    fresh: Any  # whether the mode or the stretch begins here
    last_event: Any  # [s]
    stalled: Any
    events: Any
    steps: Any
    status: Any


class Taken(NamedTuple):
    """The step just taken, for a recorder; all of it is without meaning unless `taken`."""

    taken: Any
    step: Attempt
    y0: Any
    t: Any  # where it ended [s]
    y: Any
    q: Discrete
    passed: Any  # whether the tilt of unstable balance was passed outward
    t_passed: Any
    y_passed: Any


class Event(NamedTuple):
    """The event just met; all of it is without meaning unless `fired`."""

    fired: Any
    guard: Any
    t: Any
    y_before: Any
    q_before: Discrete
    y: Any
    q: Discrete


class Recorder(Protocol):
    """Keeps what is wanted of a run; hashable."""

    def room(self, record: Any) -> Any:
        """Whether there is room for what one more round may bring."""

    def keep(self, model: Model, inputs: Inputs, record: Any, taken: Taken, event: Event) -> Any:
        """The record with a step and an event."""


@dataclass(frozen=True)
class Physics:
    """The functions of the model on one smooth stretch of the motion."""

    model: Model
    par: Any
    motion_par: Any
    low: Any
    high: Any

    def base(self, t: Any) -> Base:
        """Base acceleration; at an edge of the stretch its limit from within."""
        inside = t + lax.stop_gradient(jnp.clip(t, self.low, self.high) - t)
        acceleration = self.model.motion(jnp, inside, self.motion_par)
        pitch = () if self.model.pitch is None else self.model.pitch(jnp, inside, self.motion_par)
        return Base(*(value + 0.0 * t for value in (*acceleration, *pitch)))

    def flow(self, t: Any, y: Any, q: Discrete) -> Any:
        """dy/dt, shape (state,)."""
        return _row(self.model.flow(jnp, y, q, self.base(t), self.model.with_hooks(self.par)), y)

    def guards(self, t: Any, y: Any, q: Discrete) -> Any:
        """Values of the guards, shape (guard,)."""
        return _row(self.model.guards(jnp, y, q, self.base(t), self.model.with_hooks(self.par)), y)

    def balance(self, y: Any) -> Any:
        """Rises through zero at the tilt of unstable balance."""
        return self.model.balance(jnp, y, self.par)

    def jump(self, t: Any, y: Any, q: Discrete, guard: Any) -> tuple[Any, Discrete]:
        """State after the guard has fallen to zero."""
        after, q_after = self.model.jump(jnp, y, q, self.base(t), self.model.with_hooks(self.par), guard)
        return _row(after, y), discrete(q_after)


def _row(values: Any, y: Any) -> Any:
    return jnp.stack([jnp.asarray(value, y.dtype) for value in values])


def discrete(q: Discrete) -> Discrete:
    """The discrete state as arrays of fixed types."""
    floats = jnp.result_type(float)
    return Discrete(jnp.asarray(q.mode, jnp.int32), jnp.asarray(q.s, floats), jnp.asarray(q.slip, floats))
