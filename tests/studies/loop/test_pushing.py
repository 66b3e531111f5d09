"""What pushes at the same times of every test is found as a laboratory blows it, and not where something else acts.

Free decays with noise of a laboratory that shares no code with the models; gusts are those of its table.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from released import DECLARED, IDEAL, LEANS, NOISE, STEP, calibrated, still
from scipy.interpolate import BSpline

from rocking.effects.learned_push import course
from studies.campaigns import Channel, Test
from studies.laboratory import event, table
from studies.laboratory.parameters import World
from studies.loop.models.candidates import candidates
from studies.loop.runs.simulation import Simulator
from studies.loop.swings import pushing as pushing_module
from studies.loop.swings.learning import learn
from studies.loop.swings.pushing import _sums, pushing
from studies.loop.swings.tracing import search
from studies.loop.swings.trials import Trial, bic

GUSTS = ((1.1, 0.12, 0.2), (2.9, 0.12, 0.2))  # middle [s], acceleration [m/s^2], width [s]


def decays(
    gusts: Sequence[Sequence[tuple[float, float, float]]], world: World = IDEAL, leans: Sequence[float] = LEANS
) -> tuple[Simulator, Trial]:
    """Releases, each with its gusts, and the calibrated block fitted to their swings."""
    rng, tests = np.random.default_rng(3), []
    zero = np.zeros(1501)
    for k, (lean, blows) in enumerate(zip(leans, gusts, strict=True)):
        air = table.Table(gusts=tuple(blows)).on_top(zero, STEP)
        run = event.simulate(world, table.pieces(STEP, air, zero, (zero, zero, zero)), STEP, 1, lean)
        read = run.rotation + NOISE * rng.standard_normal(run.rotation.size)
        tests.append(Test(f"free-{k}", "free", run.time, (Channel("rotation", "rotation", NOISE),), {"rotation": read}))
    return calibrated(tests)


def shaken(gusts: Sequence[Sequence[tuple[float, float, float]]]) -> tuple[Simulator, Trial]:
    """Releases without gusts, of whose base noise is recorded, and runs on a base that is shaken at 2 Hz with these."""
    rng, tests = np.random.default_rng(5), []
    time, zero = STEP * np.arange(1501), np.zeros(1501)
    channels = Channel("rotation", "rotation", NOISE), Channel("base", "base_acceleration_x", 0.01)
    for k, lean in enumerate(LEANS[:3]):
        run = event.simulate(IDEAL, still(), STEP, 1, lean)
        read = run.rotation + NOISE * rng.standard_normal(run.rotation.size)
        said = {"rotation": read, "base": 0.01 * rng.standard_normal(time.size)}
        tests.append(Test(f"free-{k}", "free", run.time, channels, said))
    for k, blows in enumerate(gusts):
        base = (4.0 + 0.2 * k) * np.sin(4.0 * np.pi * time) * np.minimum(time / 1.5, 1.0)
        air = table.Table(gusts=tuple(blows)).on_top(base, STEP)
        run = event.simulate(IDEAL, table.pieces(STEP, air, zero, (zero, zero, zero)), STEP, 1, 0.0)
        said = {
            "rotation": run.rotation + NOISE * rng.standard_normal(time.size),
            "base": base + 0.01 * rng.standard_normal(time.size),
        }
        tests.append(Test(f"sine-{k}", "forced", run.time, channels, said))
    return calibrated(tests)


def blown(t: np.ndarray) -> np.ndarray:
    """Acceleration of the base that the gusts are as much as [m/s^2]."""
    return -sum((size * np.exp(-0.5 * ((t - middle) / width) ** 2) for middle, size, width in GUSTS), np.zeros_like(t))


def test_gusts_at_the_same_times_are_found() -> None:
    simulator, plain = decays([GUSTS] * len(LEANS))
    [candidate] = pushing(simulator, plain)
    [trial] = search(simulator, plain, [candidate]).trials
    assert trial.swing.rms < 1.02 < 1.3 < plain.swing.rms
    [effect] = [part for part in trial.swing.model.parts if part.name == "learned_push"]
    # A swing shows what a push makes of its speed: the mean of it over half a second, to a twentieth of the greatest.
    t = np.arange(0.0, 4.5, 0.01)
    width = np.hanning(51) / np.hanning(51).sum()
    found, planted = (np.convolve(c, width, "same")[25:-25] for c in (course(effect, t), blown(t)))
    np.testing.assert_allclose(found, planted, rtol=0.0, atol=0.05 * np.max(np.abs(planted)))


@pytest.mark.slow
def test_gusts_are_what_is_learned() -> None:
    simulator, plain = decays([GUSTS] * len(LEANS))
    found = learn(simulator, plain, lambda text: None)
    assert found.names == ("learned[push at the same times]",)


def test_gusts_of_shaking_alone_are_none_of_releases() -> None:
    simulator, plain = shaken([GUSTS] * 5)
    [candidate] = pushing(simulator, plain)
    assert candidate.name == "learned[push at the same times of shaking]"
    [trial] = search(simulator, plain, [candidate]).trials
    assert trial.swing.rms < 1.05 < 1.2 < plain.swing.rms


def test_gusts_at_other_times_in_each_test_are_none_at_the_same() -> None:
    late = [tuple((middle + 0.35 * k, size, width) for middle, size, width in GUSTS) for k in range(len(LEANS))]
    simulator, plain = decays(late)
    assert plain.swing.rms > 1.2
    assert pushing(simulator, plain) == ()


@pytest.mark.parametrize(
    "world",
    [
        pytest.param(IDEAL, id="ideal"),
        pytest.param(replace(IDEAL, viscous=0.1), id="damping"),
    ],
)
def test_what_else_acts_is_no_push(world: World) -> None:
    simulator, plain = decays([()] * len(LEANS), world)
    assert pushing(simulator, plain) == ()


def test_a_push_that_never_ends_is_a_tilt_by_its_name() -> None:
    """A centre of mass that is off the middle turns a block that leans as a constant acceleration does."""
    simulator, plain = decays([()] * len(LEANS), replace(IDEAL, offset=0.002))
    tilt = next(c for c in candidates(DECLARED) if c.name == "eccentric_mass")
    [push] = pushing(simulator, plain)
    by_name, by_time = search(simulator, plain, [tilt, push]).trials
    assert by_name.names == ("eccentric_mass",) and bic(by_name.swing) < bic(by_time.swing) - 100.0


def test_few_tests_say_nothing_of_what_all_have() -> None:
    """Of three tests."""
    simulator, plain = decays([GUSTS] * 3, leans=LEANS[:3])
    assert pushing(simulator, plain) == ()


@pytest.mark.parametrize("halving", [0, 1, 2])
def test_longer_intervals_are_sums_of_short_ones(halving: int) -> None:
    """SciPy's B-splines of either length, from the beginning to where the last swing ends."""
    sums, longer = _sums(40, halving), 2**halving
    t = np.linspace(0.0, 37.0, 500)
    short = np.array([_basis(t - (j - 1)) for j in range(40)])
    for j in range(sums.shape[1]):
        np.testing.assert_allclose(sums[:, j] @ short, _basis(t / longer - (j - 1)), atol=1e-12)
    assert np.all(_basis(t / longer - (sums.shape[1] - 1)) == 0.0)  # of one more there would be nothing


