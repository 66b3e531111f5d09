"""Faults of disks and files, each really made: full, read-only, cut, foreign; links, devices and clocks.

A file is whole or as it was before; what was computed is kept; the sentence names the file and says what to do.
"""

import errno
import os
import random
import subprocess
import sys
import time

import faults
import files
import numpy as np
import pytest
import xarray as xr

import excitation as ex
from studies.running.command_line import said_of
from studies.running.files import BadInputError, clear_unfinished, load_dataset, save_dataset, save_text, write_whole
from studies.running.lock import alone
from studies.running.parts import Parts, sources_hash
from studies.running.study import there_already

RECORD = ex.Record(0.01, np.sin(0.1 * np.arange(40_000)), source="made")
LARGE = xr.Dataset({"a": (("x", "y"), np.random.default_rng(1).random((500, 500)))})


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def figure():
    from studies.running.plot import new_figure

    return new_figure(20.0, 20.0)


WRITERS = {
    "text": ("a.txt", lambda path: save_text("x" * 2_000_000, path)),
    "dataset": ("a.nc", lambda path: save_dataset(LARGE, path)),
    "figure": ("a.png", lambda path: write_whole(path, lambda t: figure().savefig(t, format="raw", dpi=100))),
    "record": ("a.csv", lambda path: ex.write(path, RECORD, "columns")),
    "run": ("a.npz", lambda path: Parts(path.parent)._keep(path, {"a": LARGE.a.values})),
}


@pytest.mark.parametrize("kind", WRITERS)
def test_on_a_full_disk_a_file_stays_as_it_was(kind, tmp_path):
    name, write = WRITERS[kind]
    with faults.disk(tmp_path / "small", "1m") as small:
        (small / name).write_bytes(b"as it was")
        for _ in range(2):  # a second try in the same process fares no worse
            with pytest.raises(OSError) as caught:
                write(small / name)
            assert caught.value.errno == errno.ENOSPC and caught.value.filename == str(small / name)
            sentence = said_of(caught.value, "finished runs are kept")
            assert f"{name}: cannot be read or written (No space left on device); make room and run it" in sentence
        assert contents(small) == {name: b"as it was"}


def test_after_room_was_made_the_same_process_goes_on(tmp_path):
    with faults.disk(tmp_path / "small", "3m") as small:
        (small / "ballast").write_bytes(bytes(2_500_000))
        with pytest.raises(OSError, match="No space left"):
            save_dataset(LARGE, small / "a.nc")
        (small / "ballast").unlink()
        small_one = LARGE.isel(x=slice(0, 40))
        save_dataset(small_one, small / "a.nc")
        xr.testing.assert_identical(load_dataset(small / "a.nc"), small_one)


def test_runs_that_were_finished_before_the_disk_was_full_are_kept(tmp_path):
    def work(job):
        return {"a": np.full(25_000, float(job))}  # 200 kB

    with faults.disk(tmp_path / "small", "1m") as small:
        with pytest.raises(OSError, match="No space left"):
            Parts(small, workers=1).results(list(range(8)), work, "full")
        kept = list((small / sources_hash()).glob("*.npz"))
        assert 3 <= len(kept) <= 5 and not list(small.rglob(".*"))
        for path in kept:
            with np.load(path) as file:
                assert file["a"].size == 25_000


@pytest.mark.parametrize("kind", WRITERS)
def test_on_a_disk_that_cannot_be_written_to_the_sentence_says_so(kind, tmp_path):
    name, write = WRITERS[kind]
    with faults.disk(tmp_path / "small", "1m") as small:
        (small / name).write_bytes(b"as it was")
        faults.read_only(small)
        with pytest.raises(OSError) as caught:
            write(small / name)
        said = said_of(caught.value, "nothing was written")
        assert name in said and ("Read-only file system" in said or "Permission denied" in said)
        assert contents(small) == {name: b"as it was"}


def test_a_folder_that_cannot_be_written_to_is_refused_before_any_work(tmp_path, capsys, monkeypatch):
    import bad_commands

    with faults.disk(tmp_path / "small", "1m") as small:
        places = bad_commands.Places(tmp_path)
        faults.read_only(small)
        monkeypatch.chdir(small)
        campaign, sweep = str(places.folder / "campaign"), str(places.folder / "sweep.toml")
        for name, argv in {
            "fig18": ["--quick", "--out", "."], "studies": ["all", "--out", "."], "sweep": [sweep, "--out", "s.nc"],
            "loop": [campaign, "--out", "."], "campaigns": [campaign, "--plot", "."],
            "trials": ["--quick", "--out", "."],
        }.items():  # fmt: skip
            status, said = bad_commands.MAINS[name](argv, capsys)
            assert status == 2 and "want a folder that can be written to (Read-only file system)" in said, (name, said)


def damaged(data, seed):
    """Cut somewhere, or some bytes changed, or a stretch of zeros, as a disk leaves after a power cut."""
    rng = random.Random(seed)
    kind, place = seed % 3, rng.randrange(len(data))
    if kind == 0:
        return data[:place]
    if kind == 1:
        return data[:place] + bytes(min(4096, len(data) - place)) + data[place + 4096 :]
    changed = bytearray(data)
    for _ in range(1 + rng.randrange(20)):
        changed[rng.randrange(len(changed))] = rng.randrange(256)
    return bytes(changed)


