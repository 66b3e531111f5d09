"""A floor whose springs are spread under the base: sink, lean, small oscillations, and many separate springs."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eig

from rocking import Block, Method1, Mode, solve
from rocking.effects import compose, parse
from rocking.soft_floor import bed

G = 9.80665
SMALL = Block(b=0.15, h=0.50, d=0.25)  # Block 3 of Winkler, Meguro & Yamazaki (1995), Table 1


def effects(k: float, xi: float, spread: float, *more: str) -> Any:
    name = "compliant_base"
    return parse([f"{name}.corner_stiffness={k!r}", f"{name}.damping_ratio={xi!r}", f"{name}.spread={spread!r}", *more])


def pressures(y: Any, k: float, spread: float, elements: int = 200_000) -> tuple[float, float]:
    """Weight carried [N] and its moment [N m] about the centre of mass, by the midpoint rule and two corners."""
    xi = SMALL.b * ((np.arange(elements) + 0.5) / elements - 0.5)
    xi = np.concatenate([xi, [-0.5 * SMALL.b, 0.5 * SMALL.b]])
    share = np.concatenate([np.full(elements, 2.0 * spread * k / elements), np.full(2, (1.0 - spread) * k)])
    x = xi * math.cos(y[2]) - 0.25 * math.sin(y[2])
    depth = -(y[1] - xi * math.sin(y[2]) - 0.25 * math.cos(y[2]))
    force = share * np.maximum(depth, 0.0)
    return float(force.sum()), float(-(x * force).sum())


@pytest.mark.parametrize("spread", [0.3, 1.0])
def test_a_bed_sinks_as_two_corners_do_and_stands_still(spread: float) -> None:
    run = solve(Method1(SMALL), effects=effects(5e5, 0.1, spread), t_end=1.0, rtol=1e-11, atol=1e-16)
    assert np.all(run.mode == Mode.REST) and np.max(np.ptp(run.y, axis=0)) < 1e-11
    assert 0.25 - run.y[0, 1] == pytest.approx(SMALL.mass * G / (2.0 * 5e5), rel=1e-10)


@pytest.mark.parametrize("spread", [0.3, 1.0])
def test_a_block_off_its_middle_leans_until_the_moments_are_even(spread: float) -> None:
    k = 5e5
    system = compose(Method1(SMALL), effects(k, 0.1, spread, "eccentric_mass.offset=0.004"))
    theta = system.initial_state()[0][2]
    # g (o + H tan) = 2 k a^2 (1 - 2 w / 3) sin / m, by the moments of a line of springs about the middle.
    stiff = 2.0 * k * 0.075**2 * (1.0 - 2.0 * spread / 3.0) / SMALL.mass
    assert stiff * math.sin(theta) == pytest.approx(G * (0.004 + 0.25 * math.tan(theta)), rel=1e-10)


# A weight outside of the middle third of a bed lifts the other side off: pressures grow from nothing to the corner.
@pytest.mark.parametrize("offset", [0.03, -0.03, 0.05, -0.05])
@pytest.mark.parametrize("spread", [0.5, 1.0])
def test_a_block_far_off_its_middle_stands_still_on_a_part_of_the_bed(offset: float, spread: float) -> None:
    k = 1e6
    given = effects(k, 0.1, spread, f"eccentric_mass.offset={offset!r}")
    run = solve(Method1(SMALL), effects=given, t_end=0.5, rtol=1e-11, atol=1e-16)
    assert np.max(np.ptp(run.y, axis=0)) < 1e-9
    theta = run.y[0, 2]
    assert math.copysign(1.0, theta) == math.copysign(1.0, offset)
    assert run.mode[0] == (Mode.REST if SMALL.b * math.sin(abs(theta)) < SMALL.mass * G / k else Mode.ROTATION)
    if spread == 1.0 and run.mode[0] == Mode.ROTATION:
        # A triangle of pressures: its resultant, a third of its length from the corner, is under the centre of mass.
        length = 3.0 * (0.075 - (abs(offset) + 0.25 * math.tan(abs(theta))))
        assert 2.0 * k / 0.15 * 0.5 * length**2 * math.sin(abs(theta)) == pytest.approx(SMALL.mass * G, rel=1e-9)


def test_a_broad_block_a_little_off_its_middle_third_stands_on_nearly_all_of_the_bed() -> None:
    """Of a base of 4 m the side that is lifted off is short: a triangle of pressures, nearly as long as the base."""
    broad, k, offset = Block(b=4.0, h=4.0, d=1.0, density=1000.0), 4e7, 0.68
    system = compose(Method1(broad), effects(k, 0.1, 1.0, f"eccentric_mass.offset={offset!r}"))
    theta = system.initial_state()[0][2]
    length = 3.0 * (2.0 - (offset + 2.0 * math.tan(theta)))
    assert 3.8 < length < 4.0
    assert 2.0 * k / 4.0 * 0.5 * length**2 * math.sin(theta) == pytest.approx(16_000.0 * G, rel=1e-9)


def test_a_bed_that_is_not_touched_carries_nothing() -> None:
    system = compose(Method1(SMALL), effects(1e6, 0.1, 1.0))
    for theta in (0.0, 1e-160, -1e-160, 1e-8, -0.2):
        height = 0.075 * math.sin(abs(theta)) + 0.25 * math.cos(theta) + 1e-4
        assert bed(np, (0.0, height, theta, 0.0, 0.0, 0.0), system.parameters) == (0.0, 0.0)


@pytest.mark.parametrize("theta", [2e-5, -2e-5, 1e-3, -1e-3, 0.1])
@pytest.mark.parametrize("spread", [0.3, 1.0])
def test_a_leaning_block_is_let_go_with_its_whole_weight_on_the_floor(theta: float, spread: float) -> None:
    y, q = compose(Method1(SMALL), effects(1e6, 0.1, spread)).initial_state(theta)
    assert pressures(y, 1e6, spread)[0] == pytest.approx(SMALL.mass * G, rel=1e-4)
    assert q.mode == (Mode.REST if SMALL.b * math.sin(abs(theta)) < SMALL.mass * G / 1e6 else Mode.ROTATION)


# A Winkler bed turns against k_v b^3 / 12 for each unit of length, a third of what its springs do at the corners.
def test_small_oscillations_have_the_frequencies_of_the_linear_body_on_a_bed() -> None:
    k, m = 5e5, SMALL.mass
    system = compose(Method1(SMALL), effects(k, 0.0, 1.0))
    r_z, sink = -0.25, m * G / (2.0 * k)
    K = np.diag([2.0 * k, 2.0 * k, 2.0 * k / 0.15 * 0.15**3 / 12.0 + 2.0 * k * r_z**2 + 2.0 * k * sink * r_z])
    K[0, 2] = K[2, 0] = 2.0 * k * r_z
    values, modes = eig(K, np.diag([m, m, SMALL.I_c]))
    y0, q0 = system.initial_state()
    for omega, mode in zip(np.sqrt(values.real), modes.T.real, strict=True):
        size = 1e-7 / np.max(np.abs(mode * np.array([1.0, 1.0, 0.25])))
        y = np.array(y0)
        y[:3] += size * mode
        period = 2.0 * math.pi / omega
        run = solve(
            system, initial=(tuple(y), q0), t_end=period, rtol=1e-12, atol=1e-18, save_at=[0.5 * period, period]
        )
        moved = (run.y[:, :3] - np.array(y0)[:3]) / size
        np.testing.assert_allclose(moved[0], -mode, atol=2e-4 * np.max(np.abs(mode)))
        np.testing.assert_allclose(moved[1], mode, atol=2e-4 * np.max(np.abs(mode)))


def separate_springs(k: float, xi: float, spread: float, theta: float, t: np.ndarray, elements: int) -> np.ndarray:
    """Rotation of the block on separate springs and dashpots, the feet held sideways where they touched."""
    m, c = SMALL.mass, 2.0 * xi * math.sqrt(k * SMALL.mass)
    along = SMALL.b * ((np.arange(elements) + 0.5) / elements - 0.5)
    along = np.concatenate([along, [-0.075, 0.075]])
    share = np.concatenate([np.full(elements, 2.0 * spread / elements), np.full(2, 1.0 - spread)])
    feet = np.array([-0.075, 0.075]) * math.cos(theta)
    touched = {0: -math.inf, 1: -math.inf}

    def forces(y: np.ndarray, feet: np.ndarray) -> tuple[float, float, float]:
        sin, cos = math.sin(y[2]), math.cos(y[2])
        r_x, r_z = along * cos - 0.25 * sin, -along * sin - 0.25 * cos
        depth, speed = -(y[1] + r_z), y[4] - y[5] * r_x
        N = np.where(depth > 0.0, share * np.maximum(k * depth - c * speed, 0.0), 0.0)
        x, u = y[0] + r_x[-2:], y[3] + y[5] * r_z[-2:]
        F = np.where(depth[-2:] > 0.0, -k * (x - feet) - c * u, 0.0)
        return float(F.sum()), float(N.sum()), float((r_z[-2:] * F).sum() - (r_x * N).sum())

    def rate(_: float, y: np.ndarray) -> list[float]:
        F, N, M = forces(y, feet)
        return [y[3], y[4], y[5], F / m, N / m - G, M / SMALL.I_c]

    def height(side: int) -> Any:
        def of(_: float, y: np.ndarray) -> float:
            return float(y[1] - (2 * side - 1) * 0.075 * math.sin(y[2]) - 0.25 * math.cos(y[2]))

        of.terminal, of.direction = True, -1.0  # type: ignore[attr-defined]
        return of

    y = np.array([*compose(Method1(SMALL), effects(k, xi, spread)).initial_state(theta)[0][:3], 0.0, 0.0, 0.0])
    now, out = 0.0, []
    while now < t[-1]:
        part = solve_ivp(
            rate, (now, t[-1]), y, events=[height(0), height(1)], dense_output=True, rtol=1e-8, atol=1e-11,
            max_step=1e-3,
        )  # fmt: skip
        inside = t[(t >= now) & (t <= part.t[-1])]
        out += [] if inside.size == 0 else list(part.sol(inside)[2])
        y, now = part.y[:, -1], part.t[-1]
        for side in (0, 1):
            if part.t_events[side].size and part.t_events[side][-1] > touched[side] + 1e-9:
                feet[side] = y[0] + (2 * side - 1) * 0.075 * math.cos(y[2]) - 0.25 * math.sin(y[2])
                touched[side] = part.t_events[side][-1]
        # Clear of the event, or it would be found again without end.
        y = solve_ivp(rate, (now, now + 1e-7), y, rtol=1e-10, atol=1e-13).y[:, -1]
        now += 1e-7
    return np.array(out)[: t.size]


@pytest.mark.parametrize("spread", [0.5, 1.0])
def test_the_history_is_that_of_many_separate_springs(spread: float) -> None:
    t = np.linspace(0.0, 0.55, 551)
    run = solve(Method1(SMALL), effects=effects(1e6, 0.2, spread), theta=0.06, t_end=0.55, save_at=t)
    assert run.theta.min() < -0.01
    apart = [
        float(np.abs(run.theta - separate_springs(1e6, 0.2, spread, 0.06, t, elements)).max()) for elements in (40, 400)
    ]
    assert apart[1] < 2e-5
    assert apart[1] < 0.3 * apart[0]


def test_the_mirror_image_swings_as_the_mirror_image() -> None:
    one, other = (solve(Method1(SMALL), effects=effects(1e6, 0.1, 1.0), theta=v, t_end=0.6) for v in (0.1, -0.1))
    np.testing.assert_allclose(one.theta, -other.theta, atol=1e-9)


def test_a_bed_on_which_the_block_cannot_stand_is_refused() -> None:
    least = 3.0 * SMALL.mass * G * 0.25 / (2.0 * 0.075**2)
    with pytest.raises(ValueError, match=f"want more than .* = {least:.6g} N/m"):
        solve(Method1(SMALL), effects=effects(0.999 * least, 0.1, 1.0), t_end=0.1)
    pushed = solve(Method1(SMALL), effects=effects(1.05 * least, 0.05, 1.0), omega=1e-5, t_end=3.0)
    assert not pushed.overturned and pushed.peak_rotation < 1e-3
