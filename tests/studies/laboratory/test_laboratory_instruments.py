"""The virtual laboratory's table and accelerometers against derivatives of what they stand for."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from studies.campaigns import Channel
from studies.laboratory import event, instruments, slip, table
from studies.laboratory.effects import Lab
from studies.laboratory.instruments import point_acceleration
from studies.laboratory.parameters import G

from .laboratory_blocks import AT_REST, GROWING, LEAN, STEP, TIME, WORLD, Growing

RNG = np.random.default_rng(11)


def test_an_accelerometer_that_is_mounted_askew_reads_along_its_own_axis(monkeypatch: pytest.MonkeyPatch) -> None:
    """Turned clockwise by an angle, what looked up leans toward +x, and what looked along +x leans down."""
    angle, felt = 0.1, np.array([[2.0, 9.8]])
    monkeypatch.setattr(instruments, "point_acceleration", lambda *_: felt)
    monkeypatch.setattr(instruments, "felt_by_motion", lambda *_: np.zeros((1, 5, 4)))
    plan, lab = SimpleNamespace(motion=None, rate=100.0, samples=1, order=0), Lab(WORLD)

    def read(axis: tuple[float, float]) -> float:
        channel = Channel("it", "block_acceleration", 0.0, (0.0, 0.3), axis)
        [value] = instruments.reading(lab, plan, None, channel, instruments.Bench((channel,), {"it": angle}))
        return float(value)

    assert read((0.0, 1.0)) == pytest.approx(2.0 * math.sin(angle) + 9.8 * math.cos(angle), rel=1e-14)
    assert read((1.0, 0.0)) == pytest.approx(2.0 * math.cos(angle) - 9.8 * math.sin(angle), rel=1e-14)


@pytest.mark.parametrize("offset", [0.0, 0.004])
def test_accelerometers_read_the_same_of_a_block_whose_contact_is_resolved(offset: float) -> None:
    """A foot that sticks: by the motion of the centre of mass, and by that of the edge."""
    block = replace(WORLD, offset=offset)
    rough = replace(block, friction=0.9)
    stuck, rolling = slip.simulate(rough, AT_REST, STEP, 4, LEAN), event.simulate(block, AT_REST, STEP, 4, LEAN)
    for place in ((0.04, 0.5), (-0.1, 0.0), (0.0, 0.6)):
        by_centre = point_acceleration(Lab(rough), stuck, AT_REST, place, every=4)
        by_edge = point_acceleration(Lab(block), rolling, AT_REST, place, every=4)
        until = 50  # samples before the first impact, at which a sample may lie on either side
        assert by_centre[:until] == pytest.approx(by_edge[:until], abs=1e-6)


@pytest.mark.parametrize("world", [WORLD, replace(WORLD, radius=0.01, tilt=0.01)])
def test_accelerometers_read_the_second_derivative_of_their_place(world) -> None:
    """Place of a point by plane geometry (a rolling disc), differentiated twice over the samples."""
    response = event.simulate(world, GROWING, STEP, 1, 0.0)
    x, z = 0.04, 0.5
    found = point_acceleration(Lab(world), response, GROWING[::1], (x, z), every=1)
    theta, r = response.rotation, world.radius
    corner = np.sign(theta) * (world.half_breadth - r)
    place = np.stack(
        [
            corner + r * theta + (x - corner) * np.cos(theta) + (z - r) * np.sin(theta),
            r - (x - corner) * np.sin(theta) + (z - r) * np.cos(theta),
        ]
    )
    own = (place[:, 2:] - 2 * place[:, 1:-1] + place[:, :-2]) / STEP**2
    ax = Growing.kernel(np, TIME, Growing.parameters)[0][1:-1]
    c, s = math.cos(world.tilt), math.sin(world.tilt)
    fx, fz = G * s - ax * c, -G * c - ax * s
    total = own - np.stack([fx, fz])
    inner = theta[1:-1]
    along = total[0] * np.cos(inner) - total[1] * np.sin(inner)
    up = total[0] * np.sin(inner) + total[1] * np.cos(inner)
    # Not across impacts, where the velocity jumps.
    calm = np.abs(inner) > 0.004
    calm &= np.sign(theta[2:]) == np.sign(theta[:-2])
    assert calm.sum() > 500
    assert found[1:-1][calm] == pytest.approx(np.stack([along, up], axis=1)[calm], abs=2e-3)


def test_accelerometers_on_a_pitching_floor_read_the_second_derivative_of_their_place() -> None:
    """Euler, Coriolis and centripetal terms: the place seen from the ground, differentiated twice over the samples."""
    t = STEP * np.arange(400)
    theta, rate, acc = 0.1 + 0.05 * np.sin(9 * t), 0.45 * np.cos(9 * t), -4.05 * np.sin(9 * t)
    beta, turning, twist = 0.03 * np.sin(14 * t), 0.42 * np.cos(14 * t), -5.88 * np.sin(14 * t)
    still = np.zeros(t.size)
    felt = table.pieces(STEP, still, still, (beta, turning, twist))
    response = event.Response(t, theta, rate, acc, np.zeros((0, 3)), None)
    x, z = 0.04, 0.5
    found = point_acceleration(Lab(WORLD), response, felt, (x, z), every=1)
    across = WORLD.half_breadth + (x - WORLD.half_breadth) * np.cos(theta) + z * np.sin(theta)
    height = -(x - WORLD.half_breadth) * np.sin(theta) + z * np.cos(theta)
    seen = np.stack([
        across * np.cos(beta) + height * np.sin(beta), -across * np.sin(beta) + height * np.cos(beta)
    ])  # fmt: skip
    felt_there = (seen[:, 2:] - 2 * seen[:, 1:-1] + seen[:, :-2]) / STEP**2 + np.array([[0.0], [G]])
    angle = (theta + beta)[1:-1]
    along = felt_there[0] * np.cos(angle) - felt_there[1] * np.sin(angle)
    up = felt_there[0] * np.sin(angle) + felt_there[1] * np.cos(angle)
    # Differences of second order: 14^4 * 0.5 m * 0.03 / 12 of the step squared, 5e-5 m/s^2.
    assert found[1:-1] == pytest.approx(np.stack([along, up], axis=1), abs=2e-4)


def test_motions_are_the_derivatives_of_their_displacement() -> None:
    for motion in (table.ramp(RNG, 3.5, 4.0), table.quake(RNG, 4.0)):
        t = np.linspace(0.0, motion.end + 0.2, 4001)
        h = t[1] - t[0]
        for k in range(4):
            rough = np.gradient(motion.derivative(k, t), h)
            exact = motion.derivative(k + 1, t)
            assert np.abs(rough - exact)[2:-2].max() < 2e-3 * np.abs(exact).max()
        assert motion.derivative(0, t[-1:])[0] == 0.0
        assert np.abs(motion.derivative(2, t)).max() == pytest.approx(4.0, rel=0.02)


def test_second_harmonic_of_a_sinusoid() -> None:
    t = 0.002 * np.arange(2000)
    found = table.second_harmonic(3.0 * np.cos(2 * np.pi * 4.0 * t + 0.3), 0.5)
    assert found == pytest.approx(3.0 * np.cos(2 * (2 * np.pi * 4.0 * t + 0.3) + 0.5), abs=1e-9)


def test_a_piece_of_the_base_is_its_five_cubics() -> None:
    pieces = np.random.default_rng(3).standard_normal((5, 4))
    for x in (0.0, 0.3, 1.7):
        assert event.base(x, pieces) == pytest.approx([np.polynomial.Polynomial(row)(x) for row in pieces], rel=1e-14)
