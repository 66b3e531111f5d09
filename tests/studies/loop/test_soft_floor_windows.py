"""Swings and records on a floor that gives: how deep a foot is at a peak, and minima that lie close together.

The record is made with the package's SciPy solver; the runs and fits are on the compiled one.
"""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from excitation import RampedSinusoid
from rocking import Block, Method1, solve
from rocking.effects import load
from studies.campaigns import Channel, DeclaredBlock, Test
from studies.loop.fits.fitting import fit_records
from studies.loop.models.model import LoopModel
from studies.loop.observed.observing import jobs_of
from studies.loop.observed.windows import record_of, swing_windows, whole_windows
from studies.loop.runs.simulation import Simulator, _not_forgotten
from studies.loop.swings.trials import E
from studies.loop.whole import whole_fits

BLOCK = Block(0.4, 1.2, 0.6)
DECLARED = DeclaredBlock(0.4, 1.2, 0.6, BLOCK.mass)
STIFFNESS, DAMPING, NOISE = 4e5, 0.06, 1e-5


def model(**floor: float) -> LoopModel:
    values = {"corner_stiffness": STIFFNESS, "damping_ratio": DAMPING, "tangential_ratio": 20.0, "spread": 0.0} | floor
    return LoopModel(DECLARED, 0.9, {"compliant_base": values}, 9.81)


@pytest.fixture(scope="module")
def shaken() -> Test:
    """A block that sinks by 2 mm, rocked at 4 Hz: swings shorter than the floor remembers."""
    t = np.arange(1500) * 0.004
    motion, effects = RampedSinusoid(4.0, 7.0, 7.0), [load("compliant_base")(STIFFNESS, DAMPING, 0.0, 20.0)]
    run = solve(
        Method1(BLOCK, g=9.81), motion, t_end=float(t[-1]), save_at=t, effects=effects, solver="scipy", rtol=1e-8,
        atol=1e-11,
    )  # fmt: skip
    channels = (Channel("base_x", "base_acceleration_x", 1e-4), Channel("rotation", "rotation", NOISE))
    data = {"base_x": motion(t)[0], "rotation": run.theta, "height": run.y[:, 1], "rate": run.y[:, 4]}
    return Test("ramp", "forced", t, channels, data)


def test_how_deep_a_foot_is_at_a_peak_is_carried_over_as_many_swings_as_the_floor_remembers(shaken: Test) -> None:
    record = record_of(shaken, 0, NOISE, DECLARED.alpha)
    assert record is not None
    windows = swing_windows([record])
    jobs = jobs_of(windows, 0)
    depths = [len(_not_forgotten(model().system, job.history, job.start)) for job in jobs]
    assert max(depths) > 2
    true = np.array([shaken.data["rate"][round(job.start / 0.004)] for job in jobs])

    def missed(jobs: list[Any]) -> float:
        states = Simulator([shaken])._carried([model()], jobs)
        found = [state["beside"][0][4] if state else math.nan for state in states]
        return float(np.nanmedian(np.abs(np.array(found) - true)))

    one = [job._replace(history=job.history[-1:]) for job in jobs]
    # The rates of the centre of mass are centimetres a second; none of it is known at the first of the peaks.
    assert missed(jobs) < 0.5 * missed(one)
    assert missed(jobs) < 0.1 * float(np.std(true))


def test_a_fit_that_is_drawn_out_finds_its_way_past_minima_in_which_one_of_whole_records_ends() -> None:
    """Twelve seconds of a free decay on a rigid floor, restitution begun 4 % too low: later swings are out of phase."""
    e, t = 0.95, np.arange(3000) * 0.004
    run = solve(Method1(BLOCK, restitution=e, g=9.81), theta=0.25, t_end=float(t[-1]), save_at=t, solver="scipy")
    rotation = run.theta + NOISE * np.random.default_rng(3).standard_normal(t.size)
    channels = (Channel("rotation", "rotation", NOISE),)
    test = Test("free", "free", t, channels, {"rotation": rotation}, initial_rotation=0.25)
    record = record_of(test, 0, NOISE, DECLARED.alpha)
    assert record is not None
    setup: Any = SimpleNamespace(simulator=Simulator([test]))
    trial: Any = SimpleNamespace(every=(E,), costly=True)
    begun = LoopModel(DECLARED, 0.96 * e, {}, 9.81)
    leans = fit_records(setup.simulator, begun, [], whole_windows([record]), iterations=4)
    at_once, drawn_out = whole_fits.all_at_once(setup, trial, leans), whole_fits.drawn_out(setup, trial, leans)
    assert abs(at_once.model.restitution - e) > 0.005
    # Noise alone is left, as a fit of the truth would leave it.
    assert drawn_out.model.restitution == pytest.approx(e, abs=1e-4)
    assert drawn_out.rms == pytest.approx(1.0, abs=0.05)