@pytest.mark.slow
def test_a_damaged_dataset_is_computed_again_and_never_a_traceback(tmp_path):
    path = tmp_path / "a.nc"
    rows = np.random.default_rng(2).random((40, 40))
    ds = xr.Dataset({"a": (("x", "y"), rows)}, attrs={"inputs": "x", "study": "made"})
    save_dataset(ds, path)
    whole = path.read_bytes()
    assert there_already(path, "x").identical(load_dataset(path))
    unread = 0
    for seed in range(120):
        path.write_bytes(damaged(whole, seed))
        found = there_already(path, "x")
        unread += found is None
        assert found is None or np.array_equal(found.a.values, rows)  # what is cut off may be the checksum alone
    assert unread > 110


def test_a_damaged_run_is_computed_again_and_never_taken_for_whole(tmp_path):
    def work(job):
        return {"number": job**2, "array": np.arange(300) * job, "text": f"job {job}"}

    good = Parts(tmp_path, workers=1).results([2.0], work, "a")[0]
    (part,) = (tmp_path / sources_hash()).glob("*.npz")
    whole = part.read_bytes()
    for seed in range(150):
        part.write_bytes(damaged(whole, seed))
        found = Parts(tmp_path, workers=1).results([2.0], work, "a")[0]
        assert found["number"] == good["number"] and found["text"] == good["text"], seed
        assert np.array_equal(found["array"], good["array"]), seed


def test_what_a_killed_run_left_is_removed_by_the_next(tmp_path):
    (tmp_path / ".a.4711-0.nc").write_bytes(b"half")
    (tmp_path / ".other.4711-0.nc").write_bytes(b"of another")
    with alone(tmp_path / "a.nc"):
        clear_unfinished(tmp_path / "a.nc")
    assert [path.name for path in tmp_path.iterdir()] == [".other.4711-0.nc"]


def test_a_link_is_followed_and_a_device_stays_one(tmp_path):
    (tmp_path / "far").mkdir()
    (tmp_path / "a.txt").symlink_to(tmp_path / "far" / "b.txt")
    save_text("text", tmp_path / "a.txt")
    assert (tmp_path / "a.txt").is_symlink() and (tmp_path / "far" / "b.txt").read_text() == "text"
    os.mkfifo(tmp_path / "pipe")
    reader = os.open(tmp_path / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    save_text("through", tmp_path / "pipe")
    assert os.read(reader, 100) == b"through" and (tmp_path / "pipe").is_fifo()
    os.close(reader)


LOCKING = """
import sys, time
from pathlib import Path
from studies.running.lock import alone
with alone(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(float(sys.argv[2]))
print("left", flush=True)
"""


def test_two_runs_on_one_target_take_turns_and_kill_9_leaves_no_lock(tmp_path, capsys):
    target = tmp_path / "a.nc"
    script = tmp_path / "locking.py"
    script.write_text(LOCKING)
    child = faults.started([sys.executable, str(script), str(target), "600"])
    assert child.stdout.readline() == "held\n"
    held = pytest.raises(BadInputError, match=f"process {child.pid} is writing it; wait until it is done, or")
    with held, alone(target, wait=False):
        pass
    second = faults.started([sys.executable, str(script), str(target), "0"])
    assert second.stderr.readline() == f"{target}: waiting for process {child.pid}, which is writing it\n"
    faults.killed(child)
    assert second.stdout.readline() == "held\n"
    second.communicate(timeout=60)
    with alone(target, wait=False):
        pass
    assert not list(tmp_path.glob(".*"))


def squared(job):
    squared.calls.append(job)
    return {"number": job**2}


@pytest.mark.parametrize("hours", [-24 * 365 * 30, 24 * 365 * 30])
def test_a_clock_that_jumps_changes_nothing(hours, tmp_path, monkeypatch):
    """Times of files decades off, and a clock that goes on from there: what is whole is known by what it holds."""
    squared.calls = []
    Parts(tmp_path, workers=1).results([1.0, 2.0], squared, "a")
    save_dataset(files.dataset(), tmp_path / "a.nc")
    now = time.time
    for path in tmp_path.rglob("*"):
        os.utime(path, (now() + 3600.0 * hours,) * 2)
    monkeypatch.setattr(time, "time", lambda: now() - 3600.0 * hours)
    found = Parts(tmp_path, workers=1).results([1.0, 2.0, 3.0], squared, "b")
    assert [row["number"] for row in found] == [1.0, 4.0, 9.0] and squared.calls == [1.0, 2.0, 3.0]
    assert there_already(tmp_path / "a.nc", "x") is not None


def test_a_reader_that_has_enough_of_a_list_gets_no_traceback(tmp_path):
    """`python -m studies | head -1`: the pipe closes while the list is printed."""
    child = faults.started(faults.command("studies"))
    child.stdout.close()
    assert child.wait(timeout=240) in (0, 1)
    assert child.stderr.read() == ""
    child.stderr.close()


def test_dev_full_is_told_from_a_full_disk_by_its_name():
    if not os.path.exists("/dev/full"):
        pytest.skip("no /dev/full")
    done = subprocess.run(
        [sys.executable, "-c", "from studies.running.command_line import run\n"
         "from studies.running.files import save_text\n"
         "from pathlib import Path\n"
         "run(lambda argv: save_text('x' * 10**6, Path('/dev/full')), 'finished runs are kept')"],
        capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 1 and os.path.exists("/dev/full")
    assert done.stderr.startswith("error: ") and "No space left on device" in done.stderr
    assert done.stderr.rstrip().endswith("make room and run it again: finished runs are kept")
