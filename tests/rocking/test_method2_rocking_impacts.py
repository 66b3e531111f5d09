"""Method 2: the ratio of angular velocities in a rocking impact, with its dependence on friction and restitution."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rocking import Block, Method2, Mode, scalars, solve
from rocking.hybrid import Base, Discrete

G = 9.81


def swing_over(system: Method2, s: float = 1.0, omega: float = 1.0, u: float = 0.0) -> tuple[Any, Discrete]:
    """State after a rocking impact: the block turns about corner s with omega towards the other one."""
    mode = Mode.ROTATION if u == 0.0 else Mode.SLIDE_ROTATION
    y = (0.0, 0.0, 0.0, u, 0.0, -s * omega)
    k = system.guard_names.index("landing")
    return system.jump(scalars, y, Discrete(mode, s, 1.0), Base(0.0, 0.0), system.parameters, k)


RATIOS = [0.1, 0.2, 0.3, 0.5, 0.9, 1.3]


# Housner (1963): 1 - 1.5 sin^2(alpha) when the new corner sticks.
@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("s", [1.0, -1.0])
def test_a_plastic_rocking_impact_that_sticks_has_housners_restitution(ratio: float, s: float) -> None:
    alpha = math.atan(ratio)
    system = Method2(Block(b=ratio, h=1.0), friction=1.3, g=G)
    y, q = swing_over(system, s)
    assert y[5] / -s == pytest.approx(1.0 - 1.5 * math.sin(alpha) ** 2, abs=1e-14)
    assert (q.mode, q.s) == (Mode.ROTATION, -s)
    assert (y[2], y[3], y[4]) == (0.0, 0.0, 0.0)
    # The corner that lands stands a breadth from the old one.
    assert y[0] == pytest.approx(-s * ratio, abs=1e-15)


def ratio_of_a_slipping_impact(block: Block, mu: float) -> float:
    """omega after / before when the new corner slips through a plastic impact, from Newton's impulse law.

    The block turns with -1 about the +x corner; the -x corner lands at v = -b and, slipping or not, stops vertically
    under an impulse (P_x, P_z), |P_x| = mu P_z, against the slip that is to come.
    """
    rho2 = (block.b**2 + block.h**2) / 12.0
    r = np.array([-0.5 * block.b, -0.5 * block.h])
    response = np.array([[1.0 + r[1] ** 2 / rho2, -r[0] * r[1] / rho2], [-r[0] * r[1] / rho2, 1.0 + r[0] ** 2 / rho2]])
    sticking = np.linalg.solve(response, [0.0, block.b])
    if abs(sticking[0]) <= mu * sticking[1]:
        P = sticking
    else:
        direction = np.array([math.copysign(mu, sticking[0]), 1.0])
        P = direction * block.b / (response @ direction)[1]
    return -(-1.0 + (r[1] * P[0] - r[0] * P[1]) / rho2)


# Own derivation: sticking needs mu >= mu_imp = 1.5 sin a cos a/(2 - 1.5 sin^2 a), 0.22 at b/h = 0.3; below it the
# corner slips and loses more; without friction the ratio is (1 - 3 sin^2 a)/(1 + 3 sin^2 a).
@pytest.mark.parametrize("ratio", [0.1, 0.25, 0.3, 0.5])
def test_the_ratio_of_a_rocking_impact_has_its_kink_at_the_friction_that_sticking_needs(ratio: float) -> None:
    alpha = math.atan(ratio)
    sin2 = math.sin(alpha) ** 2
    mu_imp = 1.5 * math.sin(alpha) * math.cos(alpha) / (2.0 - 1.5 * sin2)
    if ratio == 0.3:
        assert mu_imp == pytest.approx(0.22, abs=0.005)
    block = Block(b=ratio, h=1.0)
    housner = 1.0 - 1.5 * sin2

    def found(mu: float) -> float:
        y, _ = swing_over(Method2(block, friction=mu, g=G))
        return -y[5]

    for mu in np.linspace(0.0, 1.3, 40):
        assert found(mu) == pytest.approx(ratio_of_a_slipping_impact(block, mu), abs=1e-13)
    assert found(mu_imp * (1.0 + 1e-9)) == pytest.approx(housner, abs=1e-13)
    assert found(0.99 * mu_imp) < housner - 1e-4 * sin2
    assert found(0.0) == pytest.approx((1.0 - 3.0 * sin2) / (1.0 + 3.0 * sin2), abs=1e-13)
    slope = (found(mu_imp * 0.999) - found(mu_imp * 0.998)) / (0.001 * mu_imp)
    assert slope > 0.01 * ratio


# Housner's ratio is negative beyond b/h = sqrt(2): such a block lands on both corners and stops if e_n = 0.
def test_a_stocky_block_lands_on_both_corners_and_stops() -> None:
    y, q = swing_over(Method2(Block(b=1.6, h=1.0), friction=1.3, g=G))
    assert q.mode == Mode.REST
    np.testing.assert_array_equal(y[2:], 0.0)


# ... and with e_n > 0 it does not leave with Housner's negative ratio but by the law of a flat landing: the centre of
# mass, coming with z' = -b/2 and x' = -h/2, leaves with -e_n z' and (1 - k) x', k = min(1, mu P_n/|x'|), and the spin
# -1 turns into e_n: over the old corner, which stays on the floor.
@pytest.mark.parametrize("mu", [1.3, 0.2])
def test_a_stocky_block_that_bounces_turns_back_over_its_old_corner_with_e_n(mu: float) -> None:
    e_n, b, h = 0.5, 1.6, 1.0
    y, q = swing_over(Method2(Block(b=b, h=h), friction=mu, normal_restitution=e_n, g=G))
    P_n = (1.0 + e_n) * 0.5 * b
    x_dot = -0.5 * h * (1.0 - min(1.0, mu * P_n / (0.5 * h)))
    # The corner at -h/2 under the centre moves with x' + omega r_z.
    assert y[3] == pytest.approx(x_dot - 0.5 * h * e_n, abs=1e-13)
    assert y[5] == pytest.approx(e_n, abs=1e-13)
    assert (q.mode, q.s, y[0], y[4]) == (Mode.SLIDE_ROTATION, 1.0, 0.0, 0.0)


# Own derivation: e = (1 - kap (1 - 2 lam))/(1 + kap (1 - 2 lam)) has every value from Housner's to 1.
@pytest.mark.parametrize("ratio", [0.1, 0.25, 0.3, 0.5, 0.9])
@pytest.mark.parametrize("share", [0.0, 0.3, 0.7, 1.0])
@pytest.mark.parametrize("s", [1.0, -1.0])
def test_the_two_corner_impact_has_exactly_the_restitution_asked_for(ratio: float, share: float, s: float) -> None:
    block = Block(b=ratio, h=1.0)
    housner = 1.0 - 1.5 * math.sin(math.atan(ratio)) ** 2
    e = min(housner + share * (1.0 - housner) + 1e-15, 1.0)
    y, q = swing_over(Method2(block, friction=1.3, impact_law="two_corner", restitution=e, g=G), s)
    assert y[5] / -s == pytest.approx(e, abs=1e-13)
    assert (q.mode, q.s, y[3]) == (Mode.ROTATION, -s, 0.0)


# The two impulses at the two corners are not negative and within the friction cone; momentum about the old corner
# gains b P_new only.  Written out for the impulses that turn omega = -1 about the +x corner into -e about the -x one.
# With less friction than they ask for the corner slips in the impact, against all the friction there is, and the ratio
# is had all the same.
@pytest.mark.parametrize("ratio", [0.1, 0.25, 0.5])
@pytest.mark.parametrize("part", [0.0, 0.5, 1.0])
def test_a_corner_slips_in_the_impact_where_friction_is_less_than_its_impulses_ask_for(
    ratio: float, part: float
) -> None:
    b, h = ratio, 1.0
    housner = 1.0 - 1.5 * math.sin(math.atan(ratio)) ** 2
    e = min(housner + part * (1.0 - housner) + 1e-15, 1.0)
    # Centre of mass before: turns about (b/2, -h/2) with -1: (x', z') = omega (r_z, -r_x) of the centre from there.
    before = -1.0 * np.array([0.5 * h, 0.5 * b])
    after = -e * np.array([0.5 * h, -0.5 * b])
    P_x, P_z = after - before
    spin = (1.0 - e) * (b * b + h * h) / 12.0  # r_z P_x - (r_x of each) P = rho2 (omega+ - omega-)
    P_plus_minus_P_minus = (-0.5 * h * P_x - spin) / (0.5 * b)
    P_plus, P_minus = 0.5 * (P_z + P_plus_minus_P_minus), 0.5 * (P_z - P_plus_minus_P_minus)
    assert P_plus >= -1e-12
    assert P_minus >= P_plus - 1e-12
    needed = abs(P_x) / P_z
    for share in (0.0, 0.3, 0.9, 1.0 - 1e-6, 1.0 + 1e-6):
        mu = share * needed + 1e-12
        y, _ = swing_over(Method2(Block(b=b, h=h), friction=mu, impact_law="two_corner", restitution=e))
        assert y[5] == pytest.approx(-e, abs=1e-12)
        # As long as it slips P_z is the same, and friction mu P_z is all that the centre of mass feels along the floor.
        slip = after[0] - before[0] - math.copysign(min(mu * P_z, abs(P_x)), P_x)
        assert y[3] == pytest.approx(-slip, abs=1e-12)


# Below Housner's the ratio is had too, by a couple besides; where the block would stop it stands on both corners.
@pytest.mark.parametrize("ratio", [0.25, 0.5, 0.9])
@pytest.mark.parametrize("share", [0.75, 0.99])
@pytest.mark.parametrize("s", [1.0, -1.0])
def test_a_restitution_below_housners_is_had_exactly(ratio: float, share: float, s: float) -> None:
    e = share * (1.0 - 1.5 * math.sin(math.atan(ratio)) ** 2)
    y, q = swing_over(Method2(Block(b=ratio, h=1.0), friction=1.3, impact_law="two_corner", restitution=e, g=G), s)
    assert y[5] / -s == pytest.approx(e, abs=1e-13)
    assert (q.mode, q.s, y[3]) == (Mode.ROTATION, -s, 0.0)


def test_with_no_restitution_at_all_a_block_stops_upright() -> None:
    y, q = swing_over(Method2(Block(b=0.9, h=1.0), friction=1.3, impact_law="two_corner", restitution=0.0, g=G))
    assert q.mode == Mode.REST
    np.testing.assert_array_equal(y[2:], 0.0)


@pytest.mark.parametrize("e", [-0.01, 1.01])
def test_two_corner_refuses_a_restitution_that_is_none(e: float) -> None:
    with pytest.raises(ValueError, match=rf"restitution={e}: want 0 to 1"):
        Method2(Block(b=0.2, h=0.8), friction=1.0, impact_law="two_corner", restitution=e)


@pytest.mark.parametrize("ratio_kept", [0.0, 0.3, 1.0])
@given(b=st.floats(0.05, 0.9), part=st.floats(0.0, 1.0), slip=st.floats(-2.0, 2.0), more=st.floats(0.0, 0.6),
       s=st.sampled_from([1.0, -1.0]))  # fmt: skip
def test_the_two_corner_impact_creates_no_energy_even_when_it_slides(
    ratio_kept: float, b: float, part: float, slip: float, more: float, s: float
) -> None:
    housner = 1.0 - 1.5 * math.sin(math.atan(b)) ** 2
    e = min(housner + part * (1.0 - housner) + 1e-15, 1.0)
    mu = min((1.0 - e) / (b * (1.0 + e)) + 1e-12 + more, 1.33)
    law: Any = {"impact_law": "two_corner", "restitution": e, "ratio_kept": ratio_kept}
    system = Method2(Block(b=b, h=1.0), friction=mu, g=G, **law)
    y, q = swing_over(system, s, u=slip)
    rho2 = (b * b + 1.0) / 12.0

    def kinetic(corner: float, u: float, v: float, omega: float) -> float:
        x_dot, z_dot = u + 0.5 * omega, v + omega * corner * 0.5 * b
        return 0.5 * (x_dot**2 + z_dot**2 + rho2 * omega**2)

    before = kinetic(s, slip, 0.0, -s)
    assert kinetic(float(q.s), y[3], y[4], y[5]) <= before * (1.0 + 1e-12)


# Newton and Coulomb: the impulses that lead to the state after the impact, from momenta.  What the law keeps is kept
# where normal forces do no work on the whole; else it is missed on the side of that bound.  Corners only push: a place
# of the impulse beyond the new one is that of a restitution below Housner's, and no further.
@settings(max_examples=300)
@pytest.mark.parametrize("ratio_kept", [0.0, 1.0])
@given(b=st.floats(0.05, 0.9), part=st.floats(-1.0, 1.0), slip=st.floats(-1.0, 1.0), more=st.floats(0.0, 0.6),
       s=st.sampled_from([1.0, -1.0]), omega=st.floats(0.1, 3.0))  # fmt: skip
def test_impulses_of_a_sliding_block_stay_where_they_are_or_keep_the_ratio(
    ratio_kept: float, b: float, part: float, slip: float, more: float, s: float, omega: float
) -> None:
    housner = 1.0 - 1.5 * math.sin(math.atan(b)) ** 2
    e = min(housner + part * (1.0 - housner) + 1e-15, 1.0) if part >= 0.0 else housner * (1.0 + part)
    sticks = (1.0 - e) / (b * (1.0 + e))  # friction with which the corner does not slip in the impact
    mu = min(sticks + 1e-12 + more, 1.33)
    slip *= omega
    law: Any = {"impact_law": "two_corner", "restitution": e, "ratio_kept": ratio_kept}
    y, q = swing_over(Method2(Block(b=b, h=1.0), friction=mu, g=G, **law), s, omega, slip)
    # Else both corners landed at last; of an impact slower than the rest speed the block may trip at once over one.
    assume(q.s == -s and q.mode in (Mode.ROTATION, Mode.SLIDE_ROTATION) and y[5] != 0.0)
    # As seen with the corner that lands to the left: omega and the centre's velocity (0.5 omega + u, -+0.5 b omega).
    before, after, u_before, u_after = omega, -s * y[5], -s * slip, -s * y[3]
    rho2 = (b * b + 1.0) / 12.0
    P_x = u_after - u_before + 0.5 * (after - before)
    P_z = 0.5 * b * (after + before)
    # Moments about the centre: 0.5 (P_new - P_old) b + 0.5 P_x brake the rotation, by rho2 (before - after).
    difference = 2.0 / b * (rho2 * (before - after) - 0.5 * P_x)
    P_old, P_new, small = 0.5 * (P_z - difference), 0.5 * (P_z + difference), 1e-9 * (omega + after)
    assert abs(P_x) <= mu * P_z + small
    if abs(u_after) > small:
        assert P_x == pytest.approx(-math.copysign(mu * P_z, u_after), abs=small)
    work = P_old * after - P_new * before  # of normal forces, but for b/2: the old corner comes up, the new one down
    # Own derivation: share of the old corner where the base does not slide, from moments with P_x of e there.
    its_P_z = 0.5 * b * (1.0 + e)
    its_P_x = min(0.5 * (1.0 - e), mu * its_P_z)
    share = 0.5 - (rho2 * (1.0 - e) + 0.5 * its_P_x) / (b * its_P_z)
    assert share == pytest.approx(0.5 - sticks / (6.0 * b / (b * b + 4.0)), abs=1e-9) or sticks > mu
    assert work <= small * omega
    beyond = after - e * before if ratio_kept else P_old - share * P_z
    if not ratio_kept:
        assert P_old >= min(share, 0.0) * P_z - small
    if not ratio_kept and P_old <= min(share, 0.0) * P_z + small:
        assert beyond >= -small
    elif work >= -small * omega:
        assert beyond <= small
    else:
        assert beyond == pytest.approx(0.0, abs=small)


# With Housner's restitution the old corner takes nothing, however the base slides: the law of one corner.
@given(b=st.floats(0.05, 0.9), slip=st.floats(-1.0, 1.0), mu=st.floats(0.7, 1.33), s=st.sampled_from([1.0, -1.0]))
def test_with_housners_restitution_a_shared_impact_is_that_of_one_corner(
    b: float, slip: float, mu: float, s: float
) -> None:
    block = Block(b=b, h=1.0)
    alone = Method2(block, friction=mu, g=G)
    shared = Method2(block, friction=mu, g=G, impact_law="two_corner", restitution=block.housner_restitution)
    (y, q), (expected, its) = swing_over(shared, s, u=slip), swing_over(alone, s, u=slip)
    assert (q.mode, q.s) == (its.mode, its.s)
    assert y == pytest.approx(expected, abs=1e-12)


# The smallest slip changes nothing: the limit of the law is that of the corner that sticks.
@pytest.mark.parametrize("e", [0.72, 0.77508, 0.9, 1.0])
@pytest.mark.parametrize("slip", [1e-9, -1e-9])
@pytest.mark.parametrize("ratio_kept", [0.0, 0.4, 1.0])
def test_speeds_after_a_rocking_impact_are_continuous_in_the_slip_before(
    e: float, slip: float, ratio_kept: float
) -> None:
    law: Any = {"impact_law": "two_corner", "restitution": e, "ratio_kept": ratio_kept}
    system = Method2(Block(b=0.42, h=1.0), friction=0.43, g=G, **law)
    (still, _), (sliding, _) = swing_over(system), swing_over(system, u=slip)
    assert sliding[3:] == pytest.approx(still[3:], abs=1e-8)


# Between the two laws the loss is linear, where neither is at a bound.
@pytest.mark.parametrize("slip", [0.05, -0.05])
def test_half_a_ratio_kept_is_half_way_between(slip: float) -> None:
    law: Any = {"impact_law": "two_corner", "restitution": 0.9, "g": G}
    place, half, ratio = (
        swing_over(Method2(Block(b=0.42, h=1.0), friction=0.43, ratio_kept=k, **law), u=slip)[0][5]
        for k in (0.0, 0.5, 1.0)
    )
    assert ratio == pytest.approx(-0.9, abs=1e-14)
    assert abs(place - ratio) > 0.05
    assert half == pytest.approx(0.5 * (place + ratio), abs=1e-14)


# Own simulation for b/h = 0.25 on a rough floor, printed to three digits: the swing after the impact against that
# before, as a ratio of angular velocities, never grows with e_n.  With e_n = 0 it is Housner's 1 - 1.5 sin^2(alpha),
# here 0.911765; the peak is read off samples 4.5e-5 s apart, which costs omega^2 of 1e-6.
# The ratio of a swing is taken from its height: omega^2 goes with cos(alpha - theta_max) - cos(alpha).
@pytest.mark.parametrize(
    ("e_n", "expected", "digits"),
    [(0.0, 1.0 - 1.5 / 17.0, 1e-6), (0.2, 0.910, 5.1e-4), (0.5, 0.899, 5.1e-4), (0.8, 0.848, 5.1e-4)],
)
def test_bouncing_corners_do_not_raise_the_ratio_of_swings(
    slender: Block, e_n: float, expected: float, digits: float
) -> None:
    alpha, theta_0 = math.atan(0.25), 0.5 * math.atan(0.25)
    system = Method2(slender, friction=1.2, normal_restitution=e_n, g=G)
    run = solve(system, theta=theta_0, t_end=0.9, save_at=np.linspace(0.0, 0.9, 20001))
    turned = np.flatnonzero((run.theta[:-1] < 0.0) & (run.omega[:-1] < 0.0) & (run.omega[1:] >= 0.0))
    theta_1 = abs(run.theta[turned[0]])
    ratio = math.sqrt((math.cos(alpha - theta_1) - math.cos(alpha)) / (math.cos(alpha - theta_0) - math.cos(alpha)))
    assert ratio == pytest.approx(expected, abs=digits)
