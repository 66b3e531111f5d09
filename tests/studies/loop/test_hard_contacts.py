"""A corner that bounces while the other one is still in contact: found, and how much is left of a speed.

The campaign is of the virtual laboratory, whose corners stand on hard springs; it shares no code with the models.
"""

import pytest

from studies.campaigns import read
from studies.laboratory.campaign import make_campaign
from studies.laboratory.parameters import G
from studies.loop import closing
from studies.loop.search import searching
from studies.loop.swings.tracing import all_candidates

RIVALS = {"bouncing", "compliant_base", "velocity_dependent_restitution", "viscous_damping", "base_motion_lag"}


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """What was planted, and what was found."""
    path = tmp_path_factory.mktemp("bouncing")
    truth = make_campaign(2002, ["bouncing"], path)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            searching, "all_candidates", lambda *given: tuple(c for c in all_candidates(*given) if c.effect in RIVALS)
        )
        return truth, closing.close(read(path / "campaign"), g=G)


@pytest.mark.slow
@pytest.mark.slowest
def test_a_corner_that_bounces_is_found(found):
    truth, finding = found
    assert finding.verdict == "effect" and finding.chosen.effects == ("bouncing",)
    value = finding.after.get("bouncing.normal_restitution")
    assert value == pytest.approx(truth.parameters["bouncing.normal_restitution"], abs=0.05)
    assert finding.errors["after"].holdout < 0.5 * finding.errors["before"].holdout
    _, low, high = finding.intervals["bouncing.friction"]
    assert low <= 0.7 <= high  # as the laboratory declares it


# Found from releases: 0.7569 (0.7561 to 0.7576) where 0.7597 is planted, and 1.3007 (1.2994 to 1.3019) where 1.3100,
# with whole records met to 0.86 times their noise.  Such intervals are too narrow; why was not found out.
@pytest.mark.slow
@pytest.mark.slowest
@pytest.mark.xfail(strict=True, reason="the interval of the normal restitution misses what is planted")
def test_the_interval_holds_what_is_planted(found):
    truth, finding = found
    _, low, high = finding.intervals["bouncing.normal_restitution"]
    assert low <= truth.parameters["bouncing.normal_restitution"] <= high
