"""Windows that begin while the block slips: its slip is carried over from the swings before, and friction is measured.

The record is made with the package's SciPy solver and noise; the fits run on the compiled one.
"""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from excitation import RampedSinusoid
from rocking import Block, Method2, Mode, solve
from studies.campaigns import Channel, DeclaredBlock, Test
from studies.loop.fits.fitting import fit
from studies.loop.models.candidates import candidates
from studies.loop.models.model import RESTITUTION, LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.observed.observing import jobs_of
from studies.loop.observed.windows import record_of, swing_windows
from studies.loop.runs.simulation import Peak, Simulator, _Leg, _true_peaks
from studies.loop.swings import trying
from studies.loop.swings.tracing import baseline, search
from studies.loop.swings.trials import pays

BLOCK = Block(0.15, 0.5, 0.25)
DECLARED = DeclaredBlock(0.15, 0.5, 0.25, BLOCK.mass)
FRICTION, NOISE, E = 0.7, 3e-4, BLOCK.housner_restitution * (1.0 + 1e-12)
MU = Parameter("sliding.friction", 0.02, 0.02, 1.3)
RATIO = Parameter(RESTITUTION, 0.01, 0.02, 1.0)


def recorded(block: Method2, most: float = 32.0, mode: Mode = Mode.SLIDE_ROTATION, least: float = 2.0) -> list[Test]:
    """A ramp to 3.3 g at 4 Hz, at the end of which the block slips nearly all the time."""
    rng = np.random.default_rng(5)
    motion, t = RampedSinusoid(4.0, 12.0, most), np.arange(3000) * 0.004
    run = solve(block, motion, t_end=float(t[-1]), save_at=t, solver="scipy")
    assert run.mode_durations(float(t[-1]))[mode] > least
    channels = (Channel("base_x", "base_acceleration_x", 0.002), Channel("rotation", "rotation", NOISE))
    data = {
        "base_x": motion(t)[0] + 0.002 * rng.standard_normal(t.size),
        "rotation": run.theta + NOISE * rng.standard_normal(t.size),
        "truth": run.y[:, 3],
    }
    return [Test("ramp", "forced", t, channels, data)]


def windows_of(tests: list[Test]) -> list[Any]:
    record = record_of(tests[0], 0, NOISE, DECLARED.alpha)
    assert record is not None
    return swing_windows([record])


def test_a_way_of_legs_begins_at_the_peaks_that_the_sensor_of_each_model_has_read() -> None:
    """reading = gain theta + offset, so that theta = (reading - offset) / gain and omega = its slope / gain."""
    sensors: tuple[dict[str, dict[str, float]], ...] = (
        {},
        {"rotation_gain": {"gain": 0.9}},
        {"rotation_offset": {"offset": 0.004}},
        {"rotation_gain": {"gain": 0.9}, "viscous_damping": {"coefficient": 0.1}},
    )
    models = [LoopModel(DECLARED, E, sensor, 9.81) for sensor in sensors]
    read = Peak(1.0, 0.1, 0.02), Peak(2.0, -0.05, -0.01), Peak(3.0, math.nan, 0.0)
    legs: dict[_Leg, tuple[Peak, _Leg | None]] = {
        _Leg(model, 0, 1.0, k, 1.0 + k): (peak, None) for model in range(len(models)) for k, peak in enumerate(read)
    }
    for leg, true in _true_peaks(models, legs).items():
        peak = read[leg.depth]
        gain, offset = (1.0, 0.9, 1.0, 0.9)[leg.model], (0.0, 0.0, 0.004, 0.0)[leg.model]
        expected = Peak(peak.time, (peak.theta - offset) / gain, peak.omega / gain)
        np.testing.assert_allclose(true, expected if math.isfinite(peak.theta) else peak, rtol=1e-9, atol=1e-12)


@pytest.fixture(scope="module")
def tests() -> list[Test]:
    """Of a block with Housner's restitution."""
    return recorded(Method2(BLOCK, friction=FRICTION, g=9.81))


@pytest.fixture(scope="module")
def windows(tests: list[Test]) -> list[Any]:
    return windows_of(tests)


def model(friction: float) -> LoopModel:
    return LoopModel(DECLARED, E, {"sliding": {"friction": friction}}, 9.81)


def test_slip_at_the_start_of_a_window_is_that_of_the_block(tests: list[Test], windows: list[Any]) -> None:
    carried = Simulator(tests)._carried([model(FRICTION)], jobs_of(windows, 0))
    found = np.array([state.get("u", 0.0) for state in carried])
    true = np.array([tests[0].data["truth"][round(w.start / 0.004)] for w in windows])
    assert np.sum(np.abs(true) > 0.1) > 10
    # Slip falls by mu g, 7 m/s^2, and a start is off a sample by up to 2 ms: 14 mm/s, and what noise of the peaks adds.
    assert np.quantile(np.abs(found - true), 0.8) < 0.03


