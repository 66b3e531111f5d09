"""Columns under synthetic earthquakes (studies.earthquakes)."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import dem
from studies import earthquakes
from studies.earthquakes import Plan
from studies.running.parts import Parts
from studies.running.statements import UNDECIDED


@pytest.mark.parametrize("ending", [dem.Ending.UNSTABLE, dem.Ending.LEFT, dem.Ending.INTERRUPTED])
def test_a_run_that_fails_is_no_scene_that_stands(ending, monkeypatch):
    """One run of four ends so: a body that left, too, was not seen to fall."""
    column, contact = dem.column(1, 0.15, 0.5, 0.25, 597.0), dem.Contact(0.7, damping=1.0)
    ended = dem.simulate_assembly(column, t_end=0.01, contact=contact)
    ends = iter([ending, *[dem.Ending.REACHED_END] * 3])
    monkeypatch.setattr(dem, "simulate_assembly", lambda *args, **kwargs: replace(ended, ending=next(ends)))
    with pytest.raises(RuntimeError, match="1 runs failed; want none"):
        earthquakes.dataset(Plan(peaks=(3.0,), seeds=1), Parts(workers=1))


def test_motions_that_fell_nothing_bear_nothing_out():
    """By hand: of four motions one fells the column at the first peak and the block at the second, with vertical motion
    both at the first; one fells both at the second, either way; two fell nothing."""
    fell = np.zeros((2, 2, 2, 4), dtype=np.int8)  # scene, vertical, peak, seed
    coordinates = {"scene": list(earthquakes.SCENES), "vertical": [0.0, 2.0 / 3.0], "peak": [2.0, 3.0]}
    ds = xr.Dataset({"fell": (("scene", "vertical", "peak", "seed"), fell)}, coordinates)
    assert earthquakes.check(ds).statement_holds.values.tolist() == [UNDECIDED] * 2
    fell[:, :, 1, :2] = 1
    fell[1, :, 0, 0] = fell[0, 1, 0, 0] = 1
    found = earthquakes.check(ds)
    # The column falls first in one of the two without vertical motion, and in none with it: a quarter; the block's
    # least peak changes under one of its two motions, the column's under none.
    assert found.statement_number.values == pytest.approx([0.25, 0.5])
