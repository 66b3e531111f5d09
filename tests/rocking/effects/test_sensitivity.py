"""Where an effect is not there its sensitivity is a number: central differences at the absent value converge.

With located events impact times depend smoothly on smooth effects; a step over an event, a guard that snaps or a kink
at zero would show as differences that grow as the step falls.
"""

from typing import Any

import numpy as np
import pytest

from rocking import Block, Method1, solve
from rocking.effects import load

BLOCK = Block(b=0.2, h=0.8)

STEPS = {  # effect, parameter: step, of the size that a measurement would tell apart
    ("base_motion_gain", "gain"): 1e-3,
    ("base_motion_lag", "lag"): 1e-4,
    ("base_tilt", "angle"): 1e-4,
    ("concave_base", "breadth"): 1e-4,
    ("eccentric_mass", "offset"): 1e-4,
    ("mass_distribution", "height"): 1e-3,
    ("mass_distribution", "inertia"): 1e-2,
    ("table_pitch", "per_acceleration"): 1e-6,
    ("table_pitch", "per_displacement"): 1e-3,
    ("velocity_dependent_restitution", "slope"): 1e-3,
    ("vertical_motion", "ratio"): 1e-3,
    ("vertical_motion", "second_harmonic_ratio"): 1e-3,
    ("vertical_motion", "second_harmonic_quadrature"): 1e-3,
}

ONE_SIDED = {  # cannot be less than not there: forward differences, of second order
    ("rounded_edges", "radius"): 1e-4,
    ("viscous_damping", "coefficient"): 1e-3,
    ("quadratic_drag", "coefficient"): 1e-3,
    ("tether", "stiffness"): 0.1,
}


def impacts(shaken: Any, name: str, parameter: str, value: float, solver: str = "numba") -> np.ndarray:
    """Times of the first four impacts of a shaken block [s]."""
    parameters = load(name).absent(BLOCK) | {parameter: value}
    run = solve(
        Method1(BLOCK), shaken(), theta=0.08, t_end=1.6, rtol=1e-12, atol=1e-15, solver=solver,
        effects=[load(name)(**parameters)],
    )  # fmt: skip
    assert len(run.impact_times) >= 4
    return np.asarray(run.impact_times[:4])


@pytest.mark.parametrize(("name", "parameter"), STEPS)
def test_central_differences_at_the_absent_value_converge(shaken: Any, name: str, parameter: str) -> None:
    absent, step = load(name).absent(BLOCK)[parameter], STEPS[name, parameter]

    def slope(h: float) -> np.ndarray:
        ahead, behind = (impacts(shaken, name, parameter, absent + sign * h) for sign in (1.0, -1.0))
        return (ahead - behind) / (2.0 * h)

    wide, middle, narrow = slope(step), slope(0.5 * step), slope(0.25 * step)
    scale = np.max(np.abs(narrow))
    assert np.all(np.isfinite(narrow))
    assert scale * step > 1e-7
    # Of second order: halved, the error falls fourfold, down to the noise of impact times (1e-12 s or so each).
    noise = 4e-12 / (0.25 * step) / scale
    assert np.max(np.abs(middle - narrow)) / scale < 1e-3 + noise
    assert np.max(np.abs(middle - narrow)) < 0.4 * np.max(np.abs(wide - middle)) + 2.0 * noise * scale


@pytest.mark.parametrize(("name", "parameter"), ONE_SIDED)
def test_forward_differences_at_the_absent_value_converge(shaken: Any, name: str, parameter: str) -> None:
    absent, step = load(name).absent(BLOCK)[parameter], ONE_SIDED[name, parameter]
    start = impacts(shaken, name, parameter, absent)

    def slope(h: float) -> np.ndarray:
        near, far = (impacts(shaken, name, parameter, absent + k * h) for k in (1.0, 2.0))
        return (4.0 * near - far - 3.0 * start) / (2.0 * h)

    wide, middle, narrow = slope(step), slope(0.5 * step), slope(0.25 * step)
    scale = np.max(np.abs(narrow))
    assert scale * step > 1e-7
    noise = 1e-11 / (0.25 * step) / scale
    assert np.max(np.abs(middle - narrow)) / scale < 1e-3 + noise
    assert np.max(np.abs(middle - narrow)) < 0.4 * np.max(np.abs(wide - middle)) + 2.0 * noise * scale


# Free rocking says it in closed form: time scales with the root of the inertia, dt/dI = t/2 I_O at the first landing.
def test_the_sensitivity_to_inertia_is_that_of_the_closed_form() -> None:
    def landing(inertia: float) -> float:
        effect = load("mass_distribution")(inertia=inertia)
        run = solve(Method1(BLOCK), theta=0.1, t_end=1.0, rtol=1e-12, atol=1e-15, effects=[effect])
        return float(run.impact_times[0])

    h = 1e-3
    slope = (landing(BLOCK.I_c + h) - landing(BLOCK.I_c - h)) / (2.0 * h)
    assert slope == pytest.approx(0.5 * landing(BLOCK.I_c) / BLOCK.I_O, rel=1e-6)


# A late record under which nothing else depends on time: every event is earlier by the lag.
def test_the_sensitivity_to_a_lag_of_an_onset_is_minus_one(window: Any) -> None:
    def onset(lag: float) -> float:
        motion = window(0.5, 1.5, x=(0.0, 4.0, 3.0, 0.0))
        return solve(Method1(BLOCK), motion, t_end=1.2, effects=[load("base_motion_lag")(lag=lag)]).onset_time

    assert (onset(1e-3) - onset(-1e-3)) / 2e-3 == pytest.approx(-1.0, abs=1e-8)
