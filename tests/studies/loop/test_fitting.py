"""Fits over windows: derivatives through impacts, planted parameters, and noise that tells how sure they are.

The records are made with the package's SciPy solver and noise; the fits run on the compiled one.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from excitation import RampedSinusoid
from rocking import Block, Method1, solve
from rocking.effects import load
from studies.campaigns import Channel, DeclaredBlock, Test
from studies.loop.fits.estimating import DISAGREEING, gains, robust_covariance
from studies.loop.fits.fitting import _moved, fit
from studies.loop.fits.linearising import Ends, linearised, slopes
from studies.loop.models.candidates import candidates
from studies.loop.models.model import LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.observed.spread import redrawn
from studies.loop.observed.windows import record_of, swing_windows, whole_windows
from studies.loop.runs.simulation import Job, Simulator
from studies.loop.swings.trials import E

BLOCK = Block(0.2, 0.8, 0.4)
DECLARED = DeclaredBlock(0.2, 0.8, 0.4, BLOCK.mass)
NOISE = 2e-4
TRUE_E, TRUE_C = 0.91, 0.25
DRAG = Parameter("quadratic_drag.coefficient", 0.05, 0.0, 20.0)
ROTATION = Channel("rotation", "rotation", NOISE)
BASE = Channel("base_x", "base_acceleration_x", 0.004)


def campaign(seed: int = 0) -> list[Test]:
    """Three free tests and a forced one of a block with quadratic drag, at 250 Hz."""
    rng = np.random.default_rng(seed)
    system, drag = Method1(BLOCK, restitution=TRUE_E, g=9.81), [load("quadratic_drag")(coefficient=TRUE_C)]
    tests = []
    for k, lean in enumerate((0.15, -0.19, 0.11)):
        t = np.arange(1000) * 0.004
        run = solve(system, theta=lean, t_end=float(t[-1]), save_at=t, effects=drag, solver="scipy")
        data = {"rotation": run.theta + NOISE * rng.standard_normal(t.size)}
        tests.append(Test(f"free-{k}", "free", t, (ROTATION,), data, initial_rotation=lean))
    t = np.arange(1500) * 0.004
    motion = RampedSinusoid(3.0, 6.0, 6.0)
    run = solve(system, motion, t_end=float(t[-1]), save_at=t, effects=drag, solver="scipy")
    data = {
        "rotation": run.theta + NOISE * rng.standard_normal(t.size),
        "base_x": motion(t)[0] + 0.004 * rng.standard_normal(t.size),
    }
    tests.append(Test("ramp", "forced", t, (ROTATION, BASE), data))
    return tests


@pytest.fixture(scope="module")
def tests() -> list[Test]:
    return campaign()


@pytest.fixture(scope="module")
def simulator(tests: list[Test]) -> Simulator:
    return Simulator(tests)


@pytest.fixture(scope="module")
def windows(tests: list[Test]) -> list:
    records = [record_of(test, k, NOISE, DECLARED.alpha) for k, test in enumerate(tests)]
    return swing_windows([r for r in records if r is not None])


def model(c: float, e: float = TRUE_E) -> LoopModel:
    return LoopModel(DECLARED, e, {"quadratic_drag": {"coefficient": c}}, 9.81)


# The compiled runs of windows against the solver that shares no code with them, at the looser tolerance.
def test_a_run_of_the_simulator_is_that_of_the_scipy_solver(tests: list[Test], simulator: Simulator) -> None:
    [answer] = simulator.run([model(TRUE_C)], [Job(0, 0, tests[0].time, 0.0, 0.15)])
    truth = solve(
        Method1(BLOCK, restitution=TRUE_E, g=9.81), theta=0.15, t_end=float(tests[0].time[-1]), save_at=tests[0].time,
        effects=[load("quadratic_drag")(coefficient=TRUE_C)], solver="scipy",
    )  # fmt: skip
    np.testing.assert_allclose(answer.theta, truth.theta, rtol=0.0, atol=1e-6)


# Sensitivities go through the impact in each window: two steps a hundred times apart must tell the same slope.
def test_derivatives_through_impacts_do_not_depend_on_the_step(
    simulator: Simulator, windows: list, monkeypatch: pytest.MonkeyPatch
) -> None:
    from studies.loop.fits import linearising

    fine = linearised(simulator, model(TRUE_C), [E, DRAG], windows[:6])
    monkeypatch.setattr(linearising, "STEP", 2e-2)
    coarse = linearised(simulator, model(TRUE_C), [E, DRAG], windows[:6])
    for a, b in zip(fine.by_parameters, coarse.by_parameters, strict=True):
        np.testing.assert_allclose(a, b, rtol=0.0, atol=0.01 * float(np.abs(b).max()))


# By hand: three windows, moved by 0.1 to both sides.  The first is straight; the second goes another way above, the
# third to both sides, so that the chord of the two is the smallest slope.
def test_where_a_window_goes_another_way_to_one_side_the_smallest_slope_counts() -> None:
    def run(*readings: float) -> list[np.ndarray]:
        return [np.array([x, 0.0]) for x in readings]

    r = [run(1.0, 1.0, 1.0), run(1.2, 9.0, 9.0), run(0.8, 0.7, 9.1)]
    two_sided, one_sided = [Ends(1, 2, 0.2, 0.1)], [Ends(1, 0, 0.1, 0.1)]
    assert [float(a[0, 0]) for a in slopes(r, two_sided)] == pytest.approx([2.0, 41.5, -0.5])
    assert [float(a[0, 0]) for a in slopes(r, two_sided, cautious=True)] == pytest.approx([2.0, 3.0, -0.5])
    assert [float(a[0, 0]) for a in slopes(r, one_sided, cautious=True)] == pytest.approx([2.0, 80.0, 80.0])
    # Slopes of 2 and 2.9 differ by less than half of the smaller one, 2 and 3.2 by more.
    bent = [run(0.0, 0.0), run(0.2, 0.2), run(-0.29, -0.32)]
    assert [float(a[0, 0]) for a in slopes(bent, two_sided, cautious=True)] == pytest.approx([2.45, 2.0])
    # To a side that is cut short by a bound the distance is what is left.
    uneven = [Ends(1, 2, 0.15, 0.05)]
    assert float(slopes([run(1.0), run(1.1), run(0.0)], uneven, cautious=True)[0][0, 0]) == pytest.approx(2.0)


def test_planted_restitution_and_drag_are_recovered_within_their_intervals(
    simulator: Simulator, tests: list[Test], windows: list
) -> None:
    found = fit(simulator, model(0.05, 0.88), [E, DRAG], windows)
    assert found.converged
    # The states at the starts take up some of the noise: two of some forty samples in each window.
    assert 0.93 < found.rms < 1.02
    spread = robust_covariance(simulator, redrawn(tests, np.array([0.0, 0.0, 0.0, 0.004])), found)
    for k, truth in enumerate((TRUE_E, TRUE_C)):
        value = list(found.values.values())[k]
        # Four standard deviations: one draw of the noise, and a bound that chance passes once in ten thousand.
        assert abs(value - truth) < 4.0 * math.sqrt(spread[k, k])
        assert math.sqrt(spread[k, k]) < 0.05 * truth


def test_the_score_of_a_missing_effect_is_what_its_refit_gains(simulator: Simulator, windows: list) -> None:
    plain = fit(simulator, LoopModel(DECLARED, 0.9, {}, 9.81), [E], windows, huber=math.inf, tolerance=1e-8)
    absent = plain.model.changed({DRAG.name: 0.0})
    # Without the weights of Huber the sum of squares is nearly a parabola: score and refit agree.
    score = gains(simulator, plain, {"drag": [DRAG]}, {"drag": absent}, huber=math.inf)["drag"]
    refit = fit(simulator, absent.changed({DRAG.name: 0.1}), [E, DRAG], plain.windows, huber=math.inf, tolerance=1e-8)
    assert plain.chi2 - refit.chi2 > 1000.0
    assert score == pytest.approx(plain.chi2 - refit.chi2, rel=0.05)


def test_the_lean_of_a_free_test_is_fitted_about_what_the_record_says(simulator: Simulator, tests: list[Test]) -> None:
    records = [record_of(test, k, NOISE, DECLARED.alpha) for k, test in enumerate(tests)]
    whole = whole_windows([r for r in records if r is not None])
    found = fit(simulator, model(TRUE_C), [], whole, huber=math.inf, iterations=5)
    leans = [w.theta for w in found.windows[:3]]
    np.testing.assert_allclose(leans, [0.15, -0.19, 0.11], rtol=0.0, atol=5e-5)
    assert found.windows[3].theta == 0.0  # a forced test starts at rest
    assert found.rms == pytest.approx(1.0, abs=0.15)


# A record of a block that loses far more (as if it had slid): 3 of 4 whole records say what the drag is.
def test_one_whole_record_that_is_lost_does_not_move_what_the_others_say(tests: list[Test]) -> None:
    t = tests[1].time
    other = solve(Method1(BLOCK, restitution=0.8, g=9.81), theta=-0.19, t_end=float(t[-1]), save_at=t, solver="scipy")
    spoilt = [tests[0], replace(tests[1], data={"rotation": other.theta}), *tests[2:]]
    records = [record_of(test, k, NOISE, DECLARED.alpha) for k, test in enumerate(spoilt)]
    whole = whole_windows([r for r in records if r is not None])
    robust = fit(Simulator(spoilt), model(0.24), [DRAG], whole, whole=True)
    assert robust.by_window[1] > 50.0 and np.delete(robust.by_window, 1).max() < 1.2
    assert robust.values[DRAG.name] == pytest.approx(TRUE_C, abs=0.01)
    squares = fit(Simulator(spoilt), model(0.24), [DRAG], whole, huber=math.inf)
    assert abs(squares.values[DRAG.name] - TRUE_C) > 0.1
    # Where all records are explained it is the sum of squares.
    whole = whole_windows([record_of(test, k, NOISE, DECLARED.alpha) for k, test in enumerate(tests)])
    met = fit(Simulator(tests), model(TRUE_C), [], whole, whole=True)
    plain = fit(Simulator(tests), met.model, [], met.windows, huber=math.inf, iterations=0)
    assert met.chi2 == pytest.approx(plain.chi2, rel=1e-12)


# A drag that is not fitted pulls the four records' restitution apart: what it is known to is how far they disagree.
def test_records_that_disagree_widen_the_covariance(simulator: Simulator, tests: list[Test], windows: list) -> None:
    right, lacking = fit(simulator, model(TRUE_C), [E], windows), fit(simulator, model(0.0), [E], windows)
    noisy = redrawn(tests, np.array([0.0, 0.0, 0.0, 0.004]))
    narrow, wide = (math.sqrt(robust_covariance(simulator, noisy, f)[0, 0]) for f in (right, lacking))
    assert right.spread < DISAGREEING < lacking.spread
    assert wide > 3.0 * narrow
    by_record = [
        fit(simulator, model(0.0), [E], [w for w in windows if w.record == k]).values["restitution"] for k in range(4)
    ]
    assert wide == pytest.approx(np.std(by_record, ddof=1) / 2.0, rel=0.7)


# Nothing locates an event on a floor that gives: the slopes that a fit takes against those of runs a hundred times as
# accurate by a tenth of the step.
def test_slopes_on_a_soft_floor_are_not_those_of_the_steps_of_a_run(
    tests: list[Test], windows: list, monkeypatch: pytest.MonkeyPatch
) -> None:
    from studies.loop.runs import simulation

    for floor in (c for c in candidates(DECLARED) if c.costly):
        start = LoopModel(DECLARED, TRUE_E, {}, 9.81).changed({**floor.fixed, **floor.starts[2]})
        usual = linearised(Simulator(tests), start, floor.parameters, windows[:6])
        with monkeypatch.context() as finely:
            finely.setattr(simulation, "RTOL", 0.01 * simulation.RTOL)
            finely.setattr(simulation, "ATOL", 0.01 * simulation.ATOL)
            tenth = [replace(p, coarser=0.1 * p.coarser) for p in floor.parameters]
            fine = linearised(Simulator(tests), start, tenth, windows[:6])
        for a, b in zip(usual.by_parameters, fine.by_parameters, strict=True):
            # A unit is what a scale of the parameter changes, over the noise: 0.05 of it is never seen.
            np.testing.assert_allclose(a, b, rtol=0.0, atol=0.05 * float(np.abs(b).max()) + 0.05, err_msg=floor.name)


class Counting(Simulator):
    """Counts its runs by test."""

    def run(self, models, jobs):
        self.runs = [*getattr(self, "runs", []), *(job.test for job in jobs)]
        return super().run(models, jobs)


# Of a release the lean is known to its noise and the speed is nothing, of a shaken test both are nothing.  By hand: a
# fit of states alone that changes nothing any more asks once, then for one slope to both sides, and tries one step.
def test_what_is_known_of_a_state_is_not_varied(tests: list[Test]) -> None:
    records = [r for k, test in enumerate(tests) if (r := record_of(test, k, NOISE, DECLARED.alpha)) is not None]
    windows = whole_windows(records)
    assert [(w.theta_sd > 0.0, w.omega_sd > 0.0) for w in windows] == [(True, False)] * 3 + [(False, False)]
    counting = Counting(tests)
    lin = linearised(counting, model(0.1), [DRAG], windows)
    # At the point, to both sides of the drag, and of the lean where it is free.
    assert [counting.runs.count(k) for k in range(4)] == [5, 5, 5, 3]
    assert np.all(lin.by_state[3] == 0.0) and np.all(lin.by_state[0][:, 1] == 0.0)
    step = 2e-6
    up, down = (counting.run([model(0.1)], [Job(0, 0, w.times, w.start, w.theta + d, 0.0)])[0].theta
                for w in windows[:1] for d in (step, -step))  # fmt: skip
    slope = -(up - down)[windows[0].index] / (2.0 * step) * windows[0].weights
    assert lin.by_state[0][:, 0] == pytest.approx(slope, rel=1e-9, abs=1e-6)
    settled = fit(counting, model(TRUE_C), [], windows, whole=True, iterations=20, tolerance=0.0, central=True)
    counting.runs = []
    again = fit(counting, model(TRUE_C), [], settled.windows, whole=True, iterations=8, tolerance=0.0, central=True)
    assert again.converged and again.chi2 == pytest.approx(settled.chi2, rel=1e-9)
    assert counting.runs.count(3) == 1


def test_a_step_moves_a_logarithm_only_so_far() -> None:
    """By hand: four scales of 0.5 are a factor of exp(2); the bounds are nearer than that downwards."""
    ratio = Parameter("compliant_base.tangential_ratio", 0.5, 5.0, 1e3, True)
    floor = LoopModel(DECLARED, TRUE_E, {"compliant_base": {"corner_stiffness": 1e7, "tangential_ratio": 20.0}}, 9.81)
    assert _moved(floor, [ratio], np.array([50.0])) == {ratio.name: pytest.approx(20.0 * math.exp(2.0))}
    assert _moved(floor, [ratio], np.array([-50.0])) == {ratio.name: 5.0}
    assert _moved(floor, [ratio], np.array([1.0])) == {ratio.name: pytest.approx(20.0 * math.exp(0.5))}
    assert _moved(model(0.1), [DRAG], np.array([50.0])) == {DRAG.name: pytest.approx(2.6)}
