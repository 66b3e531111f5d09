"""`python -m studies.campaigns`: table, pictures, one sentence for what cannot be used."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from studies.campaigns import read, write
from studies.campaigns.__main__ import main
from studies.campaigns.drawing import figure
from studies.campaigns.summary import look
from studies.running.files import BadInputError

from .conftest import read_only


def test_table_has_a_row_for_each_test(folder, capsys):
    main([str(folder / "campaign.toml")])
    out = capsys.readouterr().out
    rows = {line.split("  ")[0].strip(): line.split() for line in out.splitlines()}
    assert "alpha=0.2915 rad, p=" in out
    for id in ("free-01", "ramp-3Hz", "ramp-4Hz", "named é", "ahead", "free-p"):
        assert id in rows
    assert out.count("to predict") == 2 and rows["named é"][-1] == "stood"
    # 0.19 rad of atan(0.3) = 0.2915.
    assert rows["free-01"][8] == "0.652"
    # Six seconds at 250 Hz.
    assert rows["ramp-3Hz"][2:5] == ["6", "0.004", "1501"]
    channel = rows["rotation"]
    assert channel[3] == "0.0002" and 1.8e-4 < float(channel[4]) < 2.2e-4
    assert "warning: rotation has gaps of up to 20 samples (named é)" in out


def test_pictures_are_drawn(folder, tmp_path, capsys):
    main([str(folder), "--plot", str(tmp_path / "pictures")])
    drawn = sorted(p.name for p in (tmp_path / "pictures").iterdir())
    assert drawn == sorted(f"{id}.png" for id in ("free-01", "ramp-3Hz", "ramp-4Hz", "named é", "ahead", "free-p"))
    assert all((tmp_path / "pictures" / name).read_bytes().startswith(b"\x89PNG") for name in drawn)


def test_picture_shows_what_was_measured(campaign, folder):
    again = read(folder)
    drawing = figure(look(again.test("ramp-4Hz"), again), again)
    labels = [axes.get_ylabel() for axes in drawing.axes]
    assert labels == ["rotation [rad]", "base acceleration [m/s²]", "on the block [m/s²]"]


def test_oddities_are_named(campaign, tmp_path, capsys):
    test = campaign.test("ramp-3Hz")
    railed = read_only(np.clip(test.base_x, -4.0, 4.0))
    slow = test.rotation.copy()
    slow[1::2] = np.nan
    odd = replace(test, id="odd", data={"rotation": read_only(slow), "base_x": railed})
    loud = tuple(replace(c, noise=0.02) if c.name == "rotation" else c for c in campaign.channels)
    tests = tuple(replace(t, channels=tuple(c for c in loud if c.name in t.data)) for t in (odd, test))
    write(replace(campaign, channels=loud, tests=tests), tmp_path)
    main([str(tmp_path)])
    out = capsys.readouterr().out
    assert f"{np.count_nonzero(np.abs(railed) == 4.0)} samples of base_x sit on a rail (odd)" in out
    assert "rotation was sampled at one in 2 lines (odd)" in out
    assert "channel 'rotation': its records show 0.0" in out and "times the declared noise" in out
    assert "it still rocks when the record stops (odd, ramp-3Hz)" in out


@pytest.mark.parametrize("arguments", [["nowhere.toml"], ["{folder}", "--plot", "{folder}/campaign.toml"]])
def test_what_cannot_be_used_is_one_sentence(folder, arguments):
    with pytest.raises(BadInputError, match="want") as caught:
        main([text.format(folder=folder) for text in arguments])
    assert "\n" not in str(caught.value)


def test_runs_as_a_module(folder):
    command = [sys.executable, "-m", "studies.campaigns", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, encoding="utf-8")
    assert "free-01" in done.stdout and done.stderr == ""
    (folder / "free-01.csv").write_text("time;rotation\n")
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and done.stderr.startswith("error: free-01.csv, line 1") and done.stdout == ""
