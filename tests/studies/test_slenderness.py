"""From which frequency a block rocks before it falls (studies.slenderness)."""

import math
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from rocking import Outcome
from studies import slenderness
from studies.running.parts import Parts
from studies.slenderness import Plan, from_which


def test_the_frequency_from_which_all_rock_first_is_the_lowest_above_every_one_that_does_not():
    """By hand: periods of rocking are (fall - onset) f, more than one counts, and a block that stands has its 10 s."""
    frequency = np.array([0.5, 1.0, 2.0, 4.0])
    lasting = {  # seconds between onset and fall; the frequencies at which that is over a period
        "all but the lowest": ([1.0, 2.0, 2.0, 2.0], 1.0),
        "an early one alone does not count": ([3.0, 0.5, 2.0, 2.0], 2.0),
        "the highest does not": ([3.0, 3.0, 3.0, 0.1], math.nan),
        "stands": ([3.0, 3.0, 3.0, math.nan], 0.5),
    }
    times = np.array([times for times, _ in lasting.values()])
    ds = xr.Dataset(
        {"onset_time": (("case", "frequency"), np.full(times.shape, 5.0)),
         "overturning_time": (("case", "frequency"), 5.0 + times)},
        {"frequency": frequency, "case": list(lasting)}, {"duration": 10.0},
    )  # fmt: skip
    np.testing.assert_array_equal(from_which(ds), [expected for _, expected in lasting.values()])


def test_the_study_looks_every_fifth_of_a_hertz_up_to_five():
    """Its statements name the lowest frequency: what lies between two of them it does not say."""
    assert Plan().frequencies == pytest.approx(np.linspace(0.2, 5.0, 25), rel=1e-12)


def _plan(friction):
    plan = Plan(frequencies=(3.0,))
    return replace(plan, settings=replace(plan.settings, duration=20.0, friction=friction))


def test_a_block_that_slides_does_not_begin_to_rock():
    """Coulomb: mu g turns no block whose b/h is above mu, under a horizontal motion; 0.25 is below that of three."""
    ds = slenderness.dataset(_plan(0.25), Parts()).isel(frequency=0)
    slides = (ds.b / ds.h > 0.25).values
    assert slides.sum() == 3
    np.testing.assert_array_equal(np.isnan(ds.onset_time.sel({"method": "method2"})), slides)
    assert ds.onset_time.sel({"method": "method1"}).notnull().all()


def test_a_run_that_fails_is_no_block_that_stands(monkeypatch):
    real = slenderness.solve

    def failing(system, *args, **kwargs):
        run = real(system, *args, **kwargs)
        return replace(run, outcome=Outcome.FAILED) if system.name == "method2" else run

    monkeypatch.setattr(slenderness, "solve", failing)
    with pytest.raises(RuntimeError, match="4 runs failed; want none"):
        slenderness.dataset(_plan(0.7), Parts())
