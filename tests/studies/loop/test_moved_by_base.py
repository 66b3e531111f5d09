"""How far redrawn noise of the base moves a response now and then: records of the right model are missed by no more.

The responses are made with the package's SciPy solver under the true base; each record has another noise of it.
"""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from excitation import RampedSinusoid
from rocking import Block, Method1, solve
from studies.campaigns import Channel, DeclaredBlock, Test
from studies.loop.fits.fitting import Fit, fit
from studies.loop.models.model import LoopModel
from studies.loop.observed.spread import floors, furthest_moved, redrawn, variances, weighed
from studies.loop.observed.windows import record_of, whole_windows
from studies.loop.runs.simulation import Simulator
from studies.loop.whole import remaining
from studies.loop.whole.whole_records import MISSED

from .stubs import whole

BLOCK = Block(0.2, 0.8, 0.4)
DECLARED = DeclaredBlock(0.2, 0.8, 0.4, BLOCK.mass)
OF_ROTATION, NOISY, QUIET, RESTITUTION = 1e-4, 0.01, 0.001, 0.91
ROTATION = Channel("rotation", "rotation", OF_ROTATION)
TIME = 0.008 * np.arange(500)
MOTION = RampedSinusoid(3.0, 4.0, 6.0)
TRUE = solve(Method1(BLOCK, restitution=RESTITUTION, g=9.81), MOTION, t_end=float(TIME[-1]), save_at=TIME)


@dataclass(frozen=True)
class Said:
    """Of a record: rms over all noise by which a model misses it, and by which redrawn noise moves that model at most;
    what it misses it by, and what that would be of the true model."""

    missed: float
    moved: float
    error: float  # rad
    floor: float  # rad


def said(seed: int, restitution: float, of_base: float) -> Said:
    rng = np.random.default_rng(seed)
    data = {
        "rotation": TRUE.theta + OF_ROTATION * rng.standard_normal(TIME.size),
        "base_x": MOTION(TIME)[0] + of_base * rng.standard_normal(TIME.size),
    }
    test = Test("ramp", "forced", TIME, (ROTATION, Channel("base_x", "base_acceleration_x", of_base)), data)
    simulator, noisy = Simulator([test]), redrawn([test], np.array([of_base]), seed=seed)
    windows = whole_windows([record_of(test, 0, OF_ROTATION, DECLARED.alpha)])
    model = LoopModel(DECLARED, restitution, {}, 9.81)
    bare: Fit = fit(simulator, model, [], windows, whole=True, iterations=0)
    windows = weighed(windows, variances(noisy, 1, model, windows))
    found: Fit = fit(simulator, model, [], windows, whole=True, iterations=0)
    (moved,) = furthest_moved(simulator, noisy, 1, model, windows)
    (floor,) = floors(simulator, noisy, 1, model, windows, [0.0])
    return Said(float(found.by_window[0]), float(moved), OF_ROTATION * float(bare.by_window[0]), floor)


@pytest.fixture(scope="module")
def right() -> list[Said]:
    """Of the right model, under 24 noises of the base."""
    return [said(seed, RESTITUTION, NOISY) for seed in range(24)]


# By the symmetry of 33 noises, a record is missed by more than the furthest of 32 once in 33 times: of 24 records more
# than three are with a chance of 0.6 %.
def test_the_right_model_misses_a_record_by_no_more_than_redrawn_noise_moves_it(right: list[Said]) -> None:
    assert sum(s.missed > s.moved for s in right) <= 3


# Four draws in place of 16 weighed one of the 24 so much that it was missed by 2.7 times all noise.
def test_the_right_model_meets_every_record_as_it_is_weighed(right: list[Said]) -> None:
    assert all(s.missed < MISSED for s in right)


# Half of them on either side, and three standard deviations of 24 throws.
def test_the_right_model_scores_the_floor(right: list[Said]) -> None:
    assert 5 <= sum(s.error < s.floor for s in right) <= 19


# 0.03 less of the angular velocity in each impact, beside 0.017 % of the base's acceleration.
def test_another_restitution_misses_them_by_more_where_the_base_is_quiet() -> None:
    wrong = [said(seed, RESTITUTION - 0.03, QUIET) for seed in range(6)]
    assert all(s.missed > s.moved for s in wrong)


def test_a_release_over_a_base_that_was_not_read_is_moved_by_nothing() -> None:
    test = Test("free", "free", TIME, (ROTATION,), {"rotation": 0.0 * TIME}, initial_rotation=0.1)
    windows = whole_windows([record_of(test, 0, OF_ROTATION, DECLARED.alpha)])
    noisy = redrawn([test], np.array([0.0]))
    model = LoopModel(DECLARED, RESTITUTION, {}, 9.81)
    assert furthest_moved(Simulator([test]), noisy, 1, model, windows) == pytest.approx([1.0], rel=1e-12)
    assert floors(Simulator([test]), noisy, 1, model, windows, [0.0]) == pytest.approx([OF_ROTATION], rel=1e-12)


@pytest.mark.parametrize(
    ("missed", "moved", "met"),
    [
        pytest.param((1.0, 1.5), (), True, id="all together"),
        pytest.param((1.0, 2.4), (2.6,), True, id="one hangs on the base"),
        pytest.param((1.0, 2.7), (2.6,), False, id="one is missed by more than the base does"),
        pytest.param((1.4, 2.4), (1.2, 2.6), False, id="another one hangs on nothing"),
        pytest.param((9.0, 2.4), (30.0, 2.6), True, id="both hang on it"),
    ],
)
def test_records_are_met_as_far_as_the_base_lets_them(
    monkeypatch: pytest.MonkeyPatch, missed: tuple[float, ...], moved: tuple[float, ...], met: bool
) -> None:
    """`moved`: of those that are missed by 1.3 times their noise or more, if these are asked."""

    def furthest(simulator: object, noisy: object, count: int, model: object, windows: list[float]) -> np.ndarray:
        assert windows == [m for m in missed if m >= 1.3]
        return np.array(moved)

    monkeypatch.setattr(remaining, "furthest_moved", furthest)
    found = whole(*missed)
    found.windows, found.model = missed, None
    setup = SimpleNamespace(simulator=None, noisy=None, campaign=SimpleNamespace(tests=missed))
    assert remaining.met(setup, found, 1.3) is met  # type: ignore[arg-type]
