"""Sliding and bouncing are Method 2 with their numbers: the same runs, bit for bit; and bounces by hand."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from excitation import RampedSinusoid
from rocking import Block, Method1, Method2, Mode, solve
from rocking.effects import compose, parse

BLOCK = Block(b=0.3, h=0.8)
MOTION = RampedSinusoid(3.0, 3.0, 12.0)


def same(texts: list[str], method: Method1, other: Method2, **options: Any) -> Any:
    run = solve(method, MOTION, t_end=2.5, effects=parse(texts), **options)
    truth = solve(other, MOTION, t_end=2.5, **options)
    np.testing.assert_array_equal(run.y, truth.y)
    np.testing.assert_array_equal(run.events.t, truth.events.t)
    np.testing.assert_array_equal(run.mode, truth.mode)
    return run


@pytest.mark.parametrize("solver", ["scipy", "numba"])
@pytest.mark.parametrize("friction", [0.15, 0.35, 1.0])
def test_sliding_is_method_2_with_that_friction(solver: str, friction: float) -> None:
    run = same([f"sliding.friction={friction}"], Method1(BLOCK), Method2(BLOCK, friction=friction), solver=solver)
    if friction == 0.15:
        assert Mode.SLIDE in run.mode


def test_bouncing_is_method_2_with_that_normal_restitution() -> None:
    other = Method2(BLOCK, friction=0.6, normal_restitution=0.4)
    texts = ["bouncing.normal_restitution=0.4", "bouncing.friction=0.6"]
    run = same(texts, Method1(BLOCK), other, theta=0.2)
    assert Mode.ROTATION_JUMP in run.events.mode_after


def bounced(speed: float, e_n: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Times and rotations at the impacts of a corner that each of them stops along the floor, from upright on.

    By hand: an impulse that leaves the corner e_n of its approach and no slip, and free flight to the next one.
    """
    a, H, rho2, g = 0.5 * BLOCK.b, 0.5 * BLOCK.h, (BLOCK.b**2 + BLOCK.h**2) / 12.0, 9.80665
    # On the right corner, towards the left one.
    x, z, turned, u, v, w, t = 0.0, H, 0.0, -speed * H, -speed * a, -speed, 0.0
    times, rotations = [], []
    for _ in range(count):
        r_x, r_z = -a * math.cos(turned) - H * math.sin(turned), a * math.sin(turned) - H * math.cos(turned)
        arriving = np.array([u + w * r_z, v - w * r_x])
        by = np.array([[1.0 + r_z**2 / rho2, -r_x * r_z / rho2], [-r_x * r_z / rho2, 1.0 + r_x**2 / rho2]])
        P = np.linalg.solve(by, np.array([0.0, -e_n * arriving[1]]) - arriving)
        u, v, w = u + P[0], v + P[1], w + (r_z * P[0] - r_x * P[1]) / rho2
        times.append(t)
        rotations.append(turned)

        def height(s: float, at: tuple[float, ...] = (z, turned, v, w)) -> float:
            angle = at[1] + at[3] * s
            return at[0] + at[2] * s - 0.5 * g * s * s + a * math.sin(angle) - H * math.cos(angle)

        up, s = 1e-7, 1e-4
        while height(s) > 0.0:
            up, s = s, 1.3 * s
        s = brentq(height, up, s, xtol=1e-16)
        x, z, turned, v, t = x + u * s, z + v * s - 0.5 * g * s * s, turned + w * s, v - g * s, t + s
    return np.array(times), np.array(rotations)


def test_a_corner_that_impacts_stop_bounces_as_by_hand() -> None:
    """A dozen bounces of 0.6, each to another speed of rotation; with a slip left at each the block turns slower."""
    # So little before upright that its speed is that of the impact but for gravity over that time.
    effects = parse(["bouncing.normal_restitution=0.6", "bouncing.stops=1"])
    times, rotations = bounced(1.2, 0.6, 12)
    system = compose(Method1(BLOCK), effects)
    run = solve(system, theta=1e-9, omega=-1.2, t_end=float(times[-1]) + 0.02, save_at=times + 1e-9 / 1.2)
    np.testing.assert_allclose(run.theta, rotations, rtol=0.0, atol=1e-8)
    slipping = compose(Method1(BLOCK), parse(["bouncing.normal_restitution=0.6"]))
    other = solve(slipping, theta=1e-9, omega=-1.2, t_end=float(times[-1]) + 0.02, save_at=times)
    assert abs(other.theta[-1]) < 0.95 * abs(rotations[-1])


