"""What must hold for every block and motion: similitude, mirror images, energy at impacts, spans of time, batches.

Newton's law has these symmetries whatever the contact does, so no formula of the package is needed to state them.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from excitation import RampedSinusoid, SteadySinusoid
from rocking import Block, Method1, Method2, Mode, Outcome, solve, solve_batch
from rocking.hybrid import Discrete

G = 9.81
SHARP = {"rtol": 1e-12, "atol": 1e-15}

# Until the block has been carried 4/p from the start, a difference of a rounding grows by exp(4) = 55 while it leans,
# and a few times at each of a handful of impacts: 1e-12 stays below 1e-8.
SPAN = 4.0
CLOSE = 1e-8
EVENTS = 30

EXAMPLES = settings(max_examples=40, deadline=None)


@dataclass(frozen=True)
class Case:
    """A block, how it is released, and a sine under it; all of it without dimensions but the size."""

    kind: str  # linear, nonlinear, method2
    height: float  # h [m]
    slenderness: float  # b/h [1]
    restitution: float  # of Method 1 [1], normal one of Method 2 half of it
    friction: float  # of Method 2 [1]
    tilt: float  # theta at release over alpha [1]
    ratio: float  # frequency of the base over p [1]
    strength: float  # amplitude of the base over (b/h) g [1]
    phase: float  # [rad]

    @property
    def block(self) -> Block:
        return Block(self.slenderness * self.height, self.height)

    def system(self, g: float = G, size: float = 1.0) -> Any:
        block = Block(size * self.block.b, size * self.block.h)
        if self.kind != "method2":
            return Method1(block, form=self.kind, restitution=self.restitution, g=g)
        # The one duration among the parameters scales like every other.
        chatter = 1e-5 * math.sqrt(size * G / g)
        return Method2(
            block, self.friction, normal_restitution=0.5 * self.restitution, g=g, chatter_time=chatter
        )  # fmt: skip

    def motion(self, g: float = G, size: float = 1.0, side: float = 1.0) -> SteadySinusoid:
        p = self.block.p(G) * math.sqrt(g / (G * size))
        amplitude = side * self.strength * self.slenderness * g
        return SteadySinusoid(self.ratio * p / (2.0 * math.pi), amplitude, 3.0 * SPAN / p, self.phase)

    @property
    def theta(self) -> float:
        return self.tilt * self.block.alpha


def decided(case: Case) -> bool:
    """Whether the block does not stand on a knife's edge: a tie is broken by rounding, and by nothing else.

    A base whose amplitude is just that of tipping or slipping may do it or not; with friction of just b/h both begin
    at the same moment.
    """
    push = case.strength * case.slenderness
    ties = [(push, case.slenderness), (push, case.friction), (case.friction, case.slenderness)]
    return all(abs(one / other - 1.0) > 1e-3 for one, other in ties)


def cases(kind: str) -> Any:
    # A tilt below 1e-3 is released and lands within rounding of the first step; it says nothing.
    tilts = st.floats(0.001, 0.9).flatmap(lambda x: st.sampled_from([x, -x])) | st.just(0.0)
    return st.builds(
        Case, st.just(kind), st.floats(0.2, 5.0), st.floats(0.1, 0.6), st.floats(0.5, 1.0), st.floats(0.2, 1.2), tilts,
        st.floats(0.5, 8.0), st.floats(0.3, 3.0), st.floats(-3.0, 3.0),
    ).filter(decided)  # fmt: skip


KINDS = pytest.mark.parametrize("kind", ["linear", "nonlinear", "method2"])


def certain(times: np.ndarray, span: float) -> int:
    """How many of the events are certain in their order and their time."""
    close = np.flatnonzero(np.diff(times[: EVENTS + 1]) < 1e-6 * span)
    return int(close[0]) if close.size else min(times.size, EVENTS)


def same_history(one: Any, other: Any, stretch: float) -> None:
    """The same rotation at times that are `stretch` times as late, and the same events, as far as both are certain.

    That is up to EVENTS events, and not beyond two that follow one another at once: which of two guards falls first is
    then a matter of rounding.
    """
    n = certain(one.events.t[: min(len(one.events), len(other.events))], one.t_end)
    until = one.events.t[n] if n < len(one.events) else one.t_end
    np.testing.assert_array_equal(one.events.guard[:n], other.events.guard[:n])
    np.testing.assert_array_equal(one.events.mode_after[:n], other.events.mode_after[:n])
    np.testing.assert_allclose(other.events.t[:n] / stretch, one.events.t[:n], rtol=0.0, atol=CLOSE * one.t_end)
    sure = min(np.count_nonzero(one.t < until * (1.0 - 1e-6)), other.t.size)
    np.testing.assert_allclose(other.theta[:sure], one.theta[:sure], rtol=0.0, atol=CLOSE)


@KINDS
@EXAMPLES
@given(data=st.data())
def test_a_block_of_another_size_moves_alike_in_another_time(kind: str, data: Any) -> None:
    # Lengths times L, times times sqrt(L), accelerations as they are: Froude's similitude.
    case, size = data.draw(cases(kind)), data.draw(st.floats(0.05, 50.0))
    scaled_runs(case, size, G, math.sqrt(size))


@KINDS
@EXAMPLES
@given(data=st.data())
def test_under_another_gravity_a_block_moves_alike_in_another_time(kind: str, data: Any) -> None:
    # Gravity and the base's acceleration times c, times over sqrt(c).
    case, c = data.draw(cases(kind)), data.draw(st.floats(0.05, 20.0))
    scaled_runs(case, 1.0, c * G, 1.0 / math.sqrt(c))


def scaled_runs(case: Case, size: float, g: float, stretch: float) -> None:
    end = SPAN / case.block.p(G)
    times = np.linspace(0.0, end, 101)
    one = solve(case.system(), case.motion(), theta=case.theta, t_end=end, save_at=times, **SHARP)
    other = solve(
        case.system(g, size), case.motion(g, size), theta=case.theta, t_end=end * stretch,
        save_at=np.minimum(times * stretch, end * stretch), **SHARP,
    )  # fmt: skip
    same_history(one, other, stretch)


# The closed forms of the solver `exact` under the base motion that it knows.
@EXAMPLES
@given(case=cases("linear"), size=st.floats(0.05, 50.0))
def test_similitude_holds_for_the_exact_solver(case: Case, size: float) -> None:
    end, runs = SPAN / case.block.p(G), []
    times = np.linspace(0.0, end, 101)
    for L in (1.0, size):
        sine = case.motion(size=L)
        ramp = RampedSinusoid(sine.frequency, sine.duration, 5.0 * abs(sine.amplitude), phase=case.phase)
        at = np.minimum(times * math.sqrt(L), end * math.sqrt(L))
        system = case.system(size=L)
        runs.append(solve(system, ramp, theta=case.theta, t_end=end * math.sqrt(L), save_at=at, solver="exact"))
    same_history(*runs, math.sqrt(size))


@KINDS
@EXAMPLES
@given(data=st.data())
def test_the_mirror_image_of_a_motion_gives_the_mirror_image_to_the_last_bit(kind: str, data: Any) -> None:
    case = data.draw(cases(kind))
    end = 2.0 * SPAN / case.block.p(G)
    one = solve(case.system(), case.motion(), theta=case.theta, t_end=end)
    other = solve(case.system(), case.motion(side=-1.0), theta=-case.theta, t_end=end)
    np.testing.assert_array_equal(one.events.t, other.events.t)
    np.testing.assert_array_equal(one.events.guard, other.events.guard)
    np.testing.assert_array_equal(one.theta, -other.theta)
    assert one.side == -other.side


def energy(system: Any, y: np.ndarray, s: float) -> float:
    """Energy per mass [J/kg] from a state: of the mass centre, of the rotation, of the height."""
    block, alpha = system.block, system.block.alpha
    state = dict(zip(system.state_names, y, strict=True))
    theta, omega = state["theta"], state["omega"]
    # From the mass centre to the carrying corner.
    r_x, r_z = s * block.R * math.sin(alpha - s * theta), -block.R * math.cos(alpha - s * theta)
    u, v = state.get("u", 0.0) - omega * r_z, state.get("v", 0.0) + omega * r_x
    spin = 0.5 * block.I_c / block.mass * omega**2
    return 0.5 * (u * u + v * v) + spin + system.g * (state.get("z", 0.0) - r_z)


@pytest.mark.parametrize("kind", ["nonlinear", "method2"])
@EXAMPLES
@given(data=st.data())
def test_on_a_base_at_rest_no_event_adds_energy_and_none_is_found_between_them(kind: str, data: Any) -> None:
    case = data.draw(cases(kind))
    assume(case.theta != 0.0)
    system = case.system()
    run = solve(system, theta=case.theta, t_end=3.0 * SPAN / case.block.p(G), rtol=1e-11, atol=1e-14)
    _, q = system.initial_state(case.theta)
    sides = np.concatenate([[q.s], run.events.s_after])
    before = np.array([energy(system, y, s) for y, s in zip(run.events.y_before, sides[:-1], strict=True)])
    after = np.array([energy(system, y, s) for y, s in zip(run.events.y_after, sides[1:], strict=True)])
    # 1e-8 of the energy at hand: the tolerance of the steps, over some hundred of them.
    scale = system.g * case.block.R
    assert np.all(after <= before + 1e-8 * scale)
    assert np.all(np.diff(np.concatenate([[energy(system, run.y[0], q.s)], before])) < 1e-8 * scale)


@KINDS
@EXAMPLES
@given(data=st.data())
def test_a_run_in_two_parts_is_the_run_in_one(kind: str, data: Any) -> None:
    case, share = data.draw(cases(kind)), data.draw(st.floats(0.05, 0.95))
    system, motion = case.system(), case.motion()
    end = SPAN / case.block.p(G)
    middle = share * end
    whole = solve(system, motion, theta=case.theta, t_end=end, save_at=[middle], **SHARP)
    assume(whole.t.size == 1)  # it has not fallen by then
    # A state within rounding of an event belongs before or after it; that is no state to go on from.
    assume(not np.any(np.abs(whole.events.t - middle) < 1e-6 * end))
    slip = -1.0 if "u" in system.state_names and whole.y[0, system.state_names.index("u")] < 0.0 else 1.0
    state = tuple(whole.y[0].tolist()), Discrete(int(whole.mode[0]), float(whole.s[0]), slip)
    second = solve(system, motion, initial=state, t_start=middle, t_end=end, **SHARP)
    later = whole.events.t > middle
    n = certain(whole.events.t[later][: len(second.events)], end)
    np.testing.assert_array_equal(second.events.guard[:n], whole.events.guard[later][:n])
    np.testing.assert_array_equal(second.events.mode_after[:n], whole.events.mode_after[later][:n])
    np.testing.assert_allclose(second.events.t[:n], whole.events.t[later][:n], rtol=0.0, atol=CLOSE * end)
    if n == len(second.events):
        assert n == np.count_nonzero(later)
        assert second.outcome is whole.outcome
        assert second.t_end == pytest.approx(whole.t_end, abs=CLOSE * end)


@KINDS
@settings(max_examples=10, deadline=None)
@given(data=st.data())
def test_a_batch_is_its_single_runs_bit_for_bit(kind: str, data: Any) -> None:
    some = data.draw(st.lists(cases(kind), min_size=1, max_size=6))
    systems, motions = [case.system() for case in some], [case.motion() for case in some]
    tilts = np.array([case.theta for case in some])
    batch = solve_batch(systems, motions, theta=tilts, t_end=3.0)
    for i, (system, motion) in enumerate(zip(systems, motions, strict=True)):
        one = solve(system, motion, theta=float(tilts[i]), t_end=3.0, save_at=())
        assert batch.overturned[i] == one.overturned
        assert batch.side[i] == one.side
        assert batch.impacts[i] == len(one.impact_times)
        for name in ("peak_rotation", "overturning_time", "onset_time", "t_end"):
            np.testing.assert_array_equal(getattr(batch, name)[i], getattr(one, name))


@KINDS
@EXAMPLES
@given(data=st.data())
def test_a_base_that_is_too_weak_leaves_the_block_where_it_stands(kind: str, data: Any) -> None:
    case = data.draw(cases(kind))
    limit = min(1.0, case.friction / case.slenderness) if kind == "method2" else 1.0
    weak = replace(case, tilt=0.0, strength=0.999 * limit * min(1.0, case.strength))
    run = solve(weak.system(), weak.motion(), t_end=SPAN / case.block.p(G))
    assert run.outcome is Outcome.AT_REST
    assert len(run.events) == 0
    assert np.all(run.mode == Mode.REST)
