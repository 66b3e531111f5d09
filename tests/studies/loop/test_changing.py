"""What changes from test to test is found as it was planted, by the laboratory that shares no code with the models.

Free decays from both sides, with noise; the truth of each is a number of the laboratory's world in each test.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from studies.campaigns import Channel, DeclaredBlock, Test
from studies.laboratory import event, table
from studies.laboratory.parameters import G, World, uniform
from studies.loop.fits.estimating import gains, gains_of_changes, sensor_covariance
from studies.loop.models.candidates import candidates
from studies.loop.models.model import CHANGE, LoopModel
from studies.loop.observed.windows import in_order, record_of, swing_windows, uses
from studies.loop.runs.simulation import Simulator
from studies.loop.swings.changing import LEAST_TESTS, changing, courses
from studies.loop.swings.learning import by_itself, learn
from studies.loop.swings.tracing import baseline, search
from studies.loop.swings.trials import Trial

BREADTH, HEIGHT, MASS, E, NOISE, STEP = 0.2, 0.6, 30.0, 0.93, 1e-4, 0.004
DECLARED = DeclaredBlock(BREADTH, HEIGHT, 0.25, MASS)
IDEAL = uniform(BREADTH, HEIGHT, MASS, E)
LEANS = (0.26, -0.24, 0.21, -0.18, 0.15, -0.12, 0.22)  # rad
NAMED = tuple(c for c in candidates(DECLARED) if not c.costly)


def as_ever(number: int) -> World:
    return IDEAL


def by_one(number: int) -> float:
    return 1.0


def decays(
    world: Callable[[int], World] = as_ever, gain: Callable[[int], float] = by_one, leans: tuple[float, ...] = LEANS
) -> tuple[Simulator, Trial]:
    """Releases, and the calibrated block fitted to their swings.

    world, gain: the laboratory, and the gain of its rotation sensor, in each test.
    """
    rng, tests = np.random.default_rng(1), []
    zero = np.zeros(1501)
    still = table.pieces(STEP, zero, zero, (zero, zero, zero))
    for k, lean in enumerate(leans):
        run = event.simulate(world(k), still, STEP, 1, lean)
        read = gain(k) * run.rotation + NOISE * rng.standard_normal(run.rotation.size)
        tests.append(Test(f"free-{k}", "free", run.time, (Channel("rotation", "rotation", NOISE),), {"rotation": read}))
    records = [record_of(test, k, NOISE, DECLARED.alpha) for k, test in enumerate(tests)]
    simulator = Simulator(tests)
    kept = in_order([record for record in records if record is not None], DECLARED)
    model = LoopModel(DECLARED, E, {}, G, uses=uses(kept, len(tests)))
    return simulator, baseline(simulator, model, swing_windows(kept))


def found_of(simulator: Simulator, plain: Trial) -> Trial:
    best = search(simulator, plain, by_itself(simulator, plain), repeated=True, leading=True).best
    assert best is not None
    return best


def within(simulator: Simulator, found: Trial, name: str, truth: float) -> None:
    """To three standard deviations of the noise."""
    place = [p.name for p in found.swing.parameters].index(name)
    sd = float(np.sqrt(sensor_covariance(simulator, found.swing)[place, place]))
    assert abs(found.swing.model.get(name) - truth) < 3.0 * sd
    assert sd < 0.2 * abs(truth)


@pytest.mark.slow
def test_a_floor_that_leans_a_little_more_after_each_test() -> None:
    """0.4 mrad each; an eccentric mass moves the balance as a tilt does, to first order, so that either may be said."""
    simulator, plain = decays(lambda k: replace(IDEAL, tilt=4e-4 * k))
    found = found_of(simulator, plain)
    forms = ("base_tilt", "eccentric_mass", "eccentric_mass (restitution alike)")
    assert found.names[0] in {f"learned[{form}, changing evenly]" for form in forms}
    assert found.swing.rms < 1.01 < plain.swing.rms
    tilt = search(simulator, plain, [c for c in changing(simulator, plain, NAMED) if "base_tilt" in c.name]).best
    assert tilt is not None
    within(simulator, tilt, f"{CHANGE}.per_test.base_tilt.angle", 4e-4)


def test_something_in_the_block_that_moves_between_two_tests() -> None:
    """By 1.5 mm after the third test, from the middle."""
    simulator, plain = decays(lambda k: replace(IDEAL, offset=0.0015 if k >= 3 else 0.0))
    found = found_of(simulator, plain)
    offset, tilt = (f"learned[{name}, changed before test 4]" for name in ("eccentric_mass", "base_tilt"))
    assert found.names[0] in (offset, tilt)
    one = search(simulator, plain, [c for c in changing(simulator, plain, NAMED) if c.name == offset]).best
    assert one is not None
    within(simulator, one, f"{CHANGE}.step.eccentric_mass.offset", 0.0015)


@pytest.mark.slow
def test_a_sensor_that_warms_up() -> None:
    """Its gain ends 2 % higher: the leans at release are read by it too, and are as uncertain as before.

    Leans that become smaller let both clocks say so; in each test a reading is right to the noise of one.
    """
    simulator, plain = decays(gain=lambda k: 1.0 + 0.02 * (1.0 - np.exp(-0.3 * k)))
    found = found_of(simulator, plain)
    assert found.names[0].startswith("learned[rotation_gain, ")
    assert found.names[0].endswith(" ever less]")
    assert found.swing.rms < 1.01 < 1.3 < plain.swing.rms
    for k in range(len(LEANS)):
        read = float(found.swing.model.in_test(k).reading(0.1))
        assert read == pytest.approx(0.1 + 0.002 * (1.0 - np.exp(-0.3 * k)), abs=NOISE)


@pytest.mark.slow
def test_the_rest_of_an_effect_with_a_name_is_its_change() -> None:
    """Edges of a radius of 2 mm that wear by 0.3 mm in each test, of which a name finds 2.9 mm at first."""
    simulator, plain = decays(lambda k: replace(IDEAL, radius=0.002 + 3e-4 * k))
    edges = search(simulator, plain, [c for c in NAMED if c.name == "rounded_edges"]).best
    assert edges is not None
    assert edges.swing.rms > 1.05
    found = learn(simulator, edges, lambda text: None)
    assert found.swing.rms < 1.01
    own = next(c for c in changing(simulator, edges, NAMED) if c.name == "learned[rounded_edges, changing evenly]")
    assert {p.name for p in own.parameters} == {f"{CHANGE}.per_test.rounded_edges.radius"}
    one = search(simulator, edges, [own], repeated=True).best
    assert one is not None
    within(simulator, one, f"{CHANGE}.per_test.rounded_edges.radius", 3e-4)


@pytest.mark.slow
def test_edges_that_impacts_wear() -> None:
    """The edges go inwards by 0.9 mm in all, as impacts go on: by the squares of their speeds until a test's middle.

    Three releases from far are nearly all of it, and four from near next to nothing: the number of the test is another
    clock.  The square of the lean stands for the sum.
    """
    leans = (0.26, -0.25, 0.26, -0.1, 0.11, -0.12, 0.1)
    squares = np.square(leans)
    taken = np.cumsum(squares) - 0.5 * squares
    simulator, plain = decays(lambda k: replace(IDEAL, half_breadth=0.1 - 4e-3 * taken[k]), leans=leans)
    found = found_of(simulator, plain)
    assert "wearing" in found.names[0]
    assert found.swing.rms < 1.01 < 1.1 < plain.swing.rms


def test_use_is_what_impacts_took_until_the_middle_of_a_test() -> None:
    """Half of what they take in the first test, all of that and half of the second one's, over the mean of all."""
    simulator, plain = decays()
    records = in_order(
        [r for k, t in enumerate(simulator.tests) if (r := record_of(t, k, NOISE, DECLARED.alpha)) is not None],
        DECLARED,
    )
    each = np.array([sum(r.squares) for r in records])
    got = uses(records, len(LEANS))
    np.testing.assert_allclose(got, (np.cumsum(each) - 0.5 * each) / each.mean(), rtol=0.02)
    model = replace(plain.swing.model, uses=got)
    assert replace(model, number=len(LEANS) + 2).use == pytest.approx(got[-1] + 3.0)


