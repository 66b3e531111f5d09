"""What comes out of a run as numbers that JAX can differentiate and map: `response`, `sensitivity`, `batch`.

How the third impact of a block that is pushed hangs on its restitution [s], and on its height [s/m]:

>>> from rocking import Block, Method1
>>> from rocking.solvers.diffrax.parameters import parameters_for
>>> system = Method1(Block(b=0.2, h=0.8), restitution=0.9, g=9.81)
>>> def run(x):
...     parameters = parameters_for(system, restitution=x["e"], h=x["h"])
...     return response(system, parameters=parameters, omega=0.8, t_end=3.0, keep_impacts=3)
>>> value, slope = sensitivity(run, {"e": 0.9, "h": 0.8})
>>> [round(float(third[2]), 6) for third in (value.impact_times, *slope.impact_times.values())]
[1.252554, 1.808239, 4.38583]

A hundred amplitudes of a base motion at once; `parameters_for` likewise takes arrays of sizes:

>>> import numpy as np
>>> from excitation import RampedSinusoid
>>> motion = RampedSinusoid(frequency=2.0, duration=5.0, final_amplitude=1.0)
>>> array = np.tile(motion.parameters, (100, 1))
>>> array[:, 2] *= np.linspace(2.0, 12.0, 100)  # m/s^2 in each second
>>> bool(batch(system, motion, motion_parameters=array, t_end=6.0).overturned[-1])
True

Derivatives are first order, forward mode, and go right through the impacts (`rocking.solvers.diffrax.loop`).  They are
those of the run as it went: which impacts there are, and whether the block falls, is a step function of the
parameters, and where a corner only grazes the floor no derivative exists.  Reverse mode (`jax.grad`) is not offered,
and a second derivative would be wrong: take differences of first ones.

Source   design of the derivatives: `rocking.solvers.diffrax.loop`.
Status   breakpoints of the motion stay where they are unless `breakpoints` says how they move with a parameter.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import ArrayLike

from rocking.arguments import check_start, check_tilt
from rocking.hybrid import Discrete, System, numbers_of
from rocking.motion import BaseMotion, Still
from rocking.solvers.diffrax.model import discrete, model_of
from rocking.solvers.diffrax.records import SummaryRecorder
from rocking.solvers.diffrax.runs import Response, Run, groups, limits_of, run_many, run_one
from rocking.validation import positive

__all__ = ["Response", "batch", "response", "sensitivity"]


def response(
    system: System,
    motion: BaseMotion | None = None,
    *,
    t_end: float,
    t_start: float = 0.0,
    theta: float = 0.0,
    omega: float = 0.0,
    initial: tuple[Any, Discrete] | None = None,
    parameters: Any = None,
    motion_parameters: Any = None,
    breakpoints: Any = None,
    max_step: Any = None,
    keep_impacts: int = 32,
    save_at: ArrayLike = (),
    rtol: float = 1e-9,
    atol: float = 1e-12,
    max_events: int = 1_000_000,
) -> Response:
    """One run, from numbers to numbers; may stand inside `sensitivity` and JAX's own jvp, jacfwd, vmap and jit.

    Args:
        system, motion: the block under a method; what the base does (at rest if not given).
        t_end, t_start: times [s].
        theta, omega: rotation [rad] and angular velocity [rad/s] at the start, plain floats.
        initial: state (y, q) at the start in place of them; y, shape (state,) or a tuple, may be traced: its rotation
            is then not held against its range, -pi/2 to pi/2.
        parameters: in place of `system.parameters`: a NamedTuple of the same kind, entries may be traced.
        motion_parameters: in place of `motion.parameters`, shape (parameter,), may be traced.
        breakpoints: in place of `motion.breakpoints` [s], shape (breakpoint,), may be traced.
        max_step: in place of `motion.max_step` [s].
        keep_impacts: how many impact times are kept.
        save_at: times [s], ascending, shape (time,), at which the state is kept.
        rtol, atol: relative and absolute tolerance [SI units of the state] of a step.
        max_events: the run ends as failed when it has more events.

    Returns:
        Response: of NumPy values, or of traced ones if an argument was traced.

    Raises:
        ValueError: an argument is out of range, or a traced one has not 64 bits: put the transformation inside
            `with jax.enable_x64(True):`.
    """
    base = Still() if motion is None else motion
    run = _run(
        system, base, (t_start, t_end), (theta, omega), initial,
        parameters, motion_parameters, breakpoints, max_step,
    )  # fmt: skip
    recorder = _recorder(keep_impacts)
    limits = _checked((t_start, t_end), rtol, atol, save_at, max_events)
    if any(isinstance(leaf, jax.core.Tracer) for leaf in jax.tree.leaves(run)):
        _want_64_bits(run)
        return run_one(model_of(system, base), recorder, _floats(run), limits_of(*limits))
    with jax.enable_x64(True):
        return _numpy(run_one(model_of(system, base), recorder, _floats(run), limits_of(*limits)))


def batch(
    system: System,
    motion: BaseMotion | None = None,
    *,
    t_end: float,
    t_start: float = 0.0,
    theta: float = 0.0,
    omega: float = 0.0,
    initial: tuple[Any, Discrete] | None = None,
    parameters: Any = None,
    motion_parameters: Any = None,
    breakpoints: Any = None,
    max_step: Any = None,
    keep_impacts: int = 0,
    save_at: ArrayLike = (),
    rtol: float = 1e-9,
    atol: float = 1e-12,
    max_events: int = 1_000_000,
) -> Response:
    """Many runs side by side, on the device that JAX has.

    The arguments are those of `response`; any of them in `parameters` (entry by entry), `motion_parameters`,
    `breakpoints`, `max_step` and `initial` may have a leading axis `run`, and at least one must.  Runs go in
    step, all of them on an accelerator and in groups on a CPU; a group takes as many rounds as its longest run.

    Returns:
        Response: NumPy arrays with the leading axis `run`.

    Raises:
        ValueError: an argument is out of range, or the leading axes differ or are not there.
    """
    base = Still() if motion is None else motion
    with jax.enable_x64(True):
        template = _run(system, base, (t_start, t_end), (theta, omega), None, None, None, None, None)
        run = _run(
            system, base, (t_start, t_end), (theta, omega), initial,
            parameters, motion_parameters, breakpoints, max_step,
        )  # fmt: skip
        run = _floats(run)
        many = jax.tree.map(_has_leading_axis, run, _floats(template))
        limits = limits_of(*_checked((t_start, t_end), rtol, atol, save_at, max_events))
        model, recorder = model_of(system, base), _recorder(keep_impacts)
        parts = [
            _numpy(run_many(model, recorder, many, group, limits)) for group in groups(run, many, _length(run, many))
        ]
        joined = jax.tree.map(lambda *of_each: np.concatenate(of_each), *parts)
        return jax.tree.map(lambda values: values[: _length(run, many)], joined)


def sensitivity(f: Callable[[Any], Any], x: Any) -> tuple[Any, Any]:
    """Value and forward derivatives of f at x, in 64 bits.

    Args:
        f: function of a nest (dict, tuple, ...) of floats to a nest of numbers; it calls `response`.
        x: the nest of floats or float arrays at which to take them.

    Returns:
        (value, slope): slope has f's nest, each number replaced by x's nest of derivatives d(number)/d(entry), each of
        the shape of the number followed by that of the entry; None in place of what is no float.
    """

    def parted(x: Any) -> tuple[Any, Any]:
        value = f(x)
        return jax.tree.map(lambda v: v if jnp.issubdtype(jnp.result_type(v), jnp.inexact) else None, value), value

    with jax.enable_x64(True):
        at = jax.tree.map(lambda v: jnp.asarray(v, float), x)
        slope, value = jax.jacfwd(parted, has_aux=True)(at)
        return _numpy(value), _numpy(slope)


def _run(
    system: System,
    motion: BaseMotion,
    span: tuple[float, float],
    released: tuple[float, float],
    initial: Any,
    parameters: Any,
    motion_parameters: Any,
    breakpoints: Any,
    max_step: Any,
) -> Run:
    """The run that the arguments ask for."""
    if not (math.isfinite(span[0]) and math.isfinite(span[1]) and span[1] > span[0]):
        raise ValueError(f"t_end={span[1]!r} s: want a time after t_start={span[0]!r} s")
    check_start(*released)
    if initial is not None and released != (0.0, 0.0):
        raise ValueError("initial: want it without theta and omega, which it already holds")
    y0, q0 = system.initial_state(*released) if initial is None else initial
    if initial is not None:
        _check_state(system, y0)
    return Run(
        par=numbers_of(system.parameters if parameters is None else parameters),
        motion_par=motion.parameters if motion_parameters is None else motion_parameters,
        breakpoints=np.asarray(motion.breakpoints, float) if breakpoints is None else breakpoints,
        span=span,
        max_step=motion.max_step if max_step is None else max_step,
        y0=np.asarray(y0, float) if isinstance(y0, tuple) and initial is None else y0,
        q0=q0,
    )


def _check_state(system: System, y0: Any) -> None:
    """ValueError for a state of another size, or one in which a block has fallen as far as its numbers are known."""
    names = tuple(system.state_names)
    entries = list(y0) if isinstance(y0, tuple | list) else [y0[..., k] for k in range(np.shape(y0)[-1])]
    if len(entries) != len(names):
        raise ValueError(f"initial: {len(entries)} numbers, want {', '.join(names)} of {system.name}")
    theta = entries[names.index("theta")]
    if not isinstance(theta, jax.core.Tracer):
        check_tilt("initial: theta", theta)


def _recorder(keep_impacts: int) -> SummaryRecorder:
    if keep_impacts < 0:
        raise ValueError(f"keep_impacts={keep_impacts!r}: want 0 or more")
    return SummaryRecorder(keep_impacts)


def _checked(
    span: tuple[float, float], rtol: float, atol: float, save_at: ArrayLike, max_events: int
) -> tuple[Any, ...]:
    positive("rtol", rtol, "1")
    positive("atol", atol, "SI units of the state")
    if max_events < 1:
        raise ValueError(f"max_events={max_events!r}: want 1 or more")
    times = np.asarray(save_at, float)
    if times.ndim != 1 or np.any(np.diff(times) < 0.0) or not np.all((times >= span[0]) & (times <= span[1])):
        raise ValueError(f"save_at: want ascending times between t_start={span[0]!r} and t_end={span[1]!r} s")
    return rtol, atol, times, max_events


def _want_64_bits(run: Run) -> None:
    for leaf in jax.tree.leaves(run):
        if isinstance(leaf, jax.Array) and leaf.dtype == jnp.float32:
            raise ValueError(
                "a traced argument has 32 bits: want 64; put the transformation inside `with jax.enable_x64(True):`"
            )


def _floats(run: Run) -> Run:
    """The run as 64-bit arrays."""
    y0 = run.y0
    if isinstance(y0, tuple | list):
        y0 = jnp.stack(jnp.broadcast_arrays(*(jnp.asarray(v, float) for v in y0)), axis=-1)
    q0 = discrete(run.q0)
    return jax.tree.map(lambda v: jnp.asarray(v, float), run._replace(y0=y0))._replace(q0=q0)


def _has_leading_axis(leaf: Any, single: Any) -> bool:
    if leaf.ndim not in (single.ndim, single.ndim + 1):
        raise ValueError(f"shape {leaf.shape}: want {single.shape}, with or without a leading axis `run`")
    return bool(leaf.ndim > single.ndim)


def _length(run: Run, many: Run) -> int:
    leaves = zip(jax.tree.leaves(run), jax.tree.leaves(many), strict=True)
    lengths = sorted({leaf.shape[0] for leaf, own in leaves if own})
    if len(lengths) != 1 or lengths[0] == 0:
        raise ValueError(f"leading axes of lengths {lengths}: want one length, not 0, in one argument at least")
    return lengths[0]


def _numpy(values: Any) -> Any:
    return jax.tree.map(np.asarray, values)
