"""A plate between the base sensor and the block against closed forms (rocking.effects.learned_base)."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from excitation import PiecewiseLinear, SampledMotion, SteadySinusoid
from excitation.spectra import oscillator
from rocking.effects import base_with, load
from rocking.effects.learned_base import LearnedBase, answer
from rocking.motion import base_at

STEP = 0.004


def there(motion, t):
    return base_at(np, motion, t, np.asarray(motion.parameters))


@pytest.mark.parametrize(("frequency", "damping"), [(13.0, 0.07), (40.0, 0.2), (2.0, 0.5)])
@pytest.mark.parametrize("shaking", [1.5, 4.0])
def test_it_answers_a_sinusoid_as_the_transfer_function_says(frequency: float, damping: float, shaking: float) -> None:
    """Acceleration of the plate once its own motion has died away: (w^2 + 2 i z w W) / (w^2 - W^2 + 2 i z w W)."""
    end = 3.0 + 8.0 / (damping * 2.0 * math.pi * frequency)
    t = np.arange(0.0, end, STEP)
    W, w = 2.0 * math.pi * shaking, 2.0 * math.pi * frequency
    recorded = SampledMotion(STEP, 1.7 * np.sin(W * t))
    motion = LearnedBase(frequency, damping).base_motion(recorded, (0.0, end), 9.81)
    late = np.linspace(end - 1.0, end - 0.1, 331)
    ratio = (w**2 + 2j * damping * w * W) / (w**2 - W**2 + 2j * damping * w * W)
    expected = 1.7 * np.imag(ratio * np.exp(1j * W * late))
    found = there(motion, late)
    # Straight lines between samples are off by (W step)^2 / 12 of the amplitude, a thousandth at 4 Hz.
    np.testing.assert_allclose(found.a_x, expected, rtol=0.0, atol=2e-3 * 1.7 * abs(ratio))
    assert np.all(found.a_z == 0.0)


def test_it_is_the_oscillator_of_the_response_spectra() -> None:
    """a + y'' = -w^2 y - 2 z w y' of `excitation.spectra`; without damping y alone says it."""
    a = np.random.default_rng(0).standard_normal(2000)
    y = oscillator(a, STEP, 1.0 / 9.0, 0.0)
    moved = a + answer(a, STEP, 9.0, 0.0)
    np.testing.assert_allclose(moved, -((2.0 * math.pi * 9.0) ** 2) * y, rtol=0.0, atol=1e-8)


def test_under_a_record_that_begins_and_ends_at_once_it_is_that_of_another_integrator() -> None:
    """y'' + 2 z w y' + w^2 y = -a from rest by Runge-Kutta; the plate has a + y'' = -2 z w y' - w^2 y."""
    z, w, step = 0.05, 2.0 * math.pi * 12.0, 0.01
    a = 2.0 * np.convolve(np.random.default_rng(1).normal(size=150), np.hanning(7) / 3.5, "same")
    a[[0, -1]] = 1.0, -1.5
    recorded = PiecewiseLinear(step, a, start=0.3)
    motion = LearnedBase(12.0, z).base_motion(recorded, (0.0, 2.5), 9.81)

    def slope(t, y):
        at = np.interp(t, recorded.times, a) if t <= recorded.end else 0.0
        return y[1], -at - 2.0 * z * w * y[1] - w * w * y[0]

    y, bounds = np.zeros(2), (*recorded.times, 2.5)
    off = {"within": 0.0, "after": 0.0}
    for begins, ends in pairwise(bounds):
        stretch = solve_ivp(slope, (begins + 1e-12, ends), y, rtol=1e-10, atol=1e-13, dense_output=True)
        t = np.linspace(begins, ends, 40 if begins < recorded.end else 2000)[1:-1]
        moves = -np.array([w * w, 2.0 * z * w]) @ stretch.sol(t)
        part = "within" if begins < recorded.end else "after"
        off[part] = max(off[part], np.max(np.abs(there(motion, t).a_x - moves)))
        y = stretch.y[:, -1]
    # A cubic between samples of a curve that moves by up to 4 m/s^2; where the record ends it has a bend.
    assert off["within"] < 4e-3
    assert off["after"] < 2e-2
    assert not there(motion, np.linspace(0.0, 0.3 - 1e-6, 100)).a_x.any()


