"""Factors of units against their definitions: inch and foot of 1959, the gal, standard gravity, and a full turn."""

import math

import pytest

from excitation.units import FACTORS, factor

DEFINED = {
    ("acceleration", "m/s2"): 1.0,
    ("acceleration", "cm/s2"): 0.01,
    ("acceleration", "mm/s2"): 0.001,
    ("acceleration", "in/s2"): 0.0254,
    ("acceleration", "ft/s2"): 12 * 0.0254,
    ("acceleration", "gal"): 0.01,
    ("acceleration", "g"): 9.80665,
    ("acceleration", "mg"): 0.00980665,
    ("acceleration", "g/10"): 0.980665,
    ("velocity", "m/s"): 1.0,
    ("velocity", "cm/s"): 0.01,
    ("velocity", "mm/s"): 0.001,
    ("velocity", "in/s"): 0.0254,
    ("displacement", "m"): 1.0,
    ("displacement", "cm"): 0.01,
    ("displacement", "mm"): 0.001,
    ("displacement", "in"): 0.0254,
    ("time", "s"): 1.0,
    ("time", "ms"): 0.001,
    ("angle", "rad"): 1.0,
    ("angle", "mrad"): 0.001,
    ("angle", "deg"): 2.0 * math.pi / 360.0,
    ("angular acceleration", "rad/s2"): 1.0,
    ("angular acceleration", "deg/s2"): 2.0 * math.pi / 360.0,
}


def test_every_unit_is_in_the_table_below_and_none_is_missing() -> None:
    assert {(quantity, unit) for quantity, known in FACTORS.items() for unit in known} == set(DEFINED)


@pytest.mark.parametrize(("quantity", "unit"), DEFINED)
def test_a_unit_has_the_factor_of_its_definition(quantity: str, unit: str) -> None:
    assert factor(unit, quantity) == pytest.approx(DEFINED[quantity, unit], rel=1e-15)
