"""The test that would best settle what is open."""

import dataclasses

import found
import numpy as np

from studies.loop.proposing import next_test


def unexplained(far):
    """A finding of nothing, whose whole records are missed by so many times their noise."""
    finding = found.tilted()
    fit = finding.before_fit
    residuals = tuple(np.full(r.size, far.get(k, 1.0)) for k, r in enumerate(fit.residuals))
    rms = float(np.sqrt(np.mean(np.concatenate(residuals) ** 2)))
    whole = dataclasses.replace(fit, residuals=residuals, rms=rms)
    return dataclasses.replace(
        finding, verdict="unexplained", after=finding.before, after_fit=whole, chosen=finding.rounds[0].onto, rivals=()
    )


def test_records_that_nothing_explains_are_to_be_repeated():
    finding = unexplained({1: 7.0, 2: 5.0})
    said = next_test(finding)
    test = finding.setup.campaign.tests[finding.after_fit.windows[1].test].id
    assert said.startswith(f"Repeat {test} as it was")
    assert "its record is missed by 7 times the noise" in said


def test_swings_that_nothing_explains_are_to_be_repeated_where_records_are_met():
    finding = unexplained({})
    swing = finding.chosen.swing
    k = int(np.argmax(swing.by_window))
    said = next_test(finding)
    assert said.startswith(f"Repeat {finding.setup.campaign.tests[swing.windows[k].test].id} as it was")
    assert f"one of its swings is missed by {swing.by_window[k]:.0f} times the noise" in said


def test_what_explains_only_a_part_is_called_by_its_name():
    said = next_test(dataclasses.replace(found.tilted(), verdict="unexplained"))
    assert "the calibrated ideal block and the one with base tilt" in said
    assert "learned" not in said
