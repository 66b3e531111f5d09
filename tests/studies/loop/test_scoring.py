"""Errors on whole tests where the rotation sensor is not ideal: leans at release are what was read, not what it was.

Decays of the laboratory, whose rotations a sensor of our own turns into readings; noise is its only other error.
"""

import math
from dataclasses import replace
from functools import cache

import found
import numpy as np
import pytest

from rocking import Method1, solve
from studies.campaigns import Campaign, Channel, Conditions, DeclaredBlock, Test
from studies.laboratory import event, table
from studies.laboratory.parameters import G, uniform
from studies.loop.fits.fitting import fit_records
from studies.loop.fits.linearising import linearised
from studies.loop.models.model import LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.records.preparing import Setup, prepare
from studies.loop.records.scoring import errors, leaning
from studies.loop.swings.trials import E

BREADTH, HEIGHT, MASS, RESTITUTION, NOISE, STEP = 0.2, 0.6, 30.0, 0.93, 1e-4, 0.004
DECLARED = DeclaredBlock(BREADTH, HEIGHT, 0.25, MASS)
LEANS = (0.26, -0.24, 0.21, -0.18, 0.15, -0.12)  # rad
IDEAL = LoopModel(DECLARED, RESTITUTION, {}, G)
SENSORS = {
    "none": ({}, lambda theta: theta),
    "gain": ({"rotation_gain": {"gain": 1.02}}, lambda theta: 1.02 * theta),
    "offset": ({"rotation_offset": {"offset": 2e-3}}, lambda theta: theta + 2e-3),
    "bend": ({"learned_reading": {"cubic": 0.4}}, lambda theta: theta + 0.4 * theta**3),
}


@cache
def read_by(sensor: str) -> Setup:
    rng, tests, zero = np.random.default_rng(1), [], np.zeros(1501)
    world, channel = uniform(BREADTH, HEIGHT, MASS, RESTITUTION), Channel("rotation", "rotation", NOISE)
    for k, lean in enumerate(LEANS):
        run = event.simulate(world, table.pieces(STEP, zero, zero, (zero, zero, zero)), STEP, 1, lean)
        read = SENSORS[sensor][1](run.rotation) + NOISE * rng.standard_normal(run.rotation.size)
        tests.append(Test(f"free-{k}", "free", run.time, (channel,), {"rotation": read}, initial_rotation=lean))
    campaign = Campaign("decays", DECLARED, Conditions(restitution=RESTITUTION), (channel,), tuple(tests))
    return prepare(campaign, IDEAL)


@pytest.mark.parametrize("sensor", ["gain", "offset", "bend"])
def test_the_true_model_misses_what_it_never_saw_as_with_an_ideal_sensor(sensor: str) -> None:
    """The noise, and what the noise of the lean grows to over 6 s: 1.6 times the noise with any of the sensors."""
    by_ideal = errors(read_by("none"), IDEAL, read_by("none").whole)
    assert by_ideal.holdout < 2.0 * NOISE
    setup = read_by(sensor)
    true = LoopModel(DECLARED, RESTITUTION, SENSORS[sensor][0], G)
    whole = fit_records(setup.simulator, true, [], setup.whole, iterations=4)
    found = errors(setup, true, whole.windows)
    assert found.fit == pytest.approx(NOISE, rel=0.05)
    assert found.holdout == pytest.approx(by_ideal.holdout, rel=0.05)
    assert errors(setup, IDEAL, setup.whole).holdout > 20.0 * NOISE
    # What is known of the leans agrees with the rest: it adds no more than chance, a few units for each record.
    plain = sum(float(r @ r) for r in whole.residuals)
    assert whole.chi2 - plain < 5.0 * len(whole.windows)


