"""`python -m excitation`: facts, picture and sentences."""

import subprocess
import sys

import numpy as np
import pytest

import excitation as ex
from excitation.__main__ import main


@pytest.fixture
def file(tmp_path):
    """Two components of 4 s at 100 Hz."""
    from excitation.formats import columns

    t = 0.01 * np.arange(401)
    first = ex.Record(0.01, 3.0 * np.sin(2 * np.pi * t), component="N-S")
    columns.write(tmp_path / "made.csv", first, ex.Record(0.01, 0.5 * np.sin(2 * np.pi * t), component="UP"))
    return tmp_path / "made.csv"


def test_one_line_of_facts_a_component(file, capsys):
    assert main([str(file)]) == 0
    first, second = capsys.readouterr().out.splitlines()
    assert first.startswith(
        "made.csv [columns, m/s^2]  N-S (0 deg)  401 samples at 0.01 s = 4 s  PGA 3 m/s^2 (0.306 g)"
    )
    # 3 m/s^2 at 1 Hz: velocity from 0 to 2 * 3/(2 pi).
    assert "PGV 0.955 m/s" in first
    assert "UP" in second and "PGA 0.5 m/s^2" in second


def test_picture_is_a_png_of_four_axes(file, tmp_path, capsys):
    picture = tmp_path / "made.png"
    assert main([str(file), "--plot", str(picture)]) == 0
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert capsys.readouterr().out.endswith(f"{picture}\n")
    from excitation.plot import figure

    drawing = figure(ex.read(file))
    labels = {axes.get_ylabel().split(" [")[0].split(",")[0] for axes in drawing.axes}
    assert labels == {"acceleration", "velocity", "displacement", "pseudo-acceleration"}
    assert all(len(axes.lines) == 2 for axes in drawing.axes)


def test_picture_is_named_after_the_file_if_no_name_is_given(file, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main([str(file), "--plot"]) == 0
    assert (tmp_path / "made.csv.png").exists()


def test_an_offset_is_taken_out_and_said(tmp_path, capsys):
    path = tmp_path / "raw.csv"
    ex.write(path, ex.Record(0.01, 0.7 + np.sin(2 * np.pi * 0.01 * np.arange(400))), "columns")
    assert main([str(path)]) == 0
    out = capsys.readouterr().out
    assert "PGA 1 m/s^2" in out and "after an offset of 0.7 m/s^2 was taken out" in out


def test_names_in_a_file_do_not_drive_the_terminal(tmp_path, capsys):
    path = tmp_path / "made.csv"
    path.write_bytes("time [s],a\x9b31m\x0cb [g]\n0,1\n0.01,2\n".encode("latin-1"))
    assert main([str(path)]) == 0
    out = capsys.readouterr().out
    assert out.count("\n") == 1 and "\x9b" not in out and "\x0c" not in out


def test_units_can_be_stated(tmp_path, capsys):
    path = tmp_path / "plain.txt"
    path.write_text("0 0.1\n10 -0.2\n20 0.1\n")
    assert main([str(path), "--units", "g", "--time-units", "ms"]) == 0
    assert "PGA 1.961 m/s^2 (0.2 g)" in capsys.readouterr().out


@pytest.mark.parametrize(("name", "sentence"), [("damaged.AT2", "line 1"), ("missing.AT2", "No such file")])
def test_a_file_that_cannot_be_read_is_answered_with_a_sentence(tmp_path, capsys, name, sentence):
    (tmp_path / "damaged.AT2").write_text("Origin Time\nStation Code\n")
    assert main([str(tmp_path / name)]) == 2
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.count("\n") == 1
    assert name in captured.err and (sentence in captured.err or "line 2" in captured.err)


def test_runs_as_a_module(file):
    done = subprocess.run([sys.executable, "-m", "excitation", str(file)], capture_output=True, text=True, check=True)
    assert done.stdout.count("PGA") == 2
