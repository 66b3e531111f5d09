"""Each coefficient of a learned term against its formula, by hand (rocking.effects.learned_term)."""

import math
from dataclasses import fields

import numpy as np
import pytest

from rocking.effects.learned_term import LearnedTerm, loss, torque
from rocking.form import Form
from rocking.hybrid import Base

THETA, OMEGA, SIDE, A_X = -0.12, 0.35, -1.0, 1.7
F = OMEGA / math.hypot(OMEGA, 0.01)
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
