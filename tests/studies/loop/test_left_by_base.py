"""A quiet sensor of the rotation beside a noisy one of the base: what the latter leaves of swings is no structure."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from rocking import Block, Method1, solve
from studies.campaigns import Campaign, Channel, Conditions, DeclaredBlock, Test
from studies.loop.closing import baseline
from studies.loop.fits import left_by_base
from studies.loop.observed.windows import Window
from studies.loop.records.preparing import as_declared, prepare
from studies.loop.whole.remaining import STRUCTURE, by_chance, over_noise, structure

STEP, G = 0.004, 9.81
BLOCK = Block(b=0.25, h=1.0, d=0.25, density=2500.0)
DECLARED = DeclaredBlock(0.25, 1.0, 0.25, BLOCK.mass)
QUIET = 3e-5  # rad


def left(base_noise: float, seed: int) -> tuple[float, float, bool, float]:
    """What the calibrated ideal block leaves of swings of releases over a base at rest: over the noise as the loop has
    it, the threshold of structure, whether that is chance, and over the noise of the rotation alone."""
    rng = np.random.default_rng(seed)
    channels = Channel("rotation", "rotation", QUIET), Channel("base", "base_acceleration_x", base_noise)
    t = STEP * np.arange(1500)
    tests = []
    for theta in (0.18, -0.12, 0.15, -0.18, 0.1):
        run = solve(Method1(BLOCK, restitution=0.92, g=G), theta=theta, t_end=t[-1], save_at=t)
        rotation = run.theta + QUIET * rng.standard_normal(t.size)
        data = {"rotation": rotation, "base": base_noise * rng.standard_normal(t.size)}
        tests.append(Test(f"from {theta}", "free", t, channels, data, initial_rotation=theta))
    campaign = Campaign("clean", DECLARED, Conditions(), channels, tuple(tests))
    setup = prepare(campaign, as_declared(campaign, G))
    plain = baseline(setup.simulator, setup.start, setup.swings)
    bare = baseline(setup.simulator, setup.start, [replace(w, sd=None, by_base=0.0) for w in setup.swings])
    return over_noise(setup, plain), structure(setup), by_chance(setup, plain), over_noise(setup, bare)


# Unless the base's noise is told apart, half as much again as the rotation's is left of clean records, and more.
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_noise_of_the_base_is_no_structure(seed: int) -> None:
    over, threshold, _, unweighted = left(0.02, seed)
    assert unweighted > 1.5
    # The threshold lies four standard deviations of what the base leaves above that of white noise; three are allowed.
    assert abs(over**2 - 1.0) < 0.75 * (threshold**2 - STRUCTURE**2)
    assert over < threshold < 1.3


def test_a_quiet_base_leaves_thresholds_as_they_are() -> None:
    over, threshold, chance, unweighted = left(1e-5, 1)
    assert over == pytest.approx(unweighted, rel=1e-4)
    assert threshold == pytest.approx(STRUCTURE, rel=1e-4) and chance


def test_what_is_not_compared_in_one_of_both_runs_is_not_moved(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of four data one moves by its noise; accelerometers of a block on the other side say nothing."""
    four = np.arange(4)
    window = Window(
        0, 0, 0.0, 1.0 * four, four, (), four, np.full(4, 50.0), np.ones(4), theta=0.1, omega=0.0, theta_sd=0.0,
        omega_sd=0.0,
    )  # fmt: skip
    read = {"recorded": [1.0, np.nan, 2.0, 3.0], "noisy": [2.0, 1.0, np.nan, 3.0]}
    monkeypatch.setattr(left_by_base, "read_of", lambda simulator, model, windows: [np.array(read[simulator])])
    monkeypatch.setattr(left_by_base, "linearised", lambda *_, **__: SimpleNamespace(by_state=[np.zeros((4, 2))]))
    (found,) = left_by_base.with_left_by_base("recorded", "noisy", 1, None, [window])  # type: ignore[arg-type]
    # 1 in four data: a variance of 1.25, of which the base has a fifth.
    assert found.sd == pytest.approx(np.full(4, np.sqrt(1.25))) and found.by_base == pytest.approx(0.8)
