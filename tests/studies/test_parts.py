"""Runs that are kept: whole or not there after kill -9, never taken for another, shared, computed once."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from studies.running import parts as parts_module
from studies.running.parts import Parts, sources_hash


def square(job):
    square.calls += 1
    return {"number": job**2, "array": np.arange(3) * job, "text": f"job {job}"}


def test_what_was_kept_is_not_computed_again_and_is_the_same(tmp_path):
    square.calls = 0
    first = Parts(tmp_path, workers=1).results([1.5, 2.5], square, "a")
    assert square.calls == 2
    again = Parts(tmp_path, workers=1).results([2.5, 3.5, 1.5], square, "b")
    assert square.calls == 3
    for one, other in ((first[0], again[2]), (first[1], again[0])):
        assert one["number"] == other["number"] and isinstance(other["number"], float)
        assert one["text"] == other["text"] and isinstance(other["text"], str)
        assert np.array_equal(one["array"], other["array"])


def test_without_a_folder_nothing_is_kept(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    square.calls = 0
    for _ in range(2):
        Parts(None, workers=2).results([1.0], square, "a")
    assert square.calls == 2
    assert list(tmp_path.iterdir()) == []


def test_a_damaged_part_is_computed_again(tmp_path):
    square.calls = 0
    Parts(tmp_path, workers=1).results([1.0], square, "a")
    (part,) = (tmp_path / sources_hash()).glob("*.npz")
    part.write_bytes(part.read_bytes()[:100])
    (found,) = Parts(tmp_path, workers=1).results([1.0], square, "a")
    assert square.calls == 2
    assert found["number"] == 1.0


def test_what_no_job_says_is_refused(tmp_path):
    """Two ramps had shared runs, since the ramp stood in the function alone."""
    factor = 2.0
    with pytest.raises(TypeError, match=r"<lambda> takes factor from around it: want that in its jobs"):
        Parts(tmp_path).results([1.0], lambda job: {"number": factor * job}, "a")


def test_sources_are_those_that_a_run_reaches():
    """Modules of the studies that it imports, and those that these import; others leave it alone."""
    reached = {path.name for path in parts_module._reached("studies.fig05")}
    assert {"fit.py", "__init__.py", "free_vibration.py"} <= reached and "tracing.py" not in reached
    evaluation = {path.name for path in parts_module._reached("studies.sweep.evaluation")}
    assert {"evaluation.py", "declared.py", "overturning.py"} <= evaluation
    # By a dot as well.
    laboratory = {path.name for path in parts_module._reached("studies.laboratory")}
    assert {"event.py", "slip.py", "contact.py", "parameters.py"} <= laboratory
    assert sources_hash("studies.sweep.evaluation") != sources_hash("studies.fig05") != sources_hash()


def test_parts_of_other_sources_are_removed(tmp_path):
    (tmp_path / "0123456789abcdef").mkdir(parents=True)
    square.calls = 0
    parts = Parts(tmp_path, workers=1)
    parts.results([1.0], square, "a")
    parts.clear_outdated()
    assert [path.name for path in tmp_path.iterdir()] == [sources_hash()]


SLOW = """
import sys, time
from pathlib import Path
import numpy as np
from studies.running.parts import Parts

def work(job):
    time.sleep(0.05)
    return {"number": float(job), "array": np.full(20000, float(job))}

if __name__ == "__main__":
    found = Parts(Path(sys.argv[1]), workers=2).results(list(range(40)), work, "slow")
    print(sum(r["number"] for r in found))
"""


def test_kill_9_loses_no_finished_run_and_leaves_no_half_one(tmp_path):
    script, kept = tmp_path / "slow.py", tmp_path / "kept"
    script.write_text(SLOW)
    child = subprocess.Popen([sys.executable, str(script), str(kept)], stderr=subprocess.DEVNULL)
    end = time.monotonic() + 60.0
    while len(list(kept.rglob("[!.]*.npz"))) < 5 and time.monotonic() < end:
        time.sleep(0.005)
    os.kill(child.pid, signal.SIGKILL)
    child.wait()
    whole = {path: path.stat().st_mtime_ns for path in kept.rglob("[!.]*.npz")}
    assert 5 <= len(whole) < 40
    for path in whole:
        with np.load(path) as file:
            assert np.all(file["array"] == file["number"])
    done = subprocess.run([sys.executable, str(script), str(kept)], capture_output=True, text=True)
    assert done.stdout.strip() == str(float(sum(range(40))))
    assert all(path.stat().st_mtime_ns == when for path, when in whole.items())


@pytest.mark.slow
def test_a_killed_study_goes_on_and_ends_as_an_undisturbed_one(tmp_path):
    import xarray as xr

    def command(folder):
        return [sys.executable, "-m", "studies.fig18", "--quick", "--workers", "1", "--out", str(folder)]

    child = subprocess.Popen(command(tmp_path / "a"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    end = time.monotonic() + 120.0
    while len(list((tmp_path / "a").rglob("*.npz"))) < 2 and child.poll() is None and time.monotonic() < end:
        time.sleep(0.005)
    os.kill(child.pid, signal.SIGKILL)
    child.wait()
    for folder in ("a", "b"):
        assert subprocess.run(command(tmp_path / folder), capture_output=True).returncode == 0
    with xr.open_dataset(tmp_path / "a" / "fig18.nc") as a, xr.open_dataset(tmp_path / "b" / "fig18.nc") as b:
        xr.testing.assert_equal(a, b)
