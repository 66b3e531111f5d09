"""Functions of the virtual laboratory's block whose foot slips: Newton's equations seen from the ground, and SciPy.

What runs of whole tests cannot tell apart: each coefficient of the floor's motion, each stage of a step, and when
friction changes or a corner lands within a step.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from studies.laboratory import slip

from .laboratory_blocks import WORLD
from .laboratory_newton import ODD, cubics, forces

STATES = range(40)


@pytest.mark.parametrize("state", STATES)
def test_a_block_on_an_edge_that_holds_or_slips_obeys_newton_seen_from_the_ground(state: int) -> None:
    """No moment is left over; a foot that slips is dragged by friction, one that holds asks what it is said to ask."""
    rng = np.random.default_rng(state)
    c, x, s = cubics(rng), rng.uniform(0.0, 0.1), float(rng.choice([-1, 1]))
    phi, v, S = rng.uniform(0.0, 0.5), rng.uniform(-2.0, 2.0), rng.uniform(-0.1, 0.1)
    sense = float(rng.choice([-1, 0, 1]))
    V = sense * rng.uniform(0.0, 0.5)
    a, slipping, asked = slip.rate(x, c, s, phi, v, S, V, sense, ODD.vector())
    along, across, moment = forces(ODD, c, x, s, (s * phi, s * v, s * a), (S, V, slipping))
    assert moment == pytest.approx(0.0, abs=1e-8)
    assert along / across == pytest.approx(asked, rel=1e-7, abs=1e-8)
    assert (slipping == 0.0) if sense == 0.0 else asked == pytest.approx(-sense * ODD.friction, rel=1e-14)


@pytest.mark.parametrize("state", STATES)
def test_a_block_on_its_base_obeys_newton_seen_from_the_ground(state: int) -> None:
    """Flat on the floor, on which it slides or not; how round its edges are does not matter."""
    rng = np.random.default_rng(state)
    c, x, sense = cubics(rng), rng.uniform(0.0, 0.1), float(rng.choice([-1, 0, 1]))
    S, V = rng.uniform(-0.1, 0.1), sense * rng.uniform(0.0, 0.5)
    slipping, asked = slip.standing(x, c, S, V, sense, ODD.vector())
    along, across, _ = forces(ODD, c, x, 1.0, (0.0, 0.0, 0.0), (S, V, slipping))
    assert along / across == pytest.approx(asked, rel=1e-7, abs=1e-8)
    assert (slipping == 0.0) if sense == 0.0 else asked == pytest.approx(-sense * ODD.friction, rel=1e-14)


@pytest.mark.parametrize("state", STATES)
def test_a_side_lifts_once_the_moment_about_the_other_exceeds_what_adheres(state: int) -> None:
    """A thousandth more or less adhesion than the moment decides; a base that slides does not adhere."""
    rng = np.random.default_rng(state)
    c, x, S = cubics(rng), rng.uniform(0.0, 0.1), rng.uniform(-0.1, 0.1)
    c[0, 0] += float(rng.choice([-1, 1])) * 14.0  # so that it lifts
    moments = {}
    for s in (1.0, -1.0):
        # What is left over on a block that stands turns it about the edge of that side, if it is away from the other.
        moments[s] = s * forces(ODD, c, x, s, (0.0, 0.0, 0.0), (S, 0.0, 0.0))[2] * ODD.mass
    side = max(moments, key=lambda s: moments[s])
    assert moments[side] > 0.0 > moments[-side]
    for share, lifts in ((0.999, side), (1.001, 0.0)):
        glued = replace(ODD, adhesion=share * moments[side]).vector()
        assert slip.lifting(x, c, S, 0.0, 0.0, glued) == lifts
    rises = [s for s in (1.0, -1.0) if slip.rate(x, c, s, 0.0, 0.0, S, 0.1, 1.0, glued)[0] > 0.0]
    assert slip.lifting(x, c, S, 0.1, 1.0, glued) == (rises[0] if rises else 0.0)


def followed(c, s: float, begin: tuple, sense: float, P, end: float, *events):
    """SciPy's solution of (phi, phi', S, S'), to which a step has to come."""

    def derivative(t, y):
        a, slipping, _ = slip.rate(t, c, s, y[0], y[1], y[2], y[3], sense, P)
        return y[1], a, y[3], slipping

    return solve_ivp(derivative, (0.0, end), begin, method="DOP853", rtol=1e-12, atol=1e-14, events=events)


@pytest.mark.parametrize("sense", [-1.0, 0.0, 1.0])
def test_a_step_on_an_edge_is_of_fourth_order(sense: float) -> None:
    """Half the step leaves a thirty-second of a single step's error, in each of its four numbers."""
    rng, P = np.random.default_rng(5), ODD.vector()
    for _ in range(10):
        c, begin = cubics(rng), (0.3, -0.9, 0.02, 0.4 * sense)
        apart = []
        for h in (0.02, 0.01):
            exact = followed(c, 1.0, begin, sense, P, h).y[:, -1]
            apart.append(np.abs(np.array(slip.step(0.0, h, c, 1.0, *begin, sense, P)) - exact))
        moving = apart[0] > 1e-9
        assert moving[:2].all() and (sense == 0.0 or moving.all())
        # A number whose leading term happens to be small has the next power.
        assert np.median(apart[0][moving] / apart[1][moving]) == pytest.approx(32.0, rel=0.4)
        assert (apart[0][moving] > 10.0 * apart[1][moving]).all()