def _basis(x: np.ndarray) -> np.ndarray:
    inside = np.abs(x) < 2.0
    return np.where(inside, BSpline.basis_element(np.arange(-2.0, 3.0))(np.clip(x, -2.0, 2.0)), 0.0)


def test_what_one_test_alone_says_is_not_carried_over() -> None:
    """Normal equations by hand: six tests that say 1 each, or one that says 6 and five that say nothing against it."""
    matrices = np.ones((6, 1, 1))
    assert pushing_module._carries_over(matrices, np.ones((6, 1)), [0], range(6))
    assert not pushing_module._carries_over(matrices, np.array([[6.0], *[[0.0]] * 5]), [0], range(6))


def test_no_more_coefficients_are_chosen_than_are_to_be_fitted_with_those_beside_them(monkeypatch):
    """Of a hundred that say the same each."""
    monkeypatch.setattr(pushing_module, "MOST_PUSHES", 20)
    chosen, _ = pushing_module._chosen(np.eye(100), np.full(100, 10.0), 9.0)
    assert 18 <= len(chosen) <= 20


def test_a_push_is_not_asked_beside_another_one():
    simulator, plain = decays([GUSTS] * len(LEANS))
    [candidate] = pushing(simulator, plain)
    [trial] = search(simulator, plain, [candidate]).trials
    assert pushing(simulator, trial) == ()
