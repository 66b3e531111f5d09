"""The loop of the compiled Runge-Kutta solver, by its Python source: systems whose ways are known in closed form.

theta'' = -theta, which turns back at walls: where it is, when it meets them and what it is at most are sines.
"""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import pytest
from numba.core.dispatcher import Dispatcher

from rocking.hybrid import INADMISSIBLE, Discrete
from rocking.solvers.numba import kernel, runge_kutta
from rocking.solvers.recording import (
    FELL,
    INADMISSIBLE_STATE,
    MAX_STALLED,
    NOT_FINITE,
    REACHED_END,
    STALL_TIME,
    STALLED,
    STEP_TOO_SMALL,
    TOO_MANY_EVENTS,
)
from rocking.trajectory import BALANCE


@pytest.fixture(autouse=True)
def interpreted(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Every function by its Python source."""
    for module in (kernel, runge_kutta):
        for name, thing in list(vars(module).items()):
            if isinstance(thing, Dispatcher):
                monkeypatch.setattr(module, name, thing.py_func)
    with np.errstate(all="ignore"):
        yield


class Par(NamedTuple):
    """What a system takes."""

    pull: float
    wall: float


def flow(y: Any, q: Any, base: Any, par: Any) -> Any:
    return y[1], -par.pull * y[0] + base.a_x


def guards(y: Any, q: Any, base: Any, par: Any) -> Any:
    """It falls at -9; it turns back at a wall to the left."""
    return y[0] + 9.0, y[0] + par.wall


def jump(y: Any, q: Any, base: Any, par: Any, kg: Any) -> Any:
    return (y[0], -0.5 * y[1]), q._replace(s=-q.s)


def balance(y: Any, par: Any) -> float:
    return y[0] - 0.6


def still(t: float, par: Any) -> tuple[float, float, float, float]:
    return 0.0, 0.0, 0.0, 0.0


START = Discrete(2, 1.0, 1.0)


def run(
    y0: Any = (1.0, 0.0), t_end: float = 3.0, save_at: Any = (), motion: Any = still, most: int = 99, **changed: Any
) -> Any:
    """How it ended, when, in which mode, after how many steps, the largest |theta|, samples and events."""
    how: dict[str, Any] = {
        "flow": flow, "guards": guards, "jump": jump, "balance": balance, "q0": START, "like": Par(1.0, 0.5),
        "edges": np.array([0.0, t_end]), "max_step": math.inf, "n_guards": 2, "tolerances": np.array([1e-11, 1e-13]),
    }  # fmt: skip
    how |= changed
    like = how.pop("like")
    return kernel.integrate(
        motion=motion, y0=np.array(y0), like=like, numbers=np.array(like), values=np.zeros((0, 0)), mpar=np.zeros(1),
        save_at=np.array(save_at, dtype=float), max_events=most, watched=(0, 1), **how,
    )  # fmt: skip


# cos t until it is -1/2 at 2 pi/3; then -1/2 cos + (sqrt(3)/4) sin of the time since.
def test_samples_events_and_peak_are_those_of_sines() -> None:
    save_at = np.array([0.0, 0.3, 1.2, 2.0, 2.5, 3.0])
    status, t, mode, steps, peak, (y, modes, s), (times, codes, sides, states) = run(save_at=save_at)
    bounce, c = 2.0 * math.pi / 3.0, math.sqrt(3.0) / 4.0
    tau = save_at - bounce
    theta = np.where(tau < 0.0, np.cos(save_at), -0.5 * np.cos(tau) + c * np.sin(tau))
    omega = np.where(tau < 0.0, -np.sin(save_at), 0.5 * np.sin(tau) + c * np.cos(tau))
    np.testing.assert_allclose(y, np.stack([theta, omega], axis=1), atol=1e-9)
    assert (status, t, mode) == (REACHED_END, 3.0, 2) and steps > 10 and peak == 1.0
    assert modes.tolist() == [2] * 6 and s.tolist() == [1.0] * 4 + [-1.0] * 2
    np.testing.assert_allclose(times, [bounce], rtol=1e-12)
    assert codes.tolist() == [[1, 2, 2]] and sides.tolist() == [-1.0]
    np.testing.assert_allclose(states[0], [[-0.5, -math.sqrt(0.75)], [-0.5, math.sqrt(3.0) / 4.0]], atol=1e-9)


# From -0.4 outward through 0.6 at asin(0.6/A) - asin(-0.4/A), A^2 = 0.4^2 + 1, to the largest tilt A.
def test_a_passage_outward_is_found_and_one_inward_is_none() -> None:
    amplitude = math.hypot(0.4, 1.0)
    *_, peak, _, (times, codes, _, states) = run((-0.4, 1.0), t_end=3.2)
    assert codes[:, 0].tolist() == [BALANCE]
    np.testing.assert_allclose(times, [math.asin(0.6 / amplitude) + math.asin(0.4 / amplitude)], rtol=1e-8)
    np.testing.assert_allclose(states[0], [[0.6, math.sqrt(amplitude**2 - 0.36)]] * 2, rtol=1e-8)
    assert peak == pytest.approx(amplitude, rel=1e-8)


def test_a_fall_ends_the_run_where_it_is() -> None:
    status, t, *_, (times, codes, _, states) = run((0.0, -10.0), like=Par(1.0, 99.0))
    assert (status, t) == (FELL, pytest.approx(math.asin(0.9), rel=1e-10)) and codes.tolist() == [[0, 2, 2]]
    assert times[-1] == t and states[0, 0] == pytest.approx(states[0, 1])


# At the wall already and going further: it is met at once, at no time; on it and leaving, not.
@pytest.mark.parametrize(("omega", "events"), [(-0.2, 1), (0.2, 0)])
def test_a_start_at_a_wall_meets_it_only_if_it_goes_there(omega: float, events: int) -> None:
    *_, (times, _, _, states) = run((-0.5, omega), t_end=1.0, like=Par(1e-9, 0.5))
    assert len(times) == events
    if events:
        assert times[0] == pytest.approx(0.0, abs=1e-9) and states[0, 1, 1] == pytest.approx(0.1, rel=1e-6)


# What stands at its threshold all the time has not passed it.
def test_a_guard_that_stays_at_zero_is_never_met() -> None:
    status, t, *_, (times, *_) = run(guards=lambda y, q, base, par: (1.0, 0.0))
    assert (status, t, len(times)) == (REACHED_END, 3.0, 0)


# Two guards within one step: the earlier one, whichever stands first.
@pytest.mark.parametrize("order", [(0.3, 0.5), (0.5, 0.3)])
def test_of_two_events_the_earlier_comes_first(order: tuple[float, float]) -> None:
    def two(y: Any, q: Any, base: Any, par: Any) -> Any:
        # Once it is carried on the other side nothing is met.
        far = 99.0 if q.s < 0.0 else 0.0
        return y[0] + 9.0, y[0] - 1.0 + order[0] + far, y[0] - 1.0 + order[1] + far

    *_, (times, codes, _, _) = run(guards=two, n_guards=3, t_end=1.4, tolerances=np.array([1e-3, 1e-3]))
    assert codes[:, 0].tolist()[0] == 1 + order.index(0.3)
    np.testing.assert_allclose(times[0], math.acos(0.7), rtol=1e-3)


# Two impacts at one time after many steps are no stall; more of them in a row than may be are.
def test_events_in_a_row_without_time_are_counted_as_such() -> None:
    def twice(y: Any, q: Any, base: Any, par: Any, kg: Any) -> Any:
        # The first leaves it beyond the wall, the second puts it back.
        return ((-0.6, 0.0) if q.s > 0.0 else (0.4, 0.0)), q._replace(s=-q.s)

    status, _, _, steps, _, _, (times, *_) = run(jump=twice, max_step=0.01, t_end=3.0)
    assert status == REACHED_END and steps > 2 * MAX_STALLED and len(times) == 2 and times[1] - times[0] < STALL_TIME

    def stays(y: Any, q: Any, base: Any, par: Any, kg: Any) -> Any:
        return (-0.6, 0.0), q

    status, t, *_, (times, *_) = run(jump=stays, t_end=3.0, most=10**6)
    assert (status, len(times)) == (STALLED, MAX_STALLED + 2) and t == pytest.approx(2.0 * math.pi / 3.0)


def test_too_many_events_and_modes_that_cannot_be_end_the_run() -> None:
    def lossless(y: Any, q: Any, base: Any, par: Any, kg: Any) -> Any:
        return (y[0], -y[1]), q

    status, t, *_, (times, *_) = run(jump=lossless, t_end=99.0, most=4, balance=lambda y, par: -1.0)
    # From the wall to it again takes 4 pi/3.
    np.testing.assert_allclose(times, (2.0 + 4.0 * np.arange(5)) * math.pi / 3.0, rtol=1e-9)
    assert (status, t) == (TOO_MANY_EVENTS, times[-1])

    def nowhere(y: Any, q: Any, base: Any, par: Any, kg: Any) -> Any:
        return (y[0], y[1]), q._replace(mode=INADMISSIBLE)

    status, t, mode, *_ = run(jump=nowhere)
    assert (status, t, mode) == (INADMISSIBLE_STATE, pytest.approx(2.0 * math.pi / 3.0), INADMISSIBLE)


# More events than a table has room for at first.
def test_a_table_of_events_grows() -> None:
    def always(y: Any, q: Any, base: Any, par: Any) -> Any:
        return 1.0, y[0]

    def back(y: Any, q: Any, base: Any, par: Any, kg: Any) -> Any:
        return (0.1, 0.0), q

    def falls(y: Any, q: Any, base: Any, par: Any) -> Any:
        return -1.0, 0.0

    status, *_, (times, codes, _, states) = run(
        (0.1, 0.0), flow=falls, guards=always, jump=back, t_end=15.05, most=10**4, max_step=0.05
    )
    assert status == REACHED_END and len(times) == 150
    np.testing.assert_allclose(times, 0.1 * np.arange(1, 151), rtol=1e-9)
    np.testing.assert_allclose(states[:, 1, 0], 0.1)
    assert codes.tolist() == [[1, 2, 2]] * 150


# A base that jumps between two edges pushes from the one to the other and no longer: theta' = a t.
def test_a_stretch_sees_the_base_from_within() -> None:
    def pushed(t: float, par: Any) -> tuple[float, float, float, float]:
        return (2.0 if 1.0 <= t <= 2.0 else 0.0), 0.0, 0.0, 0.0

    _, t, *_, (y, _, _), _ = run(
        (0.0, 0.0), motion=pushed, like=Par(0.0, 99.0), edges=np.array([0.0, 1.0, 2.0, 3.0]), save_at=[1.0, 1.5, 3.0]
    )
    assert t == 3.0
    np.testing.assert_allclose(y, [[0.0, 0.0], [0.25, 1.0], [3.0, 2.0]], atol=1e-8)


def test_what_is_not_finite_is_said_to_be() -> None:
    def infinite(t: float, par: Any) -> tuple[float, float, float, float]:
        return (math.inf if t > 0.5 else 0.0), 0.0, 0.0, 0.0

    assert run(motion=infinite, edges=np.array([0.0, 0.5, 1.0]))[0] == NOT_FINITE
    assert run((math.nan, 0.0))[0] == NOT_FINITE

    # It is thrown to and fro at where it begins: no step is short enough.
    def to_and_fro(y: Any, q: Any, base: Any, par: Any) -> Any:
        return (-1e9 if y[0] > 1.0 else 1e9), 0.0

    status, t, *_ = run(flow=to_and_fro, balance=lambda y, par: -1.0)
    assert (status, t) == (STEP_TOO_SMALL, 0.0)
