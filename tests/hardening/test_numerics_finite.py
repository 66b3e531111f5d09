"""No answer that is no number without a reason: hundreds of random blocks and motions, far beyond what is built.

NaN is what the results document it for: no fall has no time, a block that never moved has no onset.  Everything else is
finite, and a run that fails says why.
"""

import math
from typing import Any

import numpy as np
import pytest

import dem
from excitation import PiecewiseLinear, RampedSinusoid
from rocking import Block, Method1, Method2, Outcome, solve, solve_batch

G = 9.80665


def random_block(rng: np.random.Generator) -> Block:
    """b/h from 0.02 to 5, the longer side from a millimetre to a hundred metres."""
    ratio, size = 10.0 ** rng.uniform(math.log10(0.02), math.log10(5.0)), 10.0 ** rng.uniform(-3.0, 2.0)
    return Block(size * min(1.0, ratio), size * min(1.0, 1.0 / ratio))


def random_motion(rng: np.random.Generator, block: Block) -> Any:
    """A ramped sine or jagged samples, from a hundredth to a hundred times what starts rocking; one in ten is still."""
    p, amplitude = block.p(), block.b / block.h * G * 10.0 ** rng.uniform(-2.0, 2.0)
    if rng.random() < 0.5:
        return RampedSinusoid(p * 10.0 ** rng.uniform(-1.0, 1.0) / (2.0 * math.pi), 10.0 / p, amplitude)
    still = rng.random() < 0.2
    return PiecewiseLinear(0.3 / p, (0.0 if still else amplitude) * rng.standard_normal(30))


def random_system(rng: np.random.Generator, block: Block, kind: str) -> Any:
    if kind != "method2":
        return Method1(block, form=kind, restitution=[None, 0.0, 0.9, 1.0][rng.integers(4)])  # type: ignore[arg-type]
    law: Any = {"normal_restitution": [0.0, 0.3, 0.9][rng.integers(3)], "chatter_time": 1e-4 / block.p()}
    law["tangential_restitution"] = [-1.0, 0.0, 0.5][rng.integers(3)]
    if rng.random() < 0.2:
        law |= {"impact_law": "kinematic", "normal_restitution": 0.3, "tangential_restitution": 0.0}
    return Method2(block, [0.0, 0.1, 0.5, 1.3][rng.integers(4)], **law)


KINDS = [("nonlinear", "numba"), ("nonlinear", "taylor"), ("linear", "numba"), ("linear", "taylor"),
         ("linear", "exact"), ("method2", "numba")]  # fmt: skip


@pytest.mark.parametrize(("kind", "solver"), KINDS)
def test_every_number_of_a_run_is_finite_and_every_nan_is_what_it_says(kind: str, solver: str) -> None:
    rng = np.random.default_rng(20)
    outcomes = set()
    for _ in range(150):
        block = random_block(rng)
        system, motion = random_system(rng, block, kind), random_motion(rng, block)
        theta = float(rng.uniform(-0.95, 0.95) * block.alpha) if rng.random() < 0.5 else 0.0
        run = solve(system, motion, t_end=15.0 / block.p(), theta=theta, solver=solver, max_events=20_000)
        case = f"{system}, {motion!r}, theta={theta}: {run}"
        assert run.outcome is not Outcome.FAILED, case
        for values in (run.y, run.events.t, run.events.y_after, run.events.y_before, [run.peak_rotation, run.t_end]):
            assert np.all(np.isfinite(values)), case
        assert math.isnan(run.overturning_time) == (not run.overturned), case
        if theta == 0.0:
            assert math.isnan(run.onset_time) == (len(run.events) == 0), case
        outcomes.add(run.outcome)
    assert outcomes == {Outcome.OVERTURNED, Outcome.AT_REST, Outcome.MOVING}


@pytest.mark.parametrize(("kind", "solver"), KINDS)
def test_every_number_of_a_batch_is_finite_and_every_nan_is_what_it_says(kind: str, solver: str) -> None:
    rng = np.random.default_rng(21)
    blocks = [random_block(rng) for _ in range(200)]
    systems = [random_system(rng, block, kind) for block in blocks]
    motions = [random_motion(rng, block) for block in blocks]
    kept = [i for i, m in enumerate(motions) if isinstance(m, RampedSinusoid)]
    batch = solve_batch([systems[i] for i in kept], [motions[i] for i in kept], t_end=5.0, solver=solver)
    assert not np.any(batch.outcome == 3)
    assert np.all(np.isfinite(batch.peak_rotation)) and np.all(np.isfinite(batch.t_end))
    np.testing.assert_array_equal(np.isnan(batch.overturning_time), ~batch.overturned)
    if kind == "method2":  # which may slide without a tilt
        assert not np.any(np.isnan(batch.onset_time) & (batch.peak_rotation > 0.0))
    else:
        np.testing.assert_array_equal(np.isnan(batch.onset_time), batch.peak_rotation == 0.0)


# Distinct elements: springs that the weight presses in by 1e-5 of the shorter side, half of the critical step; a block
# released from a third of its balance lands, to what such a floor gives way, when its energy says.
@pytest.mark.parametrize("ratio", [0.02, 0.2, 1.0, 1.5, 5.0])
@pytest.mark.parametrize("size", [1e-3, 1.0, 100.0])
def test_distinct_elements_of_any_size_stay_finite_and_move_alike(ratio: float, size: float) -> None:
    runs = []
    for length in (1.0, size):
        b, h = length * min(1.0, ratio), length * min(1.0, 1.0 / ratio)
        scene = dem.single_block(b, h, length, 597.0)
        k = scene.mass * G / (1e-5 * min(b, h))
        damping = 0.5 * math.sqrt(k * scene.mass)
        dt = 0.5 * dem.critical_step(scene, k, k, damping)
        runs.append(
            dem.simulate(
                scene, t_end=2000 * dt, dt=dt, kn=k, ks=k, mu=0.6, damping=damping, theta0=0.3 * math.atan2(b, h),
                save_every=100,
            )
        )  # fmt: skip
    for run in runs:
        for values in (run.x, run.z, run.theta, run.omega):
            assert np.all(np.isfinite(values))
    # Froude: steps are those of the time scale, so the same rotation step by step, to the rounding of 2000 of them.
    np.testing.assert_allclose(runs[1].theta, runs[0].theta, rtol=0.0, atol=1e-9)
    assert np.abs(runs[0].theta[-1] - runs[0].theta[0]) > 0.0
