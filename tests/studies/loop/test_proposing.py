"""The test that would best settle what is open."""

import dataclasses

import found
import numpy as np

from studies.loop.proposing import next_test


def test_records_that_nothing_explains_are_to_be_repeated():
    finding = found.tilted()
    # Nothing was found, and the second window is missed by seven times its noise.
    fit = finding.before_fit
    residuals = tuple(np.full(r.size, 7.0 if k == 1 else 1.0) for k, r in enumerate(fit.residuals))
    missed = dataclasses.replace(fit, residuals=residuals)
    plain = finding.rounds[0].onto
    finding = dataclasses.replace(
        finding, verdict="unexplained", after=finding.before, after_fit=missed, chosen=plain, rivals=()
    )  # fmt: skip
    said = next_test(finding)
    test = finding.setup.campaign.tests[fit.windows[1].test].id
    assert said.startswith(f"Repeat {test} as it was")
    assert "missed by 7 times its noise" in said


def test_what_explains_only_a_part_is_called_by_its_name():
    said = next_test(dataclasses.replace(found.tilted(), verdict="unexplained"))
    assert "the calibrated ideal block and the one with base tilt" in said
    assert "learned" not in said
