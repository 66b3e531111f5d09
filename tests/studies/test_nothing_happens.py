"""Runs in which nothing happens, or not what a statement is about: nothing is decided, and drawings say so."""

import math
from types import SimpleNamespace

import numpy as np
import xarray as xr

from studies import fig20, fig22, scatter, slenderness, wall_gap
from studies.criteria.columns import G
from studies.criteria.overturning import Settings
from studies.families import records
from studies.families.columns import median
from studies.running.labelled import block_axis
from studies.running.statements import HOLDS, UNDECIDED

STAGES = ("rocks", "a joint opens", "another joint opens", "falls")


def _column(count, times, frequency, falls=True):
    """A run of fig20 or fig22: its stages, and the same at the frequencies 1, 2, 3 Hz."""
    names = STAGES if count == 3 else (*STAGES[:2], STAGES[3])
    at = ("frequency", [1.0, 2.0, 3.0])
    over = {
        "at_parting_time": [9.0, 8.0, 7.0], "at_largest_apart": [0.02, 0.5, 1.0],
        "at_overturning_time": [20.0 if falls else math.nan] * 3,
    }  # fmt: skip
    ds = xr.Dataset({name: ("frequency", values) for name, values in over.items()}, {"frequency": at})
    ds = ds.assign(stage_time=("stage", list(times))).assign_coords(stage=list(names))
    return ds.assign_attrs(frequency=frequency)


def _verdicts(study, ds):
    found = study.check(ds)
    return {
        k.partition(".")[2]: v for k, v in zip(found.statement_key.values, found.statement_holds.values, strict=True)
    }


def test_a_column_that_stands_bears_nothing_out():
    held = _verdicts(fig20, _column(2, (5.0, 7.0, 9.0), 3.0))
    assert held == dict.fromkeys(("together", "apart", "low", "earlier"), HOLDS)
    nothing = _verdicts(fig20, _column(2, [math.nan] * 3, 3.0, falls=False))
    assert [nothing[word] for word in ("together", "apart", "low")] == [UNDECIDED] * 3
    assert _verdicts(fig22, _column(3, (5.0, 6.0, 7.0, 9.0), 3.0)) == {"stages": HOLDS}
    assert _verdicts(fig22, _column(3, (5.0, 6.0, math.nan, math.nan), 3.0)) == {"stages": UNDECIDED}


def test_what_is_said_of_3_hz_is_not_decided_at_another_frequency():
    other = _verdicts(fig20, _column(2, (5.0, 7.0, 9.0), 2.0))
    assert other == {"together": UNDECIDED, "apart": UNDECIDED, "low": HOLDS, "earlier": HOLDS}
    assert _verdicts(fig22, _column(3, (5.0, 6.0, 7.0, 9.0), 2.0)) == {"stages": UNDECIDED}


def _by_a_wall(wall, free):
    """Criteria over (gap, tiny, frequency) and (tiny, frequency), NaN where a run stands; the last gap is out of
    reach."""
    wall, free = np.asarray(wall, dtype=float), np.asarray(free, dtype=float)
    dims = ("gap", "tiny", "frequency")
    ds = xr.Dataset(
        {
            "overturning_amplitude": (dims, wall),
            "note": (dims, np.where(np.isnan(wall), "standing", "overturned")),
            "free_overturning_amplitude": (dims[1:], free),
            "free_note": (dims[1:], np.where(np.isnan(free), "standing", "overturned")),
            "free_parting_time": (dims[1:], np.full(free.shape, math.nan)),
        },
        {"gap": [0.0, 0.01, wall_gap.FAR], "tiny": [-1e-6, 0.0, 1e-6][: free.shape[0]], "frequency": [1.0, 3.0]},
    )
    return ds


def test_a_run_that_stands_by_a_wall_counts_as_infinitely_strong_as_in_figs_18_and_19():
    wall = np.full((3, 3, 2), 2.0)
    wall[0, :, 0] = 2.0, math.nan, math.nan
    wall[1, :, 0] = 2.0, 4.0, math.nan
    ds = _by_a_wall(wall, np.full((3, 2), 2.0))
    np.testing.assert_array_equal(wall_gap.ratio(ds), [[math.nan, 1.0], [2.0, 1.0], [1.0, 1.0]])
    np.testing.assert_array_equal(wall_gap.ratio(ds), median(ds) / 2.0)
    assert _verdicts(wall_gap, ds) == {"far": HOLDS, "frequency": UNDECIDED, "gap": UNDECIDED}
    said = " ".join(wall_gap.figure(ds).get_supxlabel().split())
    assert "is the worst" not in said and "half of the runs or more do not fall" in said


def test_a_wall_by_which_nothing_falls_is_drawn_without_a_worst_gap():
    ds = _by_a_wall(np.full((3, 1, 2), math.nan), np.full((1, 2), math.nan))
    said = " ".join(wall_gap.figure(ds).get_supxlabel().split())
    assert "is the worst" not in said and "medians" not in said
    assert _verdicts(wall_gap, ds) == dict.fromkeys(("far", "frequency", "gap"), UNDECIDED)
    wall = np.array([[[2.0, 1.5]], [[1.5, 1.0]], [[2.0, 2.0]]])
    whole = wall_gap.figure(_by_a_wall(wall, np.full((1, 2), 2.0)))
    assert "over all frequencies a gap of 10 mm is the worst." in " ".join(whole.get_supxlabel().split())


def test_a_block_that_stands_still_has_no_share_of_its_path_in_jumps():
    found = scatter.jumps(Settings(ramp=0.05 * G, duration=3.0), 3.0, 0.3)
    assert found["length"].size == 0 and math.isnan(found["share"])


def test_a_record_of_which_nothing_is_read_is_drawn():
    time = np.linspace(0.0, 8.0, 81)
    nothing = (("frequency", "seed"), [[math.nan]])
    ds = xr.Dataset(
        dict.fromkeys(records.LABELS, nothing)
        | {"reading": ("time", 9.8 + 0.01 * np.sin(9.0 * time)), "base_acceleration": ("time", np.sin(time))},
        {"time": time, "frequency": [3.0], "seed": [1]}, {"shown_frequency": 3.0},
    )  # fmt: skip
    zoom = records.figure(ds, "fall", "A record.", 1.5).axes[2]
    assert [text.get_text() for text in zoom.get_legend().get_texts()] == [
        "fall (simulation): none",
        "fall (read): none",
    ]
    np.testing.assert_array_equal(zoom.get_lines()[0].get_xdata(), time)


def test_the_drawing_asks_what_the_statement_decides():
    """That the frequency depends on b/h is decided by the numbers of a run, not by its caption."""
    over = ("method", "block", "frequency")
    shape = (2, 4, 2)
    ds = xr.Dataset(
        {"onset_time": (over, np.full(shape, 5.0)), "overturning_time": (over, np.full(shape, 9.0))},
        block_axis(slenderness.BLOCKS) | {"method": list(slenderness.METHODS), "frequency": [1.0, 2.0]},
        {"ramp": 6.0 * G, "duration": 60.0},
    )
    assert "and whether that depends on b/h" in " ".join(slenderness.figure(ds).get_supxlabel().split())


def test_one_restitution_given_twice_is_taken_once():
    from studies.fig05 import plan_of

    options = SimpleNamespace(restitution=[0.9, 0.93, 0.9], release=0.6, quick=True)
    assert plan_of(options).restitutions == (0.9, 0.93)
