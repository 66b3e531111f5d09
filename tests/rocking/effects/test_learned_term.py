"""Each coefficient of a learned term against its formula, by hand (rocking.effects.learned_term)."""

import math
from dataclasses import fields

import numpy as np
import pytest

from rocking import Block, Method1, solve
from rocking.effects.learned_term import LearnedTerm, loss, torque
from rocking.form import Form
from rocking.hybrid import Base

THETA, OMEGA, SIDE, A_X = -0.12, 0.35, -1.0, 1.7
F = OMEGA / math.hypot(OMEGA, 3e-5)
TORQUES = {
    "bias": 1.0, "side": SIDE, "spring": THETA, "cubic": THETA**3, "friction": F, "damping": OMEGA,
    "side_damping": SIDE * OMEGA, "drag": OMEGA * abs(OMEGA), "cubic_damping": OMEGA**3, "base": A_X,
    "structural": abs(THETA) * F, "side_friction": SIDE * F, "outward": SIDE * abs(OMEGA),
}  # fmt: skip
LOSSES = {"restitution_side": SIDE, "restitution_speed": abs(OMEGA), "restitution_square": OMEGA**2}
FORM = Form.__new__(Form)  # the coefficients do not depend on the block


@pytest.mark.parametrize("name", [field.name for field in fields(LearnedTerm)])
def test_a_coefficient_adds_its_term_and_no_other(name: str) -> None:
    """The formulas in the first lines of the module, with one coefficient at 0.4."""
    values = LearnedTerm(**{name: 0.4}).values(FORM)
    added = torque(np, THETA, OMEGA, SIDE, Base(A_X, 0.0, 0.0, 0.0), values)
    lost = loss(np, 0.9, OMEGA, SIDE, values)
    assert added == pytest.approx(0.4 * TORQUES.get(name, 0.0), rel=1e-12, abs=1e-15)
    assert lost == pytest.approx(0.9 + 0.4 * LOSSES.get(name, 0.0), rel=1e-12)


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_what_friction_would_hold_creeps_slowly(share: float) -> None:
    """A torque beyond the weight's is that share of what rubs: omega = 3e-5 share / sqrt(1 - share^2)."""
    system, more = Method1(Block(0.2, 0.8)), 1.0
    p2, alpha = system.parameters.p2, system.parameters.alpha
    held = LearnedTerm(bias=p2 * math.sin(alpha) + more, friction=-more / share)
    found = solve(system, t_end=0.2, effects=[held], rtol=1e-11, atol=1e-13, save_at=[0.1, 0.2])
    pushed = p2 * (math.sin(alpha) - math.sin(alpha - found.theta[-1])) + more
    there = share * pushed / more
    assert found.omega[-1] == pytest.approx(3e-5 * there / math.sqrt(1.0 - there**2), rel=1e-4)


# Friction smoothed over 0.01 rad/s was right to 2e-5 here, and misled whole records by ten times the noise.
def test_friction_takes_its_work_from_a_block_that_falls_back() -> None:
    """Let go at theta_0 it comes down with omega^2 / 2 = p^2 (cos(alpha - theta_0) - cos alpha) - f theta_0."""
    block, f, start = Block(0.2, 0.8), 0.3, 0.1
    system = Method1(block)
    p2, alpha = system.parameters.p2, system.parameters.alpha
    speed = math.sqrt(2.0 * (p2 * (math.cos(alpha - start) - math.cos(alpha)) - f * start))
    fallen = solve(system, theta=start, t_end=1.0, effects=[LearnedTerm(friction=-f)], rtol=1e-11, atol=1e-13)
    assert -fallen.events.y_before[0, 1] == pytest.approx(speed, rel=1e-6)
