"""The block on two springs and dashpots: energy, sink, small oscillations, the rigid limit, and distinct elements."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import simpson, solve_ivp
from scipy.linalg import eig

import dem
from excitation import SampledMotion
from rocking import Block, Method1, Mode, solve
from rocking.effects import compose, parse
from rocking.hybrid import Discrete
from rocking.instruments import accelerometer

G = 9.80665
PAPER = Block(b=0.30, h=1.00, d=0.50)  # Block 1 of Winkler, Meguro & Yamazaki (1995), Table 1
SMALL = Block(b=0.15, h=0.50, d=0.25)  # Block 3


def on_springs(block: Block, k: float, xi: float, *more: str, **options: Any) -> Any:
    texts = [f"compliant_base.corner_stiffness={k!r}", f"compliant_base.damping_ratio={xi!r}", *more]
    return solve(Method1(block), options.pop("motion", None), effects=parse(texts), **options)


def foot_of(run: Any, side: float, o: float = 0.0, states: Any = None) -> tuple[np.ndarray, ...]:
    """(x, height, u, v) of a foot by the geometry of a turned rectangle."""
    x, z, theta, u, v, omega = (run.y if states is None else states).T[:6]
    a, H = 0.5 * run.system.block.b, 0.5 * run.system.block.h
    along, up = side * a - o, -H
    r_x, r_z = along * np.cos(theta) + up * np.sin(theta), -along * np.sin(theta) + up * np.cos(theta)
    return x + r_x, z + r_z, u + omega * r_z, v - omega * r_x


@pytest.mark.parametrize("offset", [0.0, 0.02, -0.04])
@pytest.mark.parametrize("k", [5e5, 1.98e7])
def test_a_standing_block_sinks_by_the_share_of_each_foot_and_stands_still(k: float, offset: float) -> None:
    run = on_springs(SMALL, k, 0.1, f"eccentric_mass.offset={offset}", t_end=1.0, rtol=1e-11, atol=1e-16)
    assert len(run.events) == 0
    assert np.all(run.mode == Mode.REST)
    assert np.max(np.ptp(run.y, axis=0)) < 1e-11
    right, left = (-k * foot_of(run, side, offset)[1][0] for side in (1.0, -1.0))
    assert right + left == pytest.approx(SMALL.mass * G, rel=1e-11)
    # Moments about the centre of mass, with the arms as they are after the sink.
    arms = [foot_of(run, side, offset)[0][0] - run.y[0, 0] for side in (1.0, -1.0)]
    assert right * arms[0] + left * arms[1] == pytest.approx(0.0, abs=1e-9 * SMALL.mass * G * SMALL.b)


BOTH = ("compliant_base.corner_stiffness=1e6", "bouncing.contact_frequency=60")
"""A soft floor and a hard contact."""


def with_curve(soft: str, value: float, **options: Any) -> Any:
    """A run with a torque of that much [rad/s^2] on the side to which the block leans."""
    damped = {"compliant_base": "compliant_base.damping_ratio=0.3", "bouncing": "bouncing.normal_restitution=0.3"}
    texts = [soft, damped[soft.partition(".")[0]], "learned_curve.odd_intervals=1",
             f"learned_curve.odd_0={value}", f"learned_curve.odd_1={value}"]  # fmt: skip
    return solve(Method1(SMALL), options.pop("motion", None), effects=parse(texts), **options)


# What is alike on both sides leaves a symmetric block upright, wherever it comes from, and mirrors what mirrors it.
@pytest.mark.parametrize("value", [-0.5, 0.5])
@pytest.mark.parametrize("soft", BOTH)
def test_a_torque_alike_on_both_sides_leans_an_upright_block_to_neither(soft: str, value: float) -> None:
    upright = with_curve(soft, value, t_end=1.0)
    assert not upright.theta.any()
    noise = np.convolve(np.random.default_rng(5).normal(size=60), np.hanning(7) / 3.5, "same")
    # As long as few impacts have made rounding grow.
    pair = [
        with_curve(soft, value, motion=SampledMotion(0.02, 6.0 * side * noise), t_end=0.9, rtol=1e-11, atol=1e-14)
        for side in (1.0, -1.0)
    ]
    assert pair[0].peak_rotation > 0.1 * SMALL.alpha
    np.testing.assert_allclose(pair[0].theta, -pair[1].theta, rtol=0.0, atol=1e-7 * SMALL.alpha)


# Small tilts about the middle of the base, springs 2 k a^2 theta and the torque I f 2 a k theta/(m g), I f where
# a foot leaves the floor: theta (2 k a^2 - m g H - 2 a k I f/(m g)) = -m a_x H, with H over the sunken base.
@pytest.mark.parametrize("value", [-4.0, 2.0])
@pytest.mark.parametrize("push", [0.2, -0.2])
def test_between_its_feet_a_torque_of_the_side_grows_with_the_tilt(value: float, push: float) -> None:
    motion = SampledMotion(0.1, np.full(51, push))
    run = with_curve(BOTH[0], value, motion=motion, t_end=4.0)
    assert np.all(run.mode == Mode.REST)
    k, a, m = 1e6, 0.5 * SMALL.b, SMALL.mass
    H, inertia = 0.5 * SMALL.h - m * G / (2.0 * k), SMALL.I_c + m * (a**2 + (0.5 * SMALL.h) ** 2)
    held = 2.0 * k * a**2 - m * G * H - 2.0 * a * k * inertia * value / (m * G)
    assert run.theta[-1] == pytest.approx(-m * push * H / held, rel=2e-3)


# Springs and dashpots of both corners hold the block as an oscillator of w^2 = 2 k/m and the damping sqrt(2) xi: over a
# base that begins to rise with A its centre rises with A (1 - e^(-zeta w t) (cos w_d t - zeta w/w_d sin w_d t)).
@pytest.mark.parametrize("A", [2.0, -3.0])
@pytest.mark.parametrize("xi", [0.1, 0.4])
def test_an_accelerometer_on_a_block_that_is_shaken_up_and_down_reads_an_oscillator(xi: float, A: float) -> None:
    k, t = 5e5, np.linspace(0.0, 0.1, 101)
    motion = SampledMotion(0.05, np.zeros(3), np.full(3, A))
    run = on_springs(SMALL, k, xi, motion=motion, t_end=0.1, save_at=t, rtol=1e-11, atol=1e-14)
    w, zeta = math.sqrt(2.0 * k / SMALL.mass), math.sqrt(2.0) * xi
    w_d = w * math.sqrt(1.0 - zeta**2)
    behind = np.exp(-zeta * w * t) * (np.cos(w_d * t) - zeta * w / w_d * np.sin(w_d * t))
    top = (0.0, SMALL.h)
    np.testing.assert_allclose(accelerometer(run, top, (0.0, 1.0)), G + A * (1.0 - behind), rtol=0.0, atol=1e-7)
    np.testing.assert_allclose(accelerometer(run, top, (1.0, 0.0)), 0.0, atol=1e-12)


@pytest.mark.parametrize("theta", [2e-5, -2e-5, 1e-3, -1e-3, 0.1])
def test_a_leaning_block_is_let_go_with_its_whole_weight_on_what_touches(theta: float) -> None:
    system = compose(Method1(SMALL), parse(["compliant_base.corner_stiffness=1e6"]))
    y, q = system.initial_state(theta)
    # A foot under the other by b sin(theta): both touch while that is less than the sink of one.
    sink, step = SMALL.mass * G / 1e6, SMALL.b * math.sin(abs(theta))
    assert q.mode == (Mode.REST if step < sink else Mode.ROTATION)
    assert q.s == math.copysign(1.0, theta)
    x, z = y[:2]
    corners = [(side * 0.075, -0.25) for side in (1.0, -1.0)]
    heights = [z - X * math.sin(theta) + Z * math.cos(theta) for X, Z in corners]
    pressed = [max(-height, 0.0) * 1e6 for height in heights]
    assert sum(pressed) == pytest.approx(SMALL.mass * G, rel=1e-9)
    places = [x + X * math.cos(theta) + Z * math.sin(theta) for X, Z in corners]
    carrying = 0 if theta > 0.0 else 1
    assert y[6 + carrying] == pytest.approx(places[carrying], abs=1e-15)
    assert places[carrying] == pytest.approx((1 - 2 * carrying) * 0.075 * math.cos(theta), abs=1e-15)


# Kinetic + potential + springs + what the dashpots have taken (+ what a spring still held when its foot lifted).
@pytest.mark.parametrize(("xi", "ratio"), [(0.0, 1.0), (0.02, 1.0), (0.1, 1.0), (0.3, 1.0), (0.0, 5.0), (0.1, 5.0)])
def test_energy_and_what_the_dashpots_take_add_up(xi: float, ratio: float) -> None:
    k = 1e6
    t = np.linspace(0.0, 0.45, 90001)
    stiff = f"compliant_base.tangential_ratio={ratio!r}"
    run = on_springs(SMALL, k, xi, stiff, theta=0.1, t_end=0.45, save_at=t, rtol=1e-12, atol=1e-15)
    m, c = SMALL.mass, 2.0 * xi * math.sqrt(k * SMALL.mass)
    k_t, c_t = ratio * k, 2.0 * xi * math.sqrt(ratio * k * SMALL.mass)
    _, z, _, u, v, omega = run.y.T[:6]
    total = 0.5 * m * (u**2 + v**2) + 0.5 * SMALL.I_c * omega**2 + m * G * z
    power, held = np.zeros_like(total), np.zeros_like(total)
    lost = 0.0
    for side, name, lands in ((1.0, "right_lifts", "contact"), (-1.0, "left_lifts", "landing")):
        x, height, foot_u, foot_v = foot_of(run, side)
        slip = x - run.y[:, 6 if side > 0.0 else 7]
        on = (run.mode == Mode.REST) | ((run.mode == Mode.ROTATION) & (run.s == side))
        held += np.where(on, 0.5 * (k * height**2 + k_t * slip**2), 0.0)
        # A dashpot that would pull gives N = 0: what it then takes is what the spring gives.
        normal = np.maximum(-k * height - c * foot_v, 0.0)
        power += np.where(on, -(normal + k * height) * foot_v + c_t * foot_u**2, 0.0)
        lifts = run.events.y_before[run.events.guard == run.system.guard_names.index(name)]
        slip_then = foot_of(run, side, states=lifts)[0] - lifts[:, 6 if side > 0.0 else 7]
        lost += float(np.sum(0.5 * k_t * slip_then**2))
        assert len(run.times_of(lands)) > 0 or side > 0.0
    # The dashpots act by leaps at each landing: a quadrature between neighbouring events.
    taken, edges = 0.0, [0.0, *run.events.t, 0.45]
    for start, stop in pairwise(edges):
        i = np.flatnonzero((run.t > start) & (run.t < stop))
        if i.size > 2:
            taken += simpson(power[i], x=run.t[i])
            taken += power[i[0]] * (run.t[i[0]] - start) + power[i[-1]] * (stop - run.t[i[-1]])
    before = (total + held)[0]
    after = (total + held)[-1]
    swing = m * G * (z[0] - run.y[:, 1].min())
    if xi > 0.0:
        assert taken > 0.01 * swing
    # Without dashpots to the tolerance of the run; else to the quadrature, which meets a kink where N falls to zero.
    assert after + taken + lost == pytest.approx(before, abs=(1e-9 if xi == 0.0 else 2e-6) * swing)


def test_without_dashpots_nothing_is_lost_before_a_foot_lifts() -> None:
    k = 1e6
    run = on_springs(SMALL, k, 0.0, theta=0.1, t_end=0.2, rtol=1e-12, atol=1e-15)
    _, z, _, u, v, omega = run.y.T[:6]
    x, height, _, _ = foot_of(run, 1.0)
    first = run.t < (run.events.t[0] if len(run.events) else math.inf)
    m = SMALL.mass
    total = (
        0.5 * m * (u**2 + v**2)
        + 0.5 * SMALL.I_c * omega**2
        + m * G * z
        + 0.5 * k * (height**2 + (x - run.y[:, 6]) ** 2)
    )
    assert np.count_nonzero(first) > 300
    assert np.ptp(total[first]) < 1e-10 * m * G * SMALL.h


# Stiffness and mass of a body on two springs, linear: K = sum J^T J k with J of each foot, less the fall of the weight.
@pytest.mark.parametrize("ratio", [1.0, 0.3, 8.0])
def test_small_oscillations_have_the_frequencies_of_the_linear_body_on_two_springs(ratio: float) -> None:
    k, m = 5e5, SMALL.mass
    texts = ["corner_stiffness=5e5", "damping_ratio=0", f"tangential_ratio={ratio!r}"]
    system = compose(Method1(SMALL), parse([f"compliant_base.{text}" for text in texts]))
    sink = m * G / (2.0 * k)
    K = np.zeros((3, 3))
    for side in (1.0, -1.0):
        r_x, r_z = side * 0.075, -0.25
        J = np.array([[1.0, 0.0, r_z], [0.0, 1.0, -r_x]])
        K += J.T @ np.diag([ratio * k, k]) @ J
    # A foot pressed by N turns with the block: its height's second derivative is -r_z, its moment N r_z theta.
    K[2, 2] += 2.0 * k * sink * -0.25
    values, modes = eig(K, np.diag([m, m, SMALL.I_c]))
    frequencies = np.sqrt(values.real)
    y0, q0 = system.initial_state()
    for omega, mode in zip(frequencies, modes.T.real, strict=True):
        # Started along one mode the block swings in it: back after a period, with a sign change half-way.
        size = 1e-7 / np.max(np.abs(mode * np.array([1.0, 1.0, 0.25])))
        y = np.array(y0)
        y[:3] += size * mode
        period = 2.0 * math.pi / omega
        run = solve(
            system, initial=(tuple(y), q0), t_end=period, rtol=1e-12, atol=1e-18,
            save_at=[0.25 * period, 0.5 * period, period],
        )  # fmt: skip
        assert len(run.events) == 0
        moved = (run.y[:, :3] - np.array(y0)[:3]) / size
        largest = np.max(np.abs(mode))
        np.testing.assert_allclose(moved[1], -mode, atol=2e-4 * largest)
        np.testing.assert_allclose(moved[2], mode, atol=2e-4 * largest)
        np.testing.assert_allclose(moved[0], 0.0, atol=2e-4 * largest)


def swing_ratio(theta: np.ndarray, alpha: float) -> float:
    """e of the first impact by the swings before and after it: sqrt(E2/E1), E = cos(alpha - peak) - cos(alpha)."""
    at = np.flatnonzero(theta[1:] * theta[:-1] < 0.0)[:2] + 1
    peaks = [np.abs(part).max() for part in np.split(theta, at)[:2]]
    before, after = (math.cos(alpha - peak) - math.cos(alpha) for peak in peaks)
    return math.sqrt(after / before)


# An independent trial of springs and dashpots under Block 1 let go at 0.12 rad, k = 1.98e7 N/m, feet that slip where
# friction (mu = 1, of the spring's force) gives way: 0.963, 0.950, 0.904, 0.879, 0.8751.  Feet that never slip
# differ by up to 0.003 where damping is light.
@pytest.mark.parametrize(
    ("xi", "published", "apart"),
    [(0.0, 0.963, 0.0035), (0.02, 0.950, 0.003), (0.1, 0.904, 0.001), (0.3, 0.879, 0.0005), (1.0, 0.8751, 0.0001)],
)
def test_restitution_falls_with_damping_as_tabulated(xi: float, published: float, apart: float) -> None:
    t = np.linspace(0.0, 1.3, 13001)
    run = on_springs(PAPER, 1.98e7, xi, theta=0.12, t_end=1.3, save_at=t)
    assert swing_ratio(run.theta, PAPER.alpha) == pytest.approx(published, abs=apart)


# The same contacts as those of the distinct element with friction without limit that asks the spring alone whether the
# corner touches: another integrator, another language of contact.
@pytest.mark.parametrize("xi", [0.02, 0.1, 1.0])
def test_the_history_is_that_of_the_distinct_element_with_the_same_contacts(xi: float) -> None:
    history = dem.simulate(
        dem.single_block(0.30, 1.00, 0.50, PAPER.density), t_end=0.9, dt=5e-6, mu=math.inf, damping_ratio=xi,
        theta0=0.12, coulomb="spring", save_every=20,
    )  # fmt: skip
    t = history.time[history.time <= 0.9]
    run = on_springs(PAPER, 1.98e7, xi, theta=0.12, t_end=0.9, save_at=t)
    assert len(run.impact_times) >= 2
    # Steps of 5e-6 s of the distinct element, first order at a landing: within 2e-5 of a swing of 0.12 rad.
    np.testing.assert_allclose(run.theta, history.theta[: t.size], rtol=0.0, atol=2e-5)


# Without dashpots, since those of the distinct element are alike both ways: the first three contacts, after which what
# bounces undamped magnifies every difference.
@pytest.mark.parametrize("ratio", [4.0, 0.25])
def test_other_stiffness_along_the_floor_is_that_of_the_distinct_element(ratio: float) -> None:
    history = dem.simulate(
        dem.single_block(0.30, 1.00, 0.50, PAPER.density), t_end=0.5, dt=1e-6, mu=math.inf, damping_ratio=0.0,
        theta0=0.12, coulomb="spring", save_every=100, ks=ratio * 1.98e7,
    )  # fmt: skip
    t = history.time[history.time <= 0.5]
    stiff = f"compliant_base.tangential_ratio={ratio!r}"
    run = on_springs(PAPER, 1.98e7, 0.0, stiff, theta=0.12, t_end=0.5, save_at=t, rtol=1e-11, atol=1e-14)
    assert len(run.impact_times) >= 3
    np.testing.assert_allclose(run.theta, history.theta[: t.size], rtol=0.0, atol=2e-5)
    even = on_springs(PAPER, 1.98e7, 0.0, theta=0.12, t_end=0.5, save_at=t)
    assert np.abs(run.theta - even.theta).max() > 1e-3


def method_1(block: Block, theta0: float, e: float, impacts: int) -> list[float]:
    """Impact times of Method 1, integrated apart from rocking."""
    p2, alpha = 0.75 * G / block.R, block.alpha

    def flat(t: float, y: Any) -> float:
        return float(y[0])

    flat.terminal, flat.direction = True, -1.0  # type: ignore[attr-defined]
    t, phi, rate, times = 0.0, theta0, 0.0, []
    for _ in range(impacts):
        flow = solve_ivp(
            lambda t, y: (y[1], -p2 * math.sin(alpha - y[0])), (t, t + 5.0), (phi, rate), events=flat,
            rtol=1e-11, atol=1e-13,
        )  # fmt: skip
        t, rate = float(flow.t_events[0][0]), -e * float(flow.y_events[0][0][1])
        times.append(t)
        phi = 1e-15
    return times


def test_stiff_and_damped_springs_tend_to_method_1() -> None:
    truth = method_1(SMALL, 0.1, SMALL.housner_restitution, 3)
    errors = []
    for k in (1e6, 1e7, 1e8, 1e9):
        run = on_springs(SMALL, k, 2.0, theta=0.1, t_end=1.2)
        theta = run.theta
        at = np.flatnonzero(theta[1:] * theta[:-1] < 0.0)
        crossings = run.t[at] + theta[at] / (theta[at] - theta[at + 1]) * (run.t[1] - run.t[0])
        errors.append(np.max(np.abs(crossings[:3] - truth)))
    assert errors[0] > errors[1] > errors[2] > errors[3]
    # A foot sinks by m g/k and is pressed for sqrt(m/k): with the root of stiffness at the least.
    assert errors[3] < 2e-3 * truth[2]
    assert errors[0] / errors[3] > 10.0


@pytest.mark.parametrize(
    ("texts", "message"),
    [
        (("rounded_edges.radius=0.01",), "compliant_base: it does not go together with rounded_edges"),
        (("base_adhesion.moment=1",), "compliant_base: it does not go together with base_adhesion"),
        (("velocity_dependent_restitution.slope=0.1",), "compliant_base: .* with velocity_dependent_restitution"),
    ],
)
def test_what_the_equations_do_not_have_is_refused(texts: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        on_springs(SMALL, 1e6, 0.1, *texts, t_end=0.1)


def test_a_floor_on_which_the_block_cannot_stand_is_refused() -> None:
    # Turned by theta the springs give 2 k a^2 theta against the weight's m g H theta.
    least = SMALL.mass * G * 0.25 / (2.0 * 0.075**2)
    with pytest.raises(ValueError, match=f"want more than .* = {least:.6g} N/m"):
        on_springs(SMALL, 0.999 * least, 0.1, t_end=0.1)
    pushed = on_springs(SMALL, 1.05 * least, 0.05, omega=1e-5, t_end=3.0)
    assert not pushed.overturned
    assert pushed.peak_rotation < 1e-3


@pytest.mark.parametrize("theta", [0.1, -0.1])
def test_the_mirror_image_swings_as_the_mirror_image(theta: float) -> None:
    one, other = (on_springs(SMALL, 1e6, 0.1, theta=value, t_end=0.6) for value in (theta, -theta))
    np.testing.assert_allclose(one.theta, -other.theta, atol=1e-9)
    assert len(one.impact_times) == len(other.impact_times) > 0


# Of the rigid block: the centre of mass, o to the right of the middle and h/2 high, over the corner that carries.
@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("offset", [0.0, 0.02])
def test_a_block_that_is_pushed_over_passes_its_balance_on_that_side(side: float, offset: float) -> None:
    push: dict[str, Any] = {"theta": 0.2 * side, "omega": 2.0 * side, "t_end": 2.0}
    more = (f"eccentric_mass.offset={offset}",) if offset else ()
    fallen = on_springs(SMALL, 1e6, 0.1, *more, **push)
    assert (fallen.overturned, fallen.side) == (True, side)
    there = on_springs(SMALL, 1e6, 0.1, *more, save_at=[fallen.overturning_time], **push)
    balance = math.atan((0.075 - side * offset) / 0.25)
    assert there.theta[0] == pytest.approx(side * balance, abs=1e-6)


@pytest.mark.parametrize("xi", [0.0, 0.8, 1.0, 5.0])
def test_no_damping_makes_the_contacts_switch_without_end(xi: float) -> None:
    run = on_springs(SMALL, 1.98e7, xi, theta=0.12, t_end=1.2)
    assert run.outcome.value != "failed"
    assert run.statistics["steps"] < 30_000
    # Every lift is followed by a landing of the same foot, and the other way round.
    for lands, lifts in (("contact", "right_lifts"), ("landing", "left_lifts")):
        assert abs(len(run.times_of(lands)) - len(run.times_of(lifts))) <= 1


def test_a_state_beside_a_rotation_keeps_what_its_lower_corner_does() -> None:
    run = on_springs(SMALL, 1e6, 0.05, theta=0.1, t_end=0.6, save_at=np.linspace(0.0, 0.6, 601))
    system = run.system
    for k in np.flatnonzero(np.abs(run.theta) > 5e-3)[::7]:
        state = tuple(map(float, run.y[k]))
        q = Discrete(int(run.mode[k]), float(run.s[k]), 1.0)
        y, same = system.initial_state(state[2], state[5], beside=(state, q))
        np.testing.assert_allclose(y[:6], state[:6], rtol=0.0, atol=1e-13)
        assert (same.mode, same.s) == (q.mode, q.s) or q.mode == Mode.ROTATION_JUMP
        side = math.copysign(1.0, state[2])
        y, _ = system.initial_state(state[2] + 1e-3 * side, state[5] - 0.2, beside=(state, q))
        assert y[2] == state[2] + 1e-3 * side and y[5] == state[5] - 0.2
        moved, was = (foot_of(run, side, states=np.array([row])) for row in (y, state))
        np.testing.assert_allclose(np.ravel(moved), np.ravel(was), rtol=0.0, atol=1e-13)
        # Its spring along the floor is as long as it was; what leans to the other side says nothing.
        carrying = 6 if side > 0.0 else 7
        if np.ravel(was)[1] < 0.0 and (q.mode == Mode.REST or q.s == side):
            assert y[carrying] == state[carrying]
        other = system.initial_state(-state[2], 0.1, beside=(state, q))
        assert other == system.initial_state(-state[2], 0.1)
