"""Bad arguments and motions are refused with name, value and what was wanted."""

import math

import numpy as np
import pytest

import dem

GOOD = {"t_end": 0.01, "mu": 0.5, "damping_ratio": 0.1, "dt": 1e-5}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"t_end": 0.0}, "^t_end=0.0 s: want a positive"),
        ({"t_end": math.inf}, "^t_end=inf"),
        ({"dt": -1e-6}, "^dt=-1e-06"),
        ({"dt": math.nan}, "^dt=nan"),
        ({"dt": 1.0}, "^dt=1.0 s: want a step below"),
        ({"kn": 0.0}, "^kn=0.0"),
        ({"ks": -1.0}, "^ks=-1.0"),
        ({"g": math.nan}, "^g=nan"),
        ({"mu": -0.1}, "^mu=-0.1: want a friction coefficient"),
        ({"mu": math.nan}, "^mu=nan"),
        ({"damping": 1.0}, "^damping=1.0, damping_ratio=0.1: want exactly one"),
        ({"damping_ratio": None}, "^damping=None, damping_ratio=None: want exactly one"),
        ({"damping_ratio": -0.1}, "^damping_ratio=-0.1 .*: want a finite number, at least 0"),
        ({"damping_ratio": None, "damping": math.inf}, "^damping=inf"),
        ({"onset": "late"}, "^onset='late': want 'overlap' or 'incremental'"),
        ({"coulomb": "sum"}, "^coulomb='sum': want 'total' or 'spring'"),
        ({"theta0": 1.6}, "^theta0=1.6 rad"),
        ({"theta0": math.nan}, "^theta0=nan"),
        ({"gap0": math.inf}, "^gap0=inf"),
        ({"x0": math.nan}, "^x0=nan"),
        ({"vx0": math.inf}, "^vx0=inf"),
        ({"vz0": math.nan}, "^vz0=nan"),
        ({"omega0": math.nan}, "^omega0=nan"),
        ({"save_every": 0}, "^save_every=0: want a whole number"),
        ({"save_every": 1.5}, "^save_every=1.5"),
        ({"save_every": True}, "^save_every=True"),
    ],
)
def test_bad_argument_is_refused_by_name(block, arguments, message):
    with pytest.raises(ValueError, match=message):
        dem.simulate(block(3), **{**GOOD, **arguments})


def spoilt(t):
    values = np.zeros_like(t)
    values[7] = math.nan
    return values, np.zeros_like(t)


@pytest.mark.parametrize(
    ("motion", "message"),
    [
        (5, "^motion=5: want a function of the times"),
        (lambda t: None, "motion gave NoneType: want a pair"),
        (lambda t: np.zeros_like(t), "motion gave ndarray: want a pair"),
        (lambda t: (0.0, 0.0), r"a_x of shape \(\): want \(1001,\)"),
        (lambda t: (t, t[:-1]), r"a_z of shape \(1000,\): want \(1001,\)"),
        (lambda t: (np.array([]), np.array([])), r"a_x of shape \(0,\)"),
        (spoilt, r"a_x=nan m/s\^2 at t=7e-05"),
        (lambda t: (t, t + math.inf), r"a_z=inf m/s\^2 at t=0 s"),
    ],
)
def test_bad_motion_is_refused_with_what_was_wanted(block, motion, message):
    with pytest.raises(ValueError, match=message):
        dem.simulate(block(3), motion, **GOOD)


class Table:
    """A base that stands still but for a pitch [rad] from 5 ms on."""

    def __init__(self, pitch):
        self.angle = pitch

    def __call__(self, t):
        return np.zeros_like(t), np.zeros_like(t)

    def pitch(self, t):
        return np.where(t > 5e-3, self.angle, 0.0), np.zeros_like(t)


def test_a_base_that_pitches_is_refused_where_it_would_not_be_felt(block):
    with pytest.raises(ValueError, match=r"pitches by 0\.001 rad at t=0\.00501 s.*; want one that does not pitch, or"):
        dem.simulate(block(3), Table(1e-3), **GOOD)
    level, still = (dem.simulate(block(3), motion, **GOOD) for motion in (Table(0.0), None))
    np.testing.assert_array_equal(level.z, still.z)


def test_damping_and_damping_ratio_say_the_same(block):
    scene = block(3)
    c = 2.0 * 0.1 * math.sqrt(1.98e7 * scene.mass)
    by_ratio = dem.simulate(scene, theta0=0.1, **GOOD)
    by_value = dem.simulate(scene, theta0=0.1, **{**GOOD, "damping_ratio": None, "damping": c})
    assert by_value.settings["damping"] == by_ratio.settings["damping"]
    assert np.array_equal(by_value.theta, by_ratio.theta)


@pytest.mark.parametrize(("place", "name"), [(0, "kn"), (1, "ks"), (2, "damping")])
def test_critical_step_refuses_bad_parameters_by_name(block, place, name):
    values = [1.98e7, 1.98e7, 10.0]
    values[place] = -1.0
    with pytest.raises(ValueError, match=f"^{name}=-1.0"):
        dem.critical_step(block(3), *values)


@pytest.mark.parametrize(("mass", "stiffness", "name"), [(0.0, 1.0, "mass"), (1.0, math.nan, "stiffness")])
def test_eq_7_refuses_bad_parameters_by_name(mass, stiffness, name):
    with pytest.raises(ValueError, match=f"^{name}="):
        dem.eq7_step(mass, stiffness)