@pytest.mark.parametrize("sensor", ["gain", "offset", "bend"])
def test_whole_records_find_the_sensor_though_their_leans_were_read_by_it(sensor: str) -> None:
    setup, [(effect, [(name, value)])] = read_by(sensor), [(k, [*v.items()]) for k, v in SENSORS[sensor][0].items()]
    absent = {"gain": 1.0}.get(sensor, 0.0)
    p = Parameter(f"{effect}.{name}", {"gain": 0.01, "offset": 1e-3, "bend": 0.1}[sensor])
    start = IDEAL.changed({p.name: 0.5 * (absent + value)})
    found = fit_records(setup.simulator, start, [E, p], setup.whole, iterations=12)
    assert found.model.get(p.name) == pytest.approx(value, abs=0.02 * abs(value - absent))
    leans = [LEANS[w.test] for w in found.windows]
    np.testing.assert_allclose([w.theta for w in found.windows], leans, rtol=0.0, atol=1e-4)


def test_the_prior_of_a_lean_has_the_derivatives_of_the_reading() -> None:
    """By hand: reading g theta + o, residual (prior - reading) / sd."""
    setup = read_by("gain")
    model = LoopModel(DECLARED, RESTITUTION, {"rotation_gain": {"gain": 1.02}, "rotation_offset": {"offset": 1e-3}}, G)
    parameters = [Parameter("rotation_gain.gain", 0.01), E, Parameter("rotation_offset.offset", 1e-3)]
    found = linearised(setup.simulator, model, parameters, setup.whole)
    for w, prior in zip(setup.whole, found.priors, strict=True):
        assert prior is not None
        assert prior.residual == pytest.approx((w.theta_prior - 1.02 * w.theta - 1e-3) / w.theta_sd, rel=1e-9)
        assert prior.by_theta == pytest.approx(-1.02 / w.theta_sd, rel=1e-9)
        expected = [-0.01 * w.theta / w.theta_sd, 0.0, -1e-3 / w.theta_sd]
        assert prior.by_parameters == pytest.approx(expected, rel=1e-6, abs=1e-6)
    assert linearised(setup.simulator, model, parameters, setup.swings[:2]).priors == [None, None]


def test_a_lean_that_was_aimed_at_is_a_rotation_and_no_reading() -> None:
    """The sensor says nothing in the first tenth of a second."""
    setup = read_by("gain")
    tests = [
        replace(t, data={"rotation": np.where(t.time < 0.15, np.nan, t.data["rotation"])}) for t in setup.campaign.tests
    ]
    silent = prepare(replace(setup.campaign, tests=tuple(tests)), IDEAL)
    model = LoopModel(DECLARED, RESTITUTION, SENSORS["gain"][0], G)
    p = Parameter("rotation_gain.gain", 0.01)
    [prior, *_] = linearised(silent.simulator, model, [p], silent.whole).priors
    first = silent.whole[0]
    assert prior is not None and not first.lean_read
    assert first.theta_prior == LEANS[first.test]
    assert prior.residual == 0.0 and prior.by_parameters == pytest.approx([0.0])
    assert prior.by_theta == pytest.approx(-1.0 / first.theta_sd)
    assert [w.theta for w in leaning(silent, model, silent.whole_held)] == [LEANS[w.test] for w in silent.whole_held]
    read = leaning(setup, model, setup.whole_held)
    assert [w.theta for w in read] == pytest.approx([LEANS[w.test] for w in read], abs=1e-4)


def test_the_claimed_error_is_what_the_model_scores_on_the_tests_held_out() -> None:
    """By SciPy's solver, from the lean that the record begins with: a claim is a score, and no estimate of one."""
    finding = found.tilted()
    claimed, setup = finding.errors["after"], finding.setup
    (window,) = leaning(setup, finding.after, setup.whole_held)
    test = setup.campaign.tests[window.test]
    assert test.id not in {setup.campaign.tests[w.test].id for w in (*setup.swings, *setup.whole)}
    system = Method1(found.BLOCK, restitution=finding.after.restitution, g=finding.after.g)
    run = solve(
        system, theta=window.theta, t_end=float(test.time[-1]), save_at=test.time, effects=finding.after.parts,
        solver="scipy", rtol=1e-10, atol=1e-13,
    )  # fmt: skip
    scored = math.sqrt(np.mean((run.theta - test.rotation) ** 2))
    assert claimed.by_test[test.id] == pytest.approx(scored, rel=1e-4)
    assert claimed.holdout == claimed.by_test[test.id]
