"""The dashpot of the distinct elements, fitted to a free vibration."""

from itertools import pairwise

import numpy as np
import pytest

import dem
from dem.free_swings import FRICTION
from rocking import Method1, solve
from studies.criteria.free_vibration import RELEASE, fit_dashpot, scene_of, swing_restitution
from studies.criteria.overturning import STIFFNESS
from studies.specimens import specimen

CONTACT = {"kn": STIFFNESS, "ks": STIFFNESS}


@pytest.mark.parametrize("restitution", [0.8761, 0.90, 0.95])
def test_fitted_dashpot_has_the_restitution_asked_for(restitution):
    fit = fit_dashpot(specimen(1), restitution, **CONTACT)
    assert fit.restitution == pytest.approx(restitution, abs=2e-4)  # the root is sought to 0.1 % of the dashpot
    assert swing_restitution(specimen(1), fit.damping, **CONTACT) == pytest.approx(restitution, abs=2e-4)


def peaks(theta):
    """Largest |theta| between one passage through upright and the next."""
    upright = np.flatnonzero(np.diff(np.sign(theta)) != 0)
    return np.array([np.abs(theta[a:b]).max() for a, b in pairwise(upright)])


def test_every_swing_of_the_fitted_block_is_that_of_method_1():
    """The fit sets the mean over the swings; each swing by itself against nonlinear Method 1."""
    block, restitution = specimen(1), 0.90
    theta = RELEASE * block.alpha
    fit = fit_dashpot(block, restitution, **CONTACT)
    t = np.arange(0.0, 2.0, 5e-4)
    run = solve(Method1(block, restitution=restitution), theta=theta, t_end=2.0, save_at=t)
    elements = dem.simulate(
        scene_of(block), t_end=2.0, dt=1e-5, mu=FRICTION, damping=fit.damping, theta0=theta, save_every=50
    )
    # A restitution that depends on speed by 0.001 about its mean moves a peak by twice that share: half a per cent
    # over the four swings leaves room for it and for the weight pressed into the springs, none for another law.
    assert peaks(elements.theta)[:4] == pytest.approx(peaks(run.theta)[:4], rel=5e-3)


@pytest.mark.parametrize("ratio", [0.1, 0.5, 1.0])
def test_the_restitution_is_that_of_a_block_let_go_about_its_corner(ratio):
    """Energy of the fifth peak over that of the release, to the eighth root; `dem.let_go` puts the corner at its place.

    Sampled every ms a peak is missed by up to (p 0.5 ms)^2 / 2 of its distance from balance, 2e-6, its energy by less
    than 1e-5, and its eighth root by less than 2e-6; bouncing corners (ratio 0.1) leave it to about 1e-6.
    """
    block = specimen(1)
    damping = 2.0 * ratio * np.sqrt(STIFFNESS * block.mass)
    run = dem.let_go(scene_of(block), RELEASE * block.alpha, t_end=4.0, damping=damping, **CONTACT)
    energy = np.cos(block.alpha - dem.swings(run.time, run.theta).peaks) - np.cos(block.alpha)
    found = swing_restitution(block, damping, **CONTACT)
    assert found == pytest.approx((energy[4] / energy[0]) ** 0.125, rel=5e-6)


def test_more_damping_loses_more():
    losses = [swing_restitution(specimen(1), c, **CONTACT) for c in (1e2, 1e3, 1e4, 1e5)]
    assert losses == sorted(losses, reverse=True)


def test_restitution_that_no_dashpot_gives_is_refused():
    # An undamped contact still loses to its own bouncing: nothing above about 0.97 can be had at b/h = 0.3.
    with pytest.raises(ValueError, match=r"restitution=0\.99: want 0\.87.* to 0\.9"):
        fit_dashpot(specimen(1), 0.99, **CONTACT)