def test_a_block_that_does_not_slip_is_run_from_peak_to_peak_once(
    tests: list[Test], windows: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Windows one after another share these runs; each by itself would take six."""
    ran: list[int] = []
    run = Simulator._run

    def counted(self: Any, models: Any, jobs: Any, carried: Any) -> Any:
        ran.append(len(jobs))
        return run(self, models, jobs, carried)

    monkeypatch.setattr(Simulator, "_run", counted)
    early = windows[:12]  # while the ramp is low
    states = Simulator(tests)._carried([model(1.3)], jobs_of(early, 0))
    assert not any(states)
    assert len(early) - 1 <= sum(ran) <= len(early) + 1


def test_slip_is_what_it_would_be_if_each_window_were_reached_over_six_swings(
    tests: list[Test], windows: list[Any]
) -> None:
    simulator, jobs = Simulator(tests), jobs_of(windows, 0)
    for friction in (0.9 * FRICTION, FRICTION, 1.2 * FRICTION):
        slippery = [model(friction)]
        legs: Any = {}
        lasts = [simulator._reached(slippery[0], job, legs) for job in jobs]
        known: Any = {}
        simulator._follow(slippery, legs, known)
        wanted = np.array([known[leg].get("u", 0.0) if leg is not None else 0.0 for leg in lasts])
        found = np.array([state.get("u", 0.0) for state in simulator._carried(slippery, jobs)])
        assert np.sum(np.abs(wanted) > 0.1) > 5
        # A swing begun without slip that ends sticking, and one begun with it that does not, could be: none is here.
        assert found == pytest.approx(wanted, abs=1e-6)


def test_friction_is_measured_where_half_of_the_windows_slip(tests: list[Test], windows: list[Any]) -> None:
    found = fit(Simulator(tests), model(0.68), [MU], windows)
    assert found.model.get("sliding.friction") == pytest.approx(FRICTION, rel=0.01)
    # A fit that sees only noise: its median window is at the noise, two states fitted to each.
    left = [r @ r / (r.size - 2) for r in found.residuals]
    assert np.median(left) == pytest.approx(1.0, abs=0.15)


# A block may lose more than by Housner's impact.
def test_friction_is_measured_beside_a_restitution_below_housners() -> None:
    e = 0.95 * BLOCK.housner_restitution
    tests = recorded(Method2(BLOCK, friction=FRICTION, impact_law="two_corner", restitution=e, g=9.81))
    begun = LoopModel(DECLARED, E, {"sliding": {"friction": 0.68}}, 9.81)
    found = fit(Simulator(tests), begun, [RATIO, MU], windows_of(tests))
    assert found.model.get("sliding.friction") == pytest.approx(FRICTION, rel=0.01)
    assert found.model.restitution == pytest.approx(e, abs=0.005)


@pytest.mark.slow
def test_sliding_is_traced_among_its_rivals(tests: list[Test], windows: list[Any]) -> None:
    simulator = Simulator(tests)
    plain = baseline(simulator, LoopModel(DECLARED, E, {}, 9.81), windows)
    pool = [c for c in candidates(DECLARED) if c.effect in ("sliding", "bouncing", "rounded_edges", "viscous_damping")]
    best = search(simulator, plain, pool).best
    assert best is not None and pays(plain.swing, best.swing)
    assert best.effects == ("sliding",)
    assert best.swing.model.get("sliding.friction") == pytest.approx(FRICTION, rel=0.02)


@pytest.mark.parametrize(("law", "form"), [("kinematic", "bouncing[stops]"), ("frictional", "bouncing")])
def test_bouncing_that_impacts_stop_is_told_from_that_which_leaves_a_slip(law: Any, form: str) -> None:
    """A corner that leaves the floor with 0.6 of its approach, for half a second in all; the ramp goes to 0.5 g."""
    block = Method2(BLOCK, friction=math.inf, normal_restitution=0.6, impact_law=law, g=9.81)
    tests = recorded(block, 5.0, Mode.ROTATION_JUMP, 0.5)
    simulator = Simulator(tests)
    plain = baseline(simulator, LoopModel(DECLARED, E, {}, 9.81), windows_of(tests))
    pool = [c for c in candidates(DECLARED) if c.name.startswith("bouncing") and not c.costly]
    best = search(simulator, plain, pool).best
    assert best is not None and best.names == (form,)
    assert best.swing.model.get("bouncing.normal_restitution") == pytest.approx(0.6, abs=0.02)


# Rounded edges keep more of a swing than sharp ones (angular momentum about the new edge): what was calibrated without
# them is below the restitution of that form, and a start beside sliding all the same.
def test_a_start_beside_sliding_has_the_restitution_that_was_calibrated(monkeypatch: pytest.MonkeyPatch) -> None:
    sliding = next(c for c in candidates(DECLARED) if c.name == "sliding")
    rounded = next(c for c in candidates(DECLARED) if c.name == "rounded_edges")
    model = LoopModel(DECLARED, E, {"sliding": {"friction": 0.5}})
    swing = SimpleNamespace(model=model, windows=(), residuals=())
    onto: Any = SimpleNamespace(
        swing=swing,
        parts=(sliding,),
        parameters=(),
        costly=False,
        effects=("sliding",),
        calibrated_with=lambda part: (),
    )
    tried: list[LoopModel] = []

    def noted(simulator: Any, model: LoopModel, *_: Any, **__: Any) -> Any:
        tried.append(model)
        raise ValueError("enough")

    monkeypatch.setattr(trying, "fit", noted)
    assert trying.on_some(None, onto, rounded) == "enough"  # type: ignore[arg-type]
    assert any(m.get("rounded_edges.radius") > 0.0 for m in tried)
    for m in tried:
        assert m.system.name == "method2"
        assert m.restitution == E
