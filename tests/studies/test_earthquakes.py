"""Columns under synthetic earthquakes (studies.earthquakes)."""

from dataclasses import replace

import pytest

import dem
from studies import earthquakes
from studies.earthquakes import Plan
from studies.running.parts import Parts


@pytest.mark.parametrize("ending", [dem.Ending.UNSTABLE, dem.Ending.LEFT, dem.Ending.INTERRUPTED])
def test_a_run_that_fails_is_no_scene_that_stands(ending, monkeypatch):
    """One run of four ends so: a body that left, too, was not seen to fall."""
    column, contact = dem.column(1, 0.15, 0.5, 0.25, 597.0), dem.Contact(0.7, damping=1.0)
    ended = dem.simulate_assembly(column, t_end=0.01, contact=contact)
    ends = iter([ending, *[dem.Ending.REACHED_END] * 3])
    monkeypatch.setattr(dem, "simulate_assembly", lambda *args, **kwargs: replace(ended, ending=next(ends)))
    with pytest.raises(RuntimeError, match="1 runs failed; want none"):
        earthquakes.dataset(Plan(peaks=(3.0,), seeds=1), Parts(workers=1))
