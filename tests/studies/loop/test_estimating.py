"""How sure a fit is, against the spread of many fits: noise of the base sensor moves what is fitted to a response.

The response is made with the package's SciPy solver; each fit sees another draw of the noise.
"""

import numpy as np
import pytest

from excitation import RampedSinusoid
from rocking import Block, Method1, solve
from studies.campaigns import Channel, DeclaredBlock, Test
from studies.loop.fits.estimating import robust_covariance, sensor_covariance
from studies.loop.fits.fitting import Fit, fit
from studies.loop.models.model import LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.observed.spread import redrawn
from studies.loop.observed.windows import record_of, whole_windows
from studies.loop.runs.simulation import Simulator

BLOCK = Block(0.2, 0.8, 0.4)
DECLARED = DeclaredBlock(0.2, 0.8, 0.4, BLOCK.mass)
OF_ROTATION, OF_BASE = 1e-4, 0.003
CHANNELS = (
    Channel("rotation", "rotation", OF_ROTATION),
    Channel("base_x", "base_acceleration_x", OF_BASE),
)
GAIN = Parameter("base_motion_gain.gain", 0.02, 0.5, 2.0)
TIME = 0.008 * np.arange(500)
MOTION = RampedSinusoid(3.0, 4.0, 6.0)


@pytest.fixture(scope="module")
def fits() -> list[tuple[Simulator, Simulator, Fit]]:
    """The gain fitted to one record as eighty noises of its base have it, and what covariances are taken from."""
    run = solve(Method1(BLOCK, restitution=0.91, g=9.81), MOTION, t_end=float(TIME[-1]), save_at=TIME, solver="scipy")
    rng, out = np.random.default_rng(4), []
    for seed in range(80):
        data = {
            "rotation": run.theta + OF_ROTATION * rng.standard_normal(TIME.size),
            "base_x": MOTION(TIME)[0] + OF_BASE * rng.standard_normal(TIME.size),
        }
        test = Test("ramp", "forced", TIME, CHANNELS, data)
        simulator = Simulator([test])
        windows = whole_windows([record_of(test, 0, OF_ROTATION, DECLARED.alpha)])
        start = LoopModel(DECLARED, 0.91, {"base_motion_gain": {"gain": 1.0}}, 9.81)
        found = fit(simulator, start, [GAIN], windows, whole=True, central=True, huber=np.inf)
        out.append((simulator, redrawn([test], np.array([OF_BASE]), seed=seed), found))
    return out


# The standard deviation of eighty fits is known to 8 %, that of 32 redrawn noises to 13 %; let be 3 sd.
@pytest.mark.slow
def test_the_covariance_is_the_spread_of_fits_under_other_noise(fits: list[tuple[Simulator, Simulator, Fit]]) -> None:
    values = np.array([found.values[GAIN.name] for _, _, found in fits])
    spread = float(np.std(values, ddof=1))
    assert abs(values.mean() - 1.0) < 3.0 * spread / np.sqrt(len(fits))
    said = np.array([np.sqrt(robust_covariance(*one)[0, 0]) for one in fits[:12]])
    assert np.median(said) == pytest.approx(spread, rel=0.25)
    # Of 4 draws: 0.24 to 2.3 times the spread.
    assert 0.7 * spread < said.min() and said.max() < 1.5 * spread
    simulator, _, found = fits[0]
    assert np.sqrt(sensor_covariance(simulator, found)[0, 0]) < 0.03 * spread