def test_nothing_changes_where_nothing_does() -> None:
    simulator, plain = decays()
    assert changing(simulator, plain, NAMED) == []


def test_few_tests_have_no_course() -> None:
    simulator, plain = decays(lambda k: replace(IDEAL, tilt=4e-4 * k), leans=LEANS[: LEAST_TESTS - 1])
    assert changing(simulator, plain, NAMED) == []


def test_the_score_of_a_course_is_that_of_its_own_parameters() -> None:
    """Derivatives by a change are those by the parameter, times what has come about of it in the test."""
    simulator, plain = decays(lambda k: replace(IDEAL, tilt=4e-4 * k))
    (tilt,) = (c for c in NAMED if c.name == "base_tilt")
    evenly = courses(plain.swing.model, len(LEANS), range(len(LEANS)))[0]
    model = plain.swing.model.changed(tilt.absent(DECLARED))
    scored = gains_of_changes(
        simulator, plain.swing, {"tilt": tilt.parameters}, {"tilt": model}, {evenly.words: evenly.share}
    )
    (own,) = (c for c in changing(simulator, plain, NAMED) if c.name == "learned[base_tilt, changing evenly]")
    by_hand = gains(simulator, plain.swing, {"own": own.parameters}, {"own": model.changed(own.nothing(DECLARED))})
    assert scored["tilt", evenly.words] == pytest.approx(by_hand["own"], rel=1e-3)
