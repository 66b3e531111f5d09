"""The dashpot of the distinct elements, fitted to a free vibration."""

import numpy as np
import pytest

from rocking import Method1, solve
from studies.free_vibration import RELEASE, fit_dashpot, swing_restitution
from studies.overturning import STIFFNESS
from studies.specimens import specimen

CONTACT = {"kn": STIFFNESS, "ks": STIFFNESS}


@pytest.mark.parametrize("restitution", [0.8761, 0.90, 0.95])
def test_fitted_dashpot_has_the_restitution_asked_for(restitution):
    fit = fit_dashpot(specimen(1), restitution, **CONTACT)
    assert fit.restitution == pytest.approx(restitution, abs=2e-4)  # the root is sought to 0.1 % of the dashpot
    assert swing_restitution(specimen(1), fit.damping, **CONTACT) == pytest.approx(restitution, abs=2e-4)


def test_fitted_block_swings_like_method_1_with_that_restitution():
    """The peaks of a free vibration, which the fit reads as energies, against those of nonlinear Method 1."""
    import dem
    from studies.free_vibration import FRICTION, scene_of

    block, restitution = specimen(1), 0.90
    theta = RELEASE * block.alpha
    fit = fit_dashpot(block, restitution, **CONTACT)
    run = solve(Method1(block, restitution=restitution), theta=theta, t_end=1.6, save_at=np.linspace(0, 1.6, 3201))
    elements = dem.simulate(
        scene_of(block), t_end=1.6, dt=1e-5, mu=FRICTION, damping=fit.damping, theta0=theta, save_every=50
    )
    # A floor that gives shortens no swing of the rigid block by more than its own compression takes; the tilt at
    # the end of two swings agrees to 2 % of the release.
    assert np.interp(run.t, elements.time, elements.theta) == pytest.approx(run.theta, abs=0.02 * theta)


def test_more_damping_loses_more():
    losses = [swing_restitution(specimen(1), c, **CONTACT) for c in (1e2, 1e3, 1e4, 1e5)]
    assert losses == sorted(losses, reverse=True)


def test_restitution_that_no_dashpot_gives_is_refused():
    # An undamped contact still loses to its own bouncing: nothing above about 0.97 can be had at b/h = 0.3.
    with pytest.raises(ValueError, match=r"restitution=0\.99: want 0\.87.* to 0\.9"):
        fit_dashpot(specimen(1), 0.99, **CONTACT)