def test_sliding_on_the_whole_base_is_followed_to_second_order() -> None:
    """Half the step leaves an eighth of its error in the speed, and a sixteenth at the best in the place."""
    rng, P = np.random.default_rng(6), ODD.vector()

    def sliding(t, y, c, sense):
        return y[1], slip.standing(t, c, y[0], y[1], sense, P)[0]

    ratios = []
    for _ in range(20):
        c, sense = cubics(rng), float(rng.choice([-1, 1]))
        S, V = rng.uniform(-0.1, 0.1), sense * rng.uniform(0.2, 0.5)
        apart = []
        for h in (0.01, 0.005):
            exact = solve_ivp(sliding, (0.0, h), (S, V), args=(c, sense), method="DOP853", rtol=1e-12, atol=1e-14)
            apart.append(np.abs(np.array(slip.slid(0.0, h, c, S, V, sense, P)) - exact.y[:, -1]))
        ratios.append(apart[0] / apart[1])
    # Where two terms happen to cancel, the next power shows.
    place, speed = np.median(ratios, axis=0)
    assert 8.0 < place < 16.5 and speed == pytest.approx(8.0, rel=0.1)


@pytest.mark.parametrize("state", range(60))
def test_a_step_on_an_edge_ends_at_the_first_impact_or_change_of_friction(state: int) -> None:
    """As SciPy finds it in the same equations: the corner lands, slip turns round, or sticking asks too much."""
    rng, P, d = np.random.default_rng(state), ODD.vector(), 2e-4
    c, s = np.zeros((5, 4)), float(rng.choice([-1, 1]))
    c[0, :2] = rng.uniform(-4.0, 4.0), rng.uniform(-1.0, 1.0) * 2e4
    v, slips = rng.uniform(-2.0, 2.0), bool(rng.integers(2))
    phi, V = rng.uniform(0.0, 4.0) * 1e-4, (rng.uniform(-1.0, 1.0) * 3e-4 if slips else 0.0)
    asked = slip.rate(0.0, c, s, phi, v, 0.0, 0.0, 0.0, P)[2]
    sense = math.copysign(1.0, V) if slips else (-math.copysign(1.0, asked) if abs(asked) > ODD.friction else 0.0)

    def lands(t, y):
        return y[0]

    def lets_go(t, y):
        if sense != 0.0:
            return y[3] * sense if t > 1e-9 else 1.0
        return ODD.friction - abs(slip.rate(t, c, s, y[0], y[1], y[2], 0.0, 0.0, P)[2])

    for event in (lands, lets_go):
        event.terminal = True  # type: ignore[attr-defined]
        event.direction = -1.0  # type: ignore[attr-defined]
    exact = followed(c, s, (phi, v, 0.0, V), sense, P, d, lands, lets_go)
    used, lean, turning, slid, velocity = slip.rock(0.0, d, c, s, phi, v, 0.0, V, P)
    assert used == pytest.approx(exact.t[-1], rel=1e-6)
    assert turning == pytest.approx(exact.y[1, -1], rel=1e-7)
    assert (lean, slid) == pytest.approx((exact.y[0, -1], exact.y[2, -1]), abs=1e-11)
    landed, stopped = (len(found) > 0 for found in exact.t_events)
    assert (lean == 0.0) == landed
    assert velocity == pytest.approx(0.0 if stopped or sense == 0.0 else exact.y[3, -1], rel=1e-6)


def test_what_a_foot_does_next_is_its_own_sense_or_that_of_what_it_gives_way_to() -> None:
    P = replace(WORLD, friction=0.3).vector()
    asked = ((0.2, 0.0), (0.31, 0.0), (-0.31, 0.0), (0.9, 0.1), (0.9, -0.1))
    assert [slip.sense_of(ratio, V, P) for ratio, V in asked] == [0.0, -1.0, 1.0, 1.0, -1.0]
    ended = ((0.2, 1.0), (-0.2, 1.0), (-0.2, -1.0), (0.2, -1.0), (0.2, 0.0))
    assert [slip.stopped(0.1, end, sense) for end, sense in ended] == [0.2, 0.0, -0.2, 0.0, 0.0]


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_energy_of_an_impact_with_friction_is_that_of_speeds_or_the_work_at_the_edges(side: float) -> None:
    """The greater of both: kinetic energy after less before, and impulses on edges times the mean of their speeds."""
    rng, world = np.random.default_rng(3), replace(WORLD, offset=0.006, friction=0.4)
    half, high, own = world.half_breadth, world.centre_height, world.inertia / world.mass
    by_speeds = 0
    for _ in range(300):
        w, V, e = rng.uniform(0.2, 2.0), rng.uniform(-1.5, 1.5), rng.uniform(0.5, 1.1)
        after, energy = slip.blow(side, w, V, e, world.vector())

        def speeds(turning: float, sliding: float, edge: float) -> np.ndarray:
            """Of the centre along and across the floor, and of turning, about an edge that slides."""
            return np.array([sliding + turning * high, -turning * (world.offset - edge * half), turning])

        first, last = speeds(-side * w, V, side), speeds(-side * e * w, after, -side)
        along, up, turned = last - first
        gained = 0.5 * (np.array([1.0, 1.0, own]) @ (last**2 - first**2))
        # Impulses on both edges bear the vertical one; clockwise moments about the centre turn the block.
        left, right = np.linalg.solve(
            [[1.0, 1.0], [half + world.offset, -(half - world.offset)]], [up, own * turned + high * along]
        )
        old, new = (right, left) if side > 0 else (left, right)
        work = old * half * e * w - new * half * w
        assert energy == pytest.approx(max(gained, work), rel=1e-10, abs=1e-13)
        by_speeds += gained > work
    assert by_speeds > 0
