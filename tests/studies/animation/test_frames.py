"""Frames of runs show the bodies where the dataset says, whether the run comes from memory or from a file."""

import math

import numpy as np
import pytest
import xarray as xr

from studies.animation import draw_frame, film_of, frames
from studies.running.files import save_dataset
from studies.running.plot import new_figure


def drawn(patch):
    return patch.get_xy()[:-1]  # the first corner is repeated


def test_bodies_are_drawn_where_the_run_says(column):
    film = film_of(column)
    sample = 3 * len(column.time) // 4
    patches = draw_frame(new_figure(3.0, 3.0).subplots(), film, sample)
    assert len(patches) == 3
    for b, patch in enumerate(patches):
        theta = column.theta[sample, b]
        # Clockwise: a corner that lay above the centroid goes to +x.
        turn = np.array([[math.cos(theta), math.sin(theta)], [-math.sin(theta), math.cos(theta)]])
        place = np.array([column.x[sample, b], column.z[sample, b]])
        expected = column.assembly.bodies[b].shape.corners @ turn.T + place
        assert drawn(patch) == pytest.approx(expected, abs=1e-12)


def test_blocks_of_a_standing_column_lie_on_each_other(column):
    film = film_of(column)
    tops = [film.corners(0, b)[:, 1].max() for b in range(3)]
    feet = [film.corners(0, b)[:, 1].min() for b in range(3)]
    # Pressed in by their weight, m g/kn of 1e-5 m.
    assert feet == pytest.approx([0.0, *tops[:2]], abs=1e-4)


@pytest.mark.parametrize("name", ["column", "by_a_wall", "block"])
def test_a_saved_run_is_shown_as_the_run_itself(name, request, tmp_path):
    run = request.getfixturevalue(name)
    save_dataset(run.to_xarray(), tmp_path / "run.nc")
    one, other = film_of(run), film_of(tmp_path / "run.nc")
    for field in ("time", "x", "z", "theta", "base_ax", "base_az"):
        assert np.array_equal(getattr(one, field), getattr(other, field))
    for field in ("outlines", "walls"):
        for here, there in zip(getattr(one, field), getattr(other, field), strict=True):
            assert np.array_equal(here, there)
    assert (one.names, one.floor, one.title, one.ending, one.events) == (
        other.names, other.floor, other.title, other.ending, other.events
    )  # fmt: skip


def test_walls_are_where_they_were_built_and_chosen_bodies_keep_their_outline(by_a_wall):
    film = film_of(by_a_wall)
    assert film.names == ("upper block",)
    assert np.array_equal(film.walls[0], by_a_wall.assembly.walls[0].vertices)
    assert film.walls[0][:, 0].max() == pytest.approx(-0.075 - 0.05)
    assert film.corners(0, 0)[:, 1].min() == pytest.approx(0.5, abs=1e-3)


def test_the_motion_of_the_base_is_that_of_the_run(column, block):
    for run, frequency in ((column, 3.0), (block, 1.0)):
        film = film_of(run)
        expected = 0.3 * 9.80665 * run.time * np.sin(2.0 * math.pi * frequency * run.time)
        assert film.base_ax == pytest.approx(expected, abs=1e-12)
        assert not film.base_az.any()


def test_events_are_falls_and_openings_in_order(column):
    film = film_of(column)
    times = [time for time, _ in film.events]
    assert times == sorted(times) and len(times) > 1
    assert (column.overturning_time, f"{column.overturned} overturns") in film.events
    assert film.ending == column.reason


def test_frames_are_headed_by_the_time_of_their_sample(column):
    wanted = np.linspace(0.0, column.end_time, 8)
    figure = frames(column, wanted, columns=3, labels=list("abcdefgh"), note="What to notice.")
    shown = [ax for ax in figure.axes if ax.patches]
    assert len(shown) == 8 and len(figure.axes) == 9
    spacing = np.diff(column.time).max()
    for ax, time, label in zip(shown, wanted, "abcdefgh", strict=True):
        heading, below = ax.get_title().split("\n")
        # Two decimals are shown.
        assert float(heading.removesuffix(" s")) == pytest.approx(time, abs=0.5 * spacing + 0.005)
        assert below == label
    assert len({(ax.get_xlim(), ax.get_ylim()) for ax in shown}) == 1


def test_all_that_stays_in_the_scene_is_in_view(column):
    film = film_of(column)
    low_x, high_x, low_z, high_z = film.view()
    points = np.concatenate([film.corners(i, b) for i in range(film.time.size) for b in range(3)])
    assert low_x < points[:, 0].min() and points[:, 0].max() < high_x
    assert low_z < points[:, 1].min() and points[:, 1].max() < high_z


def test_bad_requests_are_refused_by_name(column):
    with pytest.raises(ValueError, match=r"time=99\.0 s: want 0 to"):
        frames(column, [99.0])
    with pytest.raises(ValueError, match=r"times=\[\]"):
        frames(column, [])
    with pytest.raises(ValueError, match="labels: 1 for 2 times"):
        frames(column, [0.0, 1.0], labels=["a"])
    with pytest.raises(ValueError, match="columns=0"):
        frames(column, [0.0], columns=0)
    with pytest.raises(ValueError, match="without x, z, theta, outline_x"):
        film_of(xr.Dataset())
    spoilt = column.to_xarray().copy(deep=True)
    spoilt.theta[5, 1] = math.nan
    with pytest.raises(ValueError, match="theta of body 1 is nan at sample 5"):
        film_of(spoilt)
