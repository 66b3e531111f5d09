"""A sensor of the rotation that answers as a low-pass, by hand and by another integrator (rocking.effects)."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rocking import Block, Method1, solve
from rocking.effect import Seen
from rocking.effects import load, parse
from rocking.instruments import rotation_sensor

FREQUENCY = 14.0
TIME = 0.002 * np.arange(1001)


def seen(time: np.ndarray) -> Seen:
    return Seen(time, np.zeros(time.size))


@pytest.mark.parametrize("damping_ratio", [0.1, 0.7, 1.0, 3.0])
def test_its_equation_by_another_integrator(damping_ratio: float) -> None:
    """DOP853 of SciPy under a rotation that is not sampled evenly; what is left is of the fourth order in the step."""
    w, sensor = 2.0 * math.pi * FREQUENCY, load("learned_response")(frequency=FREQUENCY, damping_ratio=damping_ratio)
    time = np.concatenate([0.004 * np.arange(40), 0.16 + 0.01 * np.arange(40)])

    def rates(t: float, y: np.ndarray) -> tuple[float, float]:
        return y[1], w**2 * (0.1 * math.cos(7.0 * t) - y[0]) - 2.0 * damping_ratio * w * y[1]

    there = solve_ivp(rates, (0.0, time[-1]), [0.1, 0.0], method="DOP853", rtol=1e-11, atol=1e-14, t_eval=time)
    read = sensor.recorded(0.1 * np.cos(7.0 * time), seen(time))
    np.testing.assert_allclose(read, there.y[0], rtol=0.0, atol=5e-6)


def test_a_sinusoid_by_hand() -> None:
    """1 / (1 - r^2 + 2 i damping_ratio r) of one at r times its frequency, once the beginning has died out."""
    sensor, r = load("learned_response")(frequency=FREQUENCY, damping_ratio=0.7), 0.2
    answer = 1.0 / (1.0 - r**2 + 1.4j * r)
    turned = 2j * math.pi * r * FREQUENCY * TIME
    read = sensor.recorded(np.exp(turned).imag, seen(TIME))
    np.testing.assert_allclose(read[500:], (answer * np.exp(turned)).imag[500:], rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("damping_ratio", [0.3, 1.0, 2.0])
def test_from_another_sample_on_it_goes_on_as_it_went(damping_ratio: float) -> None:
    """Of a parabola that has gone on for long the answer is a parabola: late, and bent by what two rates leave."""
    sensor, w = load("learned_response")(frequency=FREQUENCY, damping_ratio=damping_ratio), 2.0 * math.pi * FREQUENCY
    late, bent = 2.0 * damping_ratio / w, (4.0 * damping_ratio**2 - 1.0) / w**2
    read = sensor.recorded(0.1 - 0.3 * TIME - 2.0 * TIME**2, seen(1.0 + TIME))
    expected = 0.1 - 0.3 * TIME - 2.0 * TIME**2 - late * (-0.3 - 4.0 * TIME) - 4.0 * bent
    np.testing.assert_allclose(read, expected, rtol=0.0, atol=1e-6)


def test_a_sensor_that_is_fast_reads_the_rotation() -> None:
    theta = 0.1 * np.cos(7.0 * TIME)
    np.testing.assert_allclose(
        load("learned_response")(frequency=5e3).recorded(theta, seen(TIME)), theta, rtol=0.0, atol=1e-4
    )
    assert load("learned_response")().recorded(theta, seen(TIME)) is theta


def test_a_run_is_read_through_it() -> None:
    """A block that is held at its lean until the record begins, then late by 2 damping_ratio / w while it falls."""
    effects = parse([f"learned_response.frequency={FREQUENCY}", "learned_response.damping_ratio=0.7"])
    run = solve(Method1(Block(b=0.2, h=0.8)), theta=0.1, t_end=0.26, save_at=0.002 * np.arange(131), effects=effects)
    read, late = rotation_sensor(run), 1.4 / (2.0 * math.pi * FREQUENCY)
    assert read[0] == pytest.approx(0.1, abs=1e-12)
    there = np.interp(run.t[60:] - late, run.t, run.theta)
    np.testing.assert_allclose(read[60:], there, rtol=0.0, atol=1e-4)  # theta'' times (4 z^2 - 1 - 2 z^2) / w^2


@pytest.mark.parametrize("frequency", [0.0, 1e5])
def test_a_sensor_of_another_world_is_refused(frequency: float) -> None:
    with pytest.raises(ValueError, match=r"learned_response\.frequency=.* Hz: want 0\.01 to 10000"):
        load("learned_response")(frequency=frequency)


def test_impacts_are_rounded_off() -> None:
    """A run with impacts, read at 250 Hz and at 10 kHz: an impact lies anywhere between two samples."""
    effects = parse([f"learned_response.frequency={FREQUENCY}", "learned_response.damping_ratio=0.7"])

    def read(step: float, every: int) -> np.ndarray:
        time = step * np.arange(round(1.2 / step) + 1)
        run = solve(Method1(Block(b=0.2, h=0.8)), theta=0.1, t_end=1.2, save_at=time, effects=effects)
        assert len(run.impact_times) > 2
        return rotation_sensor(run)[::every]

    np.testing.assert_allclose(read(0.004, 1), read(1e-4, 40), rtol=0.0, atol=2e-5)
