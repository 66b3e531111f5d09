"""Every kind of motion once, for the tests that must hold for all of them."""

import importlib
import math
import sys
from importlib.metadata import version
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

import excitation as ex


def _record(seed: int, size: int = 400) -> np.ndarray:
    """Smooth noise that begins and ends at zero."""
    t = np.linspace(0.0, 1.0, size)
    rng = np.random.default_rng(seed)
    waves = sum(rng.normal() * np.sin(2 * np.pi * k * t + rng.uniform(0, 6)) for k in range(2, 30))
    return np.sin(np.pi * t) * waves


MOTIONS = {
    "ramped": ex.RampedSinusoid(2.0, 6.0, 6.0, imperfection=0.1, seed=3),
    "ramped, held, tapered": ex.RampedSinusoid(2.0, 3.0, 6.0, hold=2.0, taper=1.0),
    "steady": ex.SteadySinusoid(2.0, 4.0, 5.0, phase=0.4, taper_in=0.5, taper_out=1.0),
    "steady, sudden": ex.SteadySinusoid(2.0, 4.0, 5.0),
    "chirp": ex.Chirp(1.0, 4.0, 4.0, 5.0, taper_in=0.2, taper_out=0.2),
    "chirp, logarithmic": ex.Chirp(4.0, 1.0, 4.0, 5.0, sweep="logarithmic"),
    "rectangular": ex.RectangularPulse(5.0, 0.3, start=0.2),
    "half sine": ex.HalfSinePulse(6.0, 0.6, start=0.2),
    "one sine": ex.OneSinePulse(-6.0, 0.6, start=0.2),
    "one cosine": ex.OneCosinePulse(6.0, 0.6, start=0.2),
    "symmetric Ricker": ex.SymmetricRickerPulse(6.0, 0.6),
    "antisymmetric Ricker": ex.AntisymmetricRickerPulse(6.0, 0.6),
    "Mavroeidis-Papageorgiou": ex.MavroeidisPapageorgiouPulse(0.9, 1.2, 2.2, nu=math.pi / 3),
    "Gabor": ex.GaborPulse(0.9, 1.2, 1.5, nu=0.3),
    "sampled": ex.SampledMotion(0.01, 0.8 * _record(1), start=0.1),
    "sampled, three": ex.SampledMotion(0.01, 0.8 * _record(1), 0.3 * _record(2), 0.002 * _record(3)),
    "combined": ex.Combined(ex.RampedSinusoid(2.0, 6.0, 6.0), ex.OneSinePulse(2.0, 0.5, start=1.0)),
    "combined with samples": ex.Combined(
        ex.SampledMotion(0.01, 0.8 * _record(1), pitch=0.002 * _record(3)), ex.Chirp(1.0, 4.0, 1.0, 5.0)
    ),
    "combined, pitching": ex.Combined(
        ex.RampedSinusoid(2.0, 6.0, 6.0, imperfection=0.1, seed=3),
        pitching=ex.SinusoidalPitch(2.0, 0.004, 6.0, growing=True, taper_out=0.5),
    ),
    "combined, three": ex.Combined(
        ex.SteadySinusoid(2.0, 4.0, 5.0),
        ex.OneSinePulse(2.0, 0.5, start=1.0),
        ex.ProportionalPitch(ex.SymmetricRickerPulse(6.0, 0.6), per_displacement=0.02, per_acceleration=1e-4),
    ),
    "combined, pitched by samples": ex.Combined(
        ex.OneCosinePulse(6.0, 0.6, start=0.2), pitching=ex.SampledMotion(0.01, _record(1), pitch=0.002 * _record(3))
    ),
    "sinusoidal pitch": ex.SinusoidalPitch(1.5, 0.01, 5.0, phase=0.7, taper_in=1.0),
    "growing pitch": ex.SinusoidalPitch(2.0, -0.01, 5.0, growing=True),
    "pitch by one sine": ex.ProportionalPitch(ex.OneSinePulse(-6.0, 0.6, start=0.2), per_displacement=0.05),
    "pitch by one cosine": ex.ProportionalPitch(ex.OneCosinePulse(6.0, 0.6, start=0.2), per_displacement=0.05),
    "pitch by a symmetric Ricker": ex.ProportionalPitch(ex.SymmetricRickerPulse(6.0, 0.6), 0.05, 1e-4),
    "pitch by an antisymmetric Ricker": ex.ProportionalPitch(ex.AntisymmetricRickerPulse(6.0, 0.6), 0.05, 1e-4),
    "pitch by Mavroeidis-Papageorgiou": ex.ProportionalPitch(
        ex.MavroeidisPapageorgiouPulse(0.9, 1.2, 2.2, nu=math.pi / 3), per_displacement=-0.02
    ),
    "pitch by Gabor": ex.ProportionalPitch(ex.GaborPulse(0.9, 1.2, 1.5, nu=0.3), per_acceleration=1e-4),
    "pitch by a steady sine": ex.ProportionalPitch(
        ex.SteadySinusoid(2.0, 4.0, 5.0, phase=0.4, taper_in=0.5, taper_out=1.0), per_acceleration=1e-4
    ),
    "pitch by a chirp": ex.ProportionalPitch(
        ex.Chirp(1.0, 4.0, 4.0, 5.0, taper_in=0.2, taper_out=0.2), per_acceleration=1e-4
    ),
    "pitch by a logarithmic chirp": ex.ProportionalPitch(
        ex.Chirp(4.0, 1.0, 4.0, 5.0, sweep="logarithmic", taper_in=0.3, taper_out=0.2, phase=1.0), per_acceleration=1e-4
    ),
    "piecewise linear": ex.PiecewiseLinear(0.01, 0.8 * _record(1), 0.3 * _record(2)),
    "piecewise linear, horizontal": ex.PiecewiseLinear(0.01, 0.8 * _record(1)),
}


@pytest.fixture(params=MOTIONS, scope="session")
def any_motion(request: pytest.FixtureRequest) -> ex.Motion:
    """Each motion in turn."""
    return MOTIONS[request.param]


@pytest.fixture(scope="session")
def motions() -> dict[str, ex.Motion]:
    """All of them."""
    return MOTIONS


@pytest.fixture
def pyrotd(monkeypatch):
    """The module pyrotd, which asks a part of setuptools that is deprecated, or gone, for its own version."""
    stand_in = ModuleType("pkg_resources")
    stand_in.get_distribution = lambda name: SimpleNamespace(version=version(name))
    monkeypatch.setitem(sys.modules, "pkg_resources", stand_in)
    return importlib.import_module("pyrotd")