def test_whether_impacts_stop_a_corner_is_yes_or_no_and_of_impacts_at_an_instant() -> None:
    with pytest.raises(ValueError, match=r"bouncing\.stops=0\.5: want 0 or 1"):
        compose(Method1(BLOCK), parse(["bouncing.normal_restitution=0.3", "bouncing.stops=0.5"]))
    with pytest.raises(ValueError, match=r"bouncing\.stops=1\.0: want 0 beside bouncing\.contact_frequency=250"):
        lasting = ["bouncing.normal_restitution=0.3", "bouncing.stops=1", "bouncing.contact_frequency=250"]
        compose(Method1(BLOCK), parse(lasting))
    with pytest.raises(ValueError, match=r"normal_restitution=0\.9.*the kinematic pair creates energy"):
        compose(Method1(BLOCK), parse(["bouncing.normal_restitution=0.9", "bouncing.stops=1"]))


@pytest.mark.parametrize("restitution", [None, 0.97])
def test_sliding_and_bouncing_go_together_in_either_order(restitution: float | None) -> None:
    # What bounces has no restitution of its own: that follows from the bounces.
    other = Method2(BLOCK, friction=0.5, normal_restitution=0.3)
    texts = ["sliding.friction=0.5", "bouncing.normal_restitution=0.3"]
    for more in ([], ["sliding.ratio_kept=0.7"]):
        for given in (texts + more, texts[::-1] + more):
            same(given, Method1(BLOCK, restitution=restitution), other, theta=0.2)
    # Without bounces the law is that of sliding alone; Housner's restitution is carried by it where none is given.
    law: Any = {"impact_law": "two_corner", "restitution": restitution or BLOCK.housner_restitution, "ratio_kept": 0.7}
    plastic = ["sliding.friction=0.5", "sliding.ratio_kept=0.7", "bouncing.normal_restitution=0.0"]
    for given in (plastic[:2], plastic, plastic[::-1]):
        same(given, Method1(BLOCK, restitution=restitution), Method2(BLOCK, friction=0.5, **law), theta=0.2)


def test_gravity_rest_speed_and_restitution_go_along() -> None:
    method = Method1(BLOCK, restitution=0.97, g=9.6, rest_speed=1e-4)
    law: Any = {"impact_law": "two_corner", "restitution": 0.97, "g": 9.6, "rest_speed": 1e-4}
    same(["sliding.friction=0.8"], method, Method2(BLOCK, friction=0.8, **law), theta=0.2)
    same(["bouncing.friction=0.8"], method, Method2(BLOCK, friction=0.8, **law), theta=0.2)
    other = Method2(BLOCK, friction=0.8, normal_restitution=0.2, g=9.6, rest_speed=1e-4)
    same(["bouncing.friction=0.8", "bouncing.normal_restitution=0.2"], method, other, theta=0.2)


@pytest.mark.parametrize("restitution", [None, 0.9, 0.97])
def test_the_more_a_corner_bounces_the_lower_the_next_swing(restitution: float | None) -> None:
    peaks = []
    for e_n in (0.2, 0.5, 0.8):
        effects = parse([f"bouncing.normal_restitution={e_n}"])
        run = solve(Method1(BLOCK, restitution=restitution), t_end=1.5, theta=0.2, effects=effects)
        assert Mode.ROTATION_JUMP in run.events.mode_after
        peaks.append(float(-run.y[:, 2].min()))
    assert peaks[0] > 1.01 * peaks[1] > 1.02 * peaks[2]


def test_effects_on_the_base_go_with_the_modes() -> None:
    run = solve(Method1(BLOCK), MOTION, t_end=2.0, effects=parse(["sliding.friction=0.2", "base_tilt.angle=0.05"]))
    # On a floor that falls to +x friction gives way first in that direction.
    assert run.system.name == "method2"
    assert run.y[-1, 0] > 0.0


@pytest.mark.parametrize(
    ("text", "restitution", "message"),
    [
        ("sliding.friction=1.5", None, "friction=1.5 .*want below 4/3"),
        ("bouncing.friction=1.5", 0.97, "friction=1.5 .*want below 4/3"),
    ],
)
def test_what_method_2_refuses_is_refused(text: str, restitution: float | None, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        compose(Method1(BLOCK, restitution=restitution), parse([text]))


def test_friction_without_limit_never_slides() -> None:
    run = solve(Method1(BLOCK), MOTION, t_end=1.5, theta=0.1, effects=parse([f"sliding.friction={math.inf}"]))
    assert not {Mode.SLIDE, Mode.SLIDE_ROTATION} & set(run.mode.tolist())