@pytest.mark.parametrize(("mass", "frequency", "damping"), [(0.01, 2.6, 0.02), (0.2, 5.0, 0.1)])
@pytest.mark.parametrize("shaking", [1.5, 2.62, 4.0])
def test_a_table_of_a_given_force_moves_otherwise_where_something_else_stands_on_it(
    mass: float, frequency: float, damping: float, shaking: float
) -> None:
    """The equations of both, solved in steady shaking: m (a + y'') = -c y' - k y, (M - m) a + m (a + y'') = M a_given.

    On the table it has the frequency and the damping given; a table that gives way makes both 1 / sqrt(1 - m/M) more.
    """
    w, W = 2.0 * math.pi * frequency, 2.0 * math.pi * shaking
    matrix = np.array([
        [mass, mass + 2.0 * damping * w * mass / (1j * W) + w**2 * mass / (1j * W) ** 2],  # of a and y''
        [1.0, mass],
    ])  # fmt: skip
    ratio = np.linalg.solve(matrix, np.array([0.0, 1.0]))[0]
    more = 1.0 / math.sqrt(1.0 - mass)
    effect = LearnedBase(frequency * more, damping * more, -mass / (1.0 - mass))
    end = 4.0 + 8.0 / (damping * w)
    t = np.arange(0.0, end, STEP)
    motion = effect.base_motion(SampledMotion(STEP, 1.7 * np.sin(W * t)), (0.0, end), 9.81)
    late = np.linspace(end - 1.0, end - 0.1, 331)
    expected = 1.7 * np.imag(ratio * np.exp(1j * W * late))
    np.testing.assert_allclose(there(motion, late).a_x, expected, rtol=0.0, atol=2e-3 * 1.7 * max(1.0, abs(ratio)))


def test_a_stiff_plate_moves_as_its_base_and_one_that_is_not_there_is_the_base() -> None:
    recorded = SteadySinusoid(2.0, 2.0, 4.0)
    t = np.linspace(1.0, 3.0, 201)
    plain = there(recorded, t).a_x
    stiff = LearnedBase(400.0, 0.7).base_motion(recorded, (0.0, 4.0), 9.81)
    # 1 + (W / w)^2 at the most.
    np.testing.assert_allclose(there(stiff, t).a_x, plain, rtol=0.0, atol=2.0 * 1e-3)
    assert LearnedBase().base_motion(recorded, (0.0, 4.0), 9.81) is recorded


def test_with_the_gain_of_a_sensor_the_order_in_which_they_are_given_does_not_matter() -> None:
    recorded = SampledMotion(STEP, np.sin(2.0 * math.pi * 3.0 * STEP * np.arange(1500)))
    effects = [load("base_motion_gain")(gain=1.2), LearnedBase(10.0, 0.1)]
    t = np.linspace(2.0, 4.0, 101)
    both, other = (there(base_with(recorded, e, (0.0, 5.0), 9.81), t).a_x for e in (effects, effects[::-1]))
    np.testing.assert_array_equal(both, other)
    alone = there(base_with(recorded, effects[1:], (0.0, 5.0), 9.81), t).a_x
    np.testing.assert_allclose(both, 1.2 * alone, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"frequency": 0.0}, r"learned_base.frequency=0.0 Hz: want 0.01 to 10000"),
        ({"frequency": 5.0, "damping_ratio": -0.1}, r"learned_base.damping_ratio=-0.1 1: want 0 to 10"),
    ],
)
def test_what_is_no_plate_is_refused(given: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        LearnedBase(**given)
