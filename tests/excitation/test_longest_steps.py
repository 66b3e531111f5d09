"""The longest step that a motion allows an integrator: short enough not to step over what it does."""

import math

import pytest

import excitation as ex


# A twentieth of a period: with the four looks that a solver takes in a step, 80 of them in each period.
@pytest.mark.parametrize(
    ("motion", "period"),
    [
        (ex.RampedSinusoid(2.5, 6.0, 6.0), 0.4),
        (ex.RampedSinusoid(2.5, 6.0, 6.0, imperfection=0.1, seed=3), 0.4),
        (ex.SteadySinusoid(4.0, 4.0, 5.0), 0.25),
        (ex.Chirp(1.0, 5.0, 4.0, 5.0), 0.2),
        (ex.Chirp(5.0, 1.0, 4.0, 5.0), 0.2),
        (ex.SinusoidalPitch(2.0, 0.01, 5.0), 0.5),
    ],
)
def test_a_step_is_a_twentieth_of_the_shortest_period(motion: ex.Motion, period: float) -> None:
    assert motion.max_step == pytest.approx(0.05 * period, rel=1e-12)


@pytest.mark.parametrize("kind", [ex.SampledMotion, ex.PiecewiseLinear])
def test_a_step_over_samples_is_no_longer_than_their_interval(kind: type) -> None:
    assert 0.0 < kind(0.01, [0.0, 1.0, -1.0, 0.5, 0.0]).max_step <= 0.01


def test_a_combination_keeps_the_shorter_step() -> None:
    fast, slow = ex.SteadySinusoid(10.0, 1.0, 5.0), ex.SteadySinusoid(1.0, 1.0, 5.0)
    assert ex.Combined(fast, slow).max_step == ex.Combined(slow, fast).max_step == fast.max_step
    assert not math.isinf(fast.max_step)
