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


def test_the_test_that_tells_most_is_found_without_running_those_that_cannot(monkeypatch):
    """Where noise leaves much open in the test in which models differ most, another one tells more.

    Over the sensor's noise, differences are 5, 4, 3, 2, 1 in the order in which tests are run, and 4, 2, 2 is left open
    in the first three: these tell 1.25, 2 and 1.5, and the last two could tell no more than 2 and 1.
    """
    finding = found.tilted()
    noise, models, read = _noise(finding), [finding.before, finding.after], [[None] * 5] * 2
    proposals = _proposals(finding)[:5]
    by_noise, open_there, judged = [3.0, 1.0, 5.0, 2.0, 4.0], [2.0, 1.0, 4.0, 1.0, 2.0], []

    def left(tests, proposal, *rest):
        k = next(i for i, p in enumerate(proposals) if p is proposal)
        judged.append(k)
        return open_there[k] * noise

    monkeypatch.setattr(proposing, "_left_open", left)
    found_at, open_at = _most_telling(finding, models, read, proposals, noise * np.array(by_noise))
    assert judged == [2, 4, 0]
    assert (found_at, open_at) == (4, 2.0 * noise)


def test_models_that_nowhere_differ_take_one_run(monkeypatch):
    """No test then tells more than the first one, which tells nothing."""
    finding, judged = found.tilted(), []
    proposals = _proposals(finding)[:3]
    monkeypatch.setattr(proposing, "_left_open", lambda tests, p, noise, *rest: judged.append(p) or 2.0 * noise)
    found_at, _ = _most_telling(finding, [finding.after] * 2, [[None] * 3] * 2, proposals, np.zeros(3))
    assert found_at == 0 and len(judged) == 1


def test_what_is_proposed_is_what_judging_every_test_gives():
    finding = found.tilted()
    proposals, noise, models = _proposals(finding), _noise(finding), [finding.before, finding.after]
    simulator = Simulator([p.test for p in proposals])
    read = [
        [a.theta for a in simulator.run([model], [
            Job(0, k, p.test.time, float(p.test.time[0]), p.lean) for k, p in enumerate(proposals)
        ])] for model in models
    ]  # fmt: skip
    apart = np.array([np.sqrt(np.mean(np.clip(a - b, -0.05, 0.05) ** 2)) for a, b in zip(*read, strict=True)])
    again = _again(proposals)
    every = np.array([
        _left_open(again[k], p, noise, models, [own[k] for own in read]) for k, p in enumerate(proposals)
    ])  # fmt: skip
    k, left = _most_telling(finding, models, read, proposals, apart)
    assert k == np.argmax(apart / every) and left == every[k]


def test_where_no_test_would_tell_it_says_so():
    finding = dataclasses.replace(found.tilted(), rivals=())
    value = finding.intervals["base_tilt.angle"][0]
    sure = {"base_tilt.angle": (value, value * (1.0 - 1e-9), value * (1.0 + 1e-9))}
    said = next_test(dataclasses.replace(finding, intervals=sure))
    assert "the ends of the interval of Base tilt" in said and "0.0 times what" in said
    assert said.endswith("none tells more.")
