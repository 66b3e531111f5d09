"""Releases of the laboratory's block, which shares no code with the models, and the calibrated block fitted to them."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from studies.campaigns import Channel, DeclaredBlock, Test
from studies.laboratory import event, table
from studies.laboratory.parameters import G, World, uniform
from studies.loop.models.model import LoopModel
from studies.loop.observed.windows import in_order, record_of, swing_windows
from studies.loop.runs.simulation import Simulator
from studies.loop.swings.tracing import baseline
from studies.loop.swings.trials import Trial

BREADTH, HEIGHT, MASS, E, NOISE, STEP = 0.2, 0.6, 30.0, 0.93, 1e-4, 0.004
DECLARED = DeclaredBlock(BREADTH, HEIGHT, 0.25, MASS)
IDEAL = uniform(BREADTH, HEIGHT, MASS, E)
LEANS = (0.26, -0.24, 0.21, -0.18, 0.15, -0.12)  # rad


def still():
    """A floor that does not move, for 6 s."""
    zero = np.zeros(1501)
    return table.pieces(STEP, zero, zero, (zero, zero, zero))


def nothing(theta: np.ndarray) -> np.ndarray:
    return np.zeros(theta.size)


def decays(
    world: World, added: Callable[[np.ndarray], np.ndarray] = nothing, gained: Sequence[float] = (0.0,) * len(LEANS)
) -> tuple[Simulator, Trial]:
    """Six releases, and the calibrated block fitted to their swings.

    added: what the sensor adds to a rotation [rad]; gained: what each test has beyond the restitution of the world.
    """
    rng, tests, used = np.random.default_rng(1), [], 0.0
    for k, lean in enumerate(LEANS):
        now = replace(world, restitution=world.restitution + gained[k], used=used)
        run = event.simulate(now, still(), STEP, 1, lean)
        used += float(np.sum(run.impacts[:, 1] ** 2))
        read = run.rotation + added(run.rotation) + NOISE * rng.standard_normal(run.rotation.size)
        tests.append(Test(f"free-{k}", "free", run.time, (Channel("rotation", "rotation", NOISE),), {"rotation": read}))
    return calibrated(tests)


def calibrated(tests: Sequence[Test]) -> tuple[Simulator, Trial]:
    records = [record_of(test, k, NOISE, DECLARED.alpha) for k, test in enumerate(tests)]
    simulator = Simulator(tests)
    windows = swing_windows(in_order([record for record in records if record is not None], DECLARED))
    return simulator, baseline(simulator, LoopModel(DECLARED, E, {}, G), windows)
