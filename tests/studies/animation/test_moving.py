"""Moving pictures, and the command that makes them."""

import json
import shutil
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image, ImageChops

from studies.animation import film_of, moving, save
from studies.animation.__main__ import main
from studies.animation.moving import Stage, instants
from studies.animation.page import page
from studies.running.files import BadInputError, save_dataset


def test_a_gif_has_a_picture_for_each_instant_and_the_bodies_move(column, tmp_path):
    end = float(column.time[-1])
    save(column, tmp_path / "run.gif", start=end - 1.0, end=end, fps=10.0)
    with Image.open(tmp_path / "run.gif") as gif:
        assert gif.n_frames == 11 and gif.info["duration"] == 100 and gif.info["loop"] == 0
        pictures = []
        for frame in (0, 10):
            gif.seek(frame)
            pictures.append(gif.convert("RGB"))
    left = (0, 0, pictures[0].width // 2, pictures[0].height)
    changed = ImageChops.difference(*(picture.crop(left) for picture in pictures)).getbbox()
    assert changed is not None and changed[3] - changed[1] > 50


def test_patches_are_where_the_run_says_between_samples(column):
    film = film_of(column)
    stage = Stage(film, 0.0, 1.0)
    middle = 0.5 * (film.time[400] + film.time[401])
    stage.show(float(middle))
    for b, patch in enumerate(stage.patches):
        expected = 0.5 * (film.corners(400, b) + film.corners(401, b))
        # The middle of a chord lies off its arc by an eighth of the square of the turn.
        turn = film.theta[401, b] - film.theta[400, b]
        assert patch.get_xy()[:-1] == pytest.approx(expected, abs=0.125 * turn**2 * 0.27 + 1e-12)


def test_instants_cover_the_stretch_and_end_with_it(column):
    film = film_of(column)
    times = instants(film, 0.0, 1.0, speed=0.5, fps=7.0)
    assert times[0] == 0.0 and times[-1] == 1.0
    assert np.diff(times[:-1]) == pytest.approx(0.5 / 7.0)


def test_an_mp4_without_ffmpeg_says_what_is_missing(column, tmp_path, monkeypatch):
    monkeypatch.setattr(moving.FFMpegWriter, "isAvailable", classmethod(lambda cls: False))
    with pytest.raises(RuntimeError, match="needs the program ffmpeg"):
        save(column, tmp_path / "run.mp4")
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(shutil.which("ffprobe") is None, reason="no ffmpeg here: no MP4 is made")
def test_an_mp4_has_the_length_of_its_stretch(column, tmp_path):
    save(column, tmp_path / "run.mp4", start=0.0, end=1.0, speed=0.5, fps=10.0)
    asked = ["ffprobe", "-v", "error", "-show_streams", "-of", "json", str(tmp_path / "run.mp4")]
    (stream,) = json.loads(subprocess.run(asked, capture_output=True, text=True, check=True).stdout)["streams"]
    assert stream["codec_name"] == "h264" and stream["pix_fmt"] == "yuv420p"
    assert int(stream["nb_frames"]) == 21 and stream["width"] % 2 == 0 and stream["height"] % 2 == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"path": "run.avi"}, r"want a name that ends in \.html, \.gif or \.mp4"),
        ({"path": "nowhere/run.gif"}, "want a folder that is there"),
        ({"speed": 0.0}, r"speed=0\.0: want a positive number"),
        ({"fps": float("nan")}, "fps=nan"),
        ({"start": -1.0}, r"-1\.0 to .*: want a stretch within 0 to"),
        ({"start": 2.0, "end": 1.0}, r"2\.0 to 1\.0 s"),
    ],
)
def test_bad_requests_are_refused_before_any_work(column, tmp_path, arguments, message):
    arguments = {"path": "run.gif"} | arguments
    with pytest.raises(ValueError, match=message):
        save(column, **(arguments | {"path": tmp_path / arguments["path"]}))
    assert not list(tmp_path.iterdir())


def test_a_page_of_a_stretch_between_two_samples_is_refused(column, tmp_path):
    first, second = column.time[3:5]
    start, end = 0.75 * first + 0.25 * second, 0.25 * first + 0.75 * second
    with pytest.raises(ValueError, match=r" to .* s: want a stretch with a sample in it"):
        save(column, tmp_path / "run.html", start=start, end=end)
    assert not list(tmp_path.iterdir())
    film = film_of(column)
    with pytest.raises(ValueError, match=r"^film=<Film .* no time>: want at least one sample"):
        page(replace(film, time=film.time[:0], x=film.x[:0], z=film.z[:0], theta=film.theta[:0]))


def test_the_command_animates_a_saved_run(column, tmp_path, capsys):
    save_dataset(column.to_xarray(), tmp_path / "run.nc")
    main([str(tmp_path / "run.nc")])
    main([
        str(tmp_path / "run.nc"), "--out", str(tmp_path / "a.html"), "--out", str(tmp_path / "b.gif"), "--title",
        "Three blocks", "--end", "0.3",
    ])  # fmt: skip
    assert capsys.readouterr().out.count("wrote") == 3
    assert "<h1>Three blocks</h1>" in (tmp_path / "a.html").read_text(encoding="utf-8")
    assert (tmp_path / "run.html").stat().st_size > (tmp_path / "a.html").stat().st_size
    with Image.open(tmp_path / "b.gif") as gif:
        assert gif.n_frames == 7


def test_the_command_refuses_what_is_not_a_run(tmp_path):
    with pytest.raises(BadInputError, match="want the file of a saved run"):
        main([str(tmp_path / "none.nc")])
    (tmp_path / "other.nc").write_text("not a dataset")
    with pytest.raises(BadInputError):
        main([str(tmp_path / "other.nc")])
    done = subprocess.run(
        [sys.executable, "-m", "studies.animation", str(tmp_path / "none.nc")], capture_output=True, text=True
    )
    assert done.returncode == 2 and done.stderr.startswith("error: ") and "Traceback" not in done.stderr
