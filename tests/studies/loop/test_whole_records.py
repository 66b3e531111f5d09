"""Effects that swings only hint at: confirmed by whole records, and not asked about where these say nothing.

The campaign is of the virtual laboratory, which shares no code with the models.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from studies.campaigns import DeclaredBlock, read
from studies.laboratory.campaign import make_campaign
from studies.laboratory.parameters import G
from studies.loop import closing, whole_records
from studies.loop.candidates import candidates
from studies.loop.model import LoopModel
from studies.loop.tracing import Trial, all_candidates
from studies.loop.whole_records import MISSED, _at_the_cost_of_others, hinted, scan

RIVALS = {"compliant_base", "sliding", "base_tilt", "viscous_damping", "base_motion_lag"}


@pytest.mark.slow
def test_a_floor_too_stiff_for_one_swing_is_found_in_whole_records(tmp_path, monkeypatch):
    truth = make_campaign(2001, ["compliant_base"], tmp_path)
    monkeypatch.setattr(
        closing, "all_candidates", lambda model: tuple(c for c in all_candidates(model) if c.effect in RIVALS)
    )
    finding = closing.close(read(tmp_path / "campaign"), g=G)
    assert finding.verdict == "effect" and finding.chosen.effects == ("compliant_base",)
    assert any(note.startswith("single swings do not settle on compliant_base") for note in finding.notes)
    value = finding.after.get("compliant_base.corner_stiffness")
    # The interval that the loop gives is a tenth to either side (95 %): twice that.
    assert value == pytest.approx(truth.parameters["compliant_base.corner_stiffness"], rel=0.2)
    assert finding.errors["after"].holdout < 0.5 * finding.errors["before"].holdout


@pytest.mark.parametrize("rms, windows", [(MISSED - 0.01, ["a window"]), (10.0, [])], ids=["met", "unpredictable"])
def test_whole_records_that_are_met_or_not_predictable_are_not_asked(rms, windows, monkeypatch):
    def fail(*_, **__):
        raise AssertionError("something was fitted")

    monkeypatch.setattr(whole_records, "predictable", lambda given: given)
    monkeypatch.setattr(whole_records, "fit", fail)
    assert hinted(None, None, SimpleNamespace(rms=rms, windows=windows), None) == ()


@pytest.mark.parametrize("without, named", [(95.0, False), (5000.0, True)], ids=["by the refit", "by the effect"])
def test_a_scan_counts_what_the_effect_gains_and_not_what_a_refit_does(without, named, monkeypatch):
    [adhesion] = [c for c in candidates(DeclaredBlock(0.15, 0.5, 0.25, 11.25)) if c.effect == "base_adhesion"]

    def fit(_, model, parameters, windows, **__):
        there = model.get("base_adhesion.moment") > 0.0
        return SimpleNamespace(chi2=90.0 if there else without, model=model, windows=windows, samples=100)

    monkeypatch.setattr(whole_records, "fit", fit)
    model = LoopModel(DeclaredBlock(0.15, 0.5, 0.25, 11.25), 0.9)
    onto = Trial((), (), SimpleNamespace(model=model, windows=()))
    whole = SimpleNamespace(model=model, windows=(), chi2=1e4, samples=100)
    found = scan(SimpleNamespace(simulator=None), onto, whole, [adhesion])
    assert (found is not None) == named


def test_an_effect_that_spoils_what_was_explained_is_not_the_one():
    def rms(*values):
        return SimpleNamespace(by_window=np.array(values))

    # As met: a mass distribution that takes 38 deviations to 10 and 1 to 4, and a soft floor that helps throughout.
    assert _at_the_cost_of_others(rms(4.0, 10.2), rms(1.0, 38.3))
    assert not _at_the_cost_of_others(rms(4.4, 4.9, 1.0), rms(16.7, 21.4, 2.5))
    assert not _at_the_cost_of_others(rms(1.2, 1.0), rms(0.7, 38.3))  # still explained
