"""The test that would best settle what is open."""

import dataclasses

import found
import numpy as np

from studies.loop import proposing
from studies.loop.proposing import _again, _left_open, _most_telling, _noise, _proposals, next_test
from studies.loop.runs.simulation import Job, Simulator


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


def test_a_test_is_judged_by_what_noise_leaves_open_there():
    """Of a release that is what its lean's noise does, to first order: 0.92 of its deviation, in eight equal parts."""
    finding = found.tilted()
    proposals = [p for p in _proposals(finding) if p.test.kind == "free"]
    simulator, noise = Simulator([p.test for p in proposals]), _noise(finding)
    small = 1e-6
    read = [
        [a.theta for a in simulator.run([finding.after], [
            Job(0, k, p.test.time, 0.0, p.lean + step) for k, p in enumerate(proposals)
        ])] for step in (0.0, small)
    ]  # fmt: skip
    slopes = np.array([np.sqrt(np.mean((b - a) ** 2)) / small for a, b in zip(*read, strict=True)])
    again = _again(proposals)
    left = np.array([
        _left_open(again[k], p, noise, [finding.after], [read[0][k]]) for k, p in enumerate(proposals)
    ])  # fmt: skip
    of_the_lean = np.sqrt(left**2 - noise**2) / (noise * slopes)
    np.testing.assert_allclose(of_the_lean, 0.9226, rtol=0.1)
    both = dataclasses.replace(finding, verdict="unexplained")  # the tilt, or none
    assert next_test(both).endswith("times what the noise of the sensors leaves open there.")


def test_tests_that_cannot_tell_most_are_not_run_under_other_noise(monkeypatch):
    """What is proposed is what comes out where each of the tests is judged."""
    finding = found.tilted()
    proposals, noise, models = _proposals(finding), _noise(finding), [finding.before, finding.after]
    simulator = Simulator([p.test for p in proposals])
    read = [
        [a.theta for a in simulator.run([model], [
            Job(0, k, p.test.time, float(p.test.time[0]), p.lean) for k, p in enumerate(proposals)
        ])] for model in models
    ]  # fmt: skip
    apart = np.array([np.sqrt(np.mean(np.clip(a - b, -0.05, 0.05) ** 2)) for a, b in zip(*read, strict=True)])
    again, judged = _again(proposals), []
    every = np.array([
        _left_open(again[k], p, noise, models, [own[k] for own in read]) for k, p in enumerate(proposals)
    ])  # fmt: skip
    monkeypatch.setattr(
        proposing, "_left_open", lambda tests, p, *rest: judged.append(p) or _left_open(tests, p, *rest)
    )
    k, left = _most_telling(finding, models, read, proposals, apart)
    assert k == np.argmax(apart / every) and left == every[k]
    assert 0 < len(judged) < len(proposals)


def test_where_no_test_would_tell_it_says_so():
    finding = dataclasses.replace(found.tilted(), rivals=())
    value = finding.intervals["base_tilt.angle"][0]
    sure = {"base_tilt.angle": (value, value * (1.0 - 1e-9), value * (1.0 + 1e-9))}
    said = next_test(dataclasses.replace(finding, intervals=sure))
    assert "the ends of the interval of Base tilt" in said and "0.0 times what" in said
    assert said.endswith("none tells more.")
