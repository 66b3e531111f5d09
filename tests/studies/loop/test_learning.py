"""What no candidate explains is learned as it was planted, by the laboratory that shares no code with the models.

Free decays from both sides, with noise; the truth of each is a number of the laboratory's world.
"""

from dataclasses import replace

import numpy as np
import pytest

from rocking.effects.learned_curve import ODD, curve, numbers
from rocking.remembering import LONG_AGO
from studies.campaigns import Channel, DeclaredBlock, Test
from studies.laboratory import event, table
from studies.laboratory.parameters import G, World, uniform
from studies.loop.learning import learn, memories, profiles
from studies.loop.model import LoopModel
from studies.loop.observing import jobs_of
from studies.loop.simulation import Simulator
from studies.loop.tracing import Trial, baseline
from studies.loop.windows import record_of, swing_windows

BREADTH, HEIGHT, MASS, E, NOISE, STEP = 0.2, 0.6, 30.0, 0.93, 1e-4, 0.004
DECLARED = DeclaredBlock(BREADTH, HEIGHT, 0.25, MASS)
IDEAL = uniform(BREADTH, HEIGHT, MASS, E)
LEANS = (0.26, -0.24, 0.21, -0.18, 0.15, -0.12)  # rad


def still():
    """A floor that does not move, for 6 s."""
    zero = np.zeros(1501)
    return table.pieces(STEP, zero, zero, (zero, zero, zero))


def decays(world: World) -> tuple[Simulator, Trial]:
    """Six releases, and the calibrated block fitted to their swings."""
    rng, tests = np.random.default_rng(1), []
    for k, lean in enumerate(LEANS):
        run = event.simulate(world, still(), STEP, 1, lean)
        read = run.rotation + NOISE * rng.standard_normal(run.rotation.size)
        tests.append(Test(f"free-{k}", "free", run.time, (Channel("rotation", "rotation", NOISE),), {"rotation": read}))
    records = [record_of(test, k, NOISE, DECLARED.alpha) for k, test in enumerate(tests)]
    simulator = Simulator(tests)
    windows = swing_windows([record for record in records if record is not None])
    return simulator, baseline(simulator, LoopModel(DECLARED, E, {}, G), windows)


def learned(world: World) -> Trial:
    simulator, plain = decays(world)
    assert plain.swing.rms > 1.3
    found = learn(simulator, plain, lambda text: None)
    # Two states are fitted to each window: what is left of pure noise is below it.
    assert found.swing.rms < 1.01
    return found


@pytest.mark.slow
def test_a_torque_that_is_periodic_in_the_rotation_is_drawn_as_it_was() -> None:
    """0.5 sin(2 pi phi / 0.08) rad/s^2: a cable over ribs."""
    found = learned(replace(IDEAL, rib=0.5, rib_period=0.08))
    assert found.parts[0].effect == "learned_curve"
    given = found.swing.model.effects["learned_curve"]
    n = int(given["odd_intervals"])
    own = numbers(given["odd_reach"], tuple(given[name] for name in ODD[: n + 1]))
    phi = np.linspace(0.02, 0.24, 100)
    # Of a sine over five intervals a natural spline leaves a few per cent; noise adds some.
    np.testing.assert_allclose(curve(np, phi, own, 0), 0.5 * np.sin(2.0 * np.pi * phi / 0.08), rtol=0.0, atol=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("planted", "depth", "span", "true"),
    [
        ({"bedding": 0.03}, "first", "first_impacts", (-0.03, 4.0)),
        ({"leak": 0.05, "leak_time": 0.15}, "recent", "recent_time", (-0.05, 0.15)),
    ],
)
def test_a_restitution_that_remembers_is_learned(
    planted: dict[str, float], depth: str, span: str, true: tuple[float, float]
) -> None:
    found = learned(replace(IDEAL, **planted))
    assert found.parts[0].effect == "learned_memory"
    values = found.swing.model.effects["learned_memory"]
    assert values[depth] == pytest.approx(true[0], rel=0.15)
    assert values[span] == pytest.approx(true[1], rel=0.25)


def test_a_window_knows_the_impacts_before_it() -> None:
    simulator, plain = decays(IDEAL)
    of_first = [w for w in plain.swing.windows if w.record == 0]
    assert [w.struck.impacts for w in of_first[:3]] == [0, 1, 2]
    assert of_first[0].struck.pause == LONG_AGO
    first = event.simulate(IDEAL, still(), STEP, 1, LEANS[0]).impacts[0, 0]
    assert of_first[1].struck.pause == pytest.approx(of_first[1].start - first, abs=2e-3)
    # The calibrated block explains what has no effect: nothing is learned.
    assert learn(simulator, plain, lambda text: None) is plain


def test_what_may_be_learned_is_nothing_at_first() -> None:
    """Every curve and memory, at its absent values, leaves the run as it was."""
    simulator, plain = decays(IDEAL)
    job = jobs_of(plain.swing.windows[:1], 0)
    ideal = simulator.run([plain.swing.model], job)[0].theta
    for candidate in (*profiles(DECLARED, plain.swing.windows), *memories(DECLARED)):
        model = plain.swing.model.changed(candidate.absent(DECLARED))
        assert model.parts
        np.testing.assert_allclose(simulator.run([model], job)[0].theta, ideal, rtol=0.0, atol=1e-8)
