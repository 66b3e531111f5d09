"""Long commands that are cut off, and run where things are missing: each really done, in processes of their own.

Status   kill -9 of a sweep and of runs that are kept is in tests/studies/sweep and tests/studies/test_parts.py
"""

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import faults
import files
import numpy as np
import pytest
import xarray as xr

from studies.running.files import load_dataset

QUICK = ["studies.fig18", "--quick", "--workers", "1"]


def whole(folder):
    """Every file that is not hidden can be read; the hidden ones that are left."""
    for path in folder.rglob("[!.]*.nc"):
        load_dataset(path)
    for path in folder.rglob("[!.]*.npz"):
        with np.load(path) as file:
            assert [file[name] for name in file.files]
    return sorted(path.name for path in folder.glob(".*") if path.is_file())


def kept(folder):
    return {path: path.stat().st_mtime_ns for path in folder.rglob("[!.]*.npz")}


def test_ctrl_c_is_one_line_and_130_and_keeps_what_was_computed(tmp_path):
    """Of a study and of a sweep, in the middle."""
    (tmp_path / "s.toml").write_text(files.SWEEP.replace("[1.0, 2.0]", str([1.0 + 0.01 * k for k in range(300)])))
    commands = {
        "study": (faults.command(*QUICK, "--out", tmp_path / "a"), "[!.]*.npz", "finished runs are kept"),
        "sweep": (
            faults.command("studies.sweep", tmp_path / "s.toml", "--out", tmp_path / "s.nc", "--chunk", "1"),
            "chunk-*.nc", "finished chunks are kept",
        ),
    }  # fmt: skip
    for name, (command, pattern, said) in commands.items():
        child = faults.started(command)
        faults.wait_for(lambda p=pattern: len(list(tmp_path.rglob(p))) >= 2, child)
        assert child.poll() is None, (name, child.communicate())
        os.killpg(child.pid, signal.SIGINT)
        _, err = child.communicate(timeout=240)
        assert child.returncode == 130, (name, err)
        assert err.strip().splitlines()[-1].startswith(f"interrupted: {said}, the same command goes on"), (name, err)
        assert "Traceback" not in err
    assert not (tmp_path / "a" / "fig18.nc").exists() and not (tmp_path / "s.nc").exists()
    assert whole(tmp_path / "a") == [] and len(kept(tmp_path / "a")) >= 2
    whole(tmp_path / "s.nc.parts")


@pytest.mark.parametrize(
    "command", [pytest.param((*QUICK, "--out"), id="study"), pytest.param(("excitation",), id="record")]
)
def test_ctrl_c_while_the_libraries_are_loaded_is_one_line(command, tmp_path):
    if not os.path.exists("/proc/self/maps"):
        pytest.skip("what a process has loaded cannot be seen on this system")
    child = faults.started(faults.command(*command, tmp_path))
    maps = Path(f"/proc/{child.pid}/maps")
    faults.wait_for(lambda: "numpy" in maps.read_text(), child)
    os.kill(child.pid, signal.SIGINT)
    _, err = child.communicate(timeout=120)
    assert child.returncode in (130, -signal.SIGINT)  # the same in a shell
    assert err == "interrupted: nothing was written\n" and list(tmp_path.iterdir()) == []


def test_ctrl_c_in_a_program_of_somebody_else_is_its_own(tmp_path):
    """A package that imports this one, run by `python -m`, hears a KeyboardInterrupt as ever."""
    (tmp_path / "theirs").mkdir()
    (tmp_path / "theirs" / "__init__.py").write_text("import excitation\n")
    (tmp_path / "theirs" / "run.py").write_text(
        "import signal\ntry:\n    signal.raise_signal(signal.SIGINT)\nexcept KeyboardInterrupt:\n    print('heard')\n"
    )
    child = faults.started(faults.command("theirs.run"), cwd=tmp_path)
    out, err = child.communicate(timeout=120)
    assert (child.returncode, out) == (0, "heard\n"), err


@pytest.mark.slow
def test_all_studies_killed_in_the_middle_go_on_where_they_were(tmp_path):
    out = tmp_path / "out"
    command = faults.command("studies", "all", "--only", "fig18", "fig19", "--quick", "--workers", "1", "--out", out)
    child = faults.started(command)
    faults.wait_for(lambda: (out / "fig18.nc").exists(), child)
    faults.killed(child)
    before = kept(out)
    stamp = (out / "fig18.nc").stat().st_mtime_ns
    whole(out)
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (out / "fig18.nc").stat().st_mtime_ns == stamp and "fig18.nc is there already" in done.stdout
    assert all(path.stat().st_mtime_ns == when for path, when in before.items())
    assert whole(out) == [] and {"index.html", "fig18.png", "fig19.nc"} <= {path.name for path in out.iterdir()}


@pytest.mark.slow
def test_two_runs_of_a_study_into_one_folder_give_what_one_gives(tmp_path):
    command = faults.command(*QUICK, "--out", tmp_path / "a")
    first = faults.started(command)
    # Whoever has the lock writes its number into it.
    faults.wait_for(lambda: any(lock.read_text() for lock in (tmp_path / "a").glob(".fig18.nc.lock")), first)
    # Held in the middle, so that the second surely comes while it is at work.
    os.killpg(first.pid, signal.SIGSTOP)
    second = faults.started(command)
    assert f"waiting for process {first.pid}" in second.stderr.readline()
    os.killpg(first.pid, signal.SIGCONT)
    outputs = [child.communicate(timeout=600) for child in (first, second)]
    assert [first.returncode, second.returncode] == [0, 0], outputs
    assert ["is there already" in out for out, _ in outputs] == [False, True]
    assert subprocess.run(faults.command(*QUICK, "--out", tmp_path / "b"), capture_output=True).returncode == 0
    xr.testing.assert_equal(load_dataset(tmp_path / "a" / "fig18.nc"), load_dataset(tmp_path / "b" / "fig18.nc"))
    assert whole(tmp_path / "a") == []


@pytest.mark.slow
def test_two_runs_of_a_sweep_into_one_file_and_one_of_them_killed(tmp_path):
    toml, out = tmp_path / "s.toml", tmp_path / "s.nc"
    toml.write_text(files.SWEEP)
    command = faults.command("studies.sweep", toml, "--out", out, "--chunk", "1", "--workers", "1")
    first = faults.started(command)
    faults.wait_for(lambda: bool(list((tmp_path / "s.nc.parts").glob("chunk-*"))), first)
    second = faults.started(command)
    if first.poll() is None:
        faults.killed(first)
    _, err = second.communicate(timeout=600)
    assert second.returncode == 0, err
    with xr.open_dataset(out) as ds:
        assert ds.sizes == {"method": 1, "frequency": 2, "slenderness": 2} and "outcome" in ds
    assert not (tmp_path / "s.nc.parts").exists() and not list(tmp_path.glob(".*"))


def told(child, way):
    """What it says at the end; told again after a while, since code that is being compiled may not hear Ctrl-C."""
    for _ in range(12):
        os.killpg(child.pid, way)
        try:
            return child.communicate(timeout=20)[1]
        except subprocess.TimeoutExpired:
            continue
    raise AssertionError("it goes on")


def measured(folder):
    """A campaign with three releases of a block with worn edges."""
    from rocking import Block, Method1, solve
    from rocking.effects import load
    from studies.campaigns import Campaign, Channel, Conditions, DeclaredBlock, Test, write

    rng, system = np.random.default_rng(3), Method1(Block(0.15, 0.5, 0.25, 600.0), restitution=0.92, g=9.81)
    channel, t, tests = Channel("rotation", "rotation", 2e-4), 0.005 * np.arange(400), []
    for lean in (0.2, -0.17, 0.23):
        run = solve(system, theta=lean, t_end=t[-1], save_at=t, effects=[load("rounded_edges")(radius=0.006)])
        rotation = run.theta + 2e-4 * rng.standard_normal(t.size)
        tests.append(Test(f"free{lean}", "free", t, (channel,), {"rotation": rotation}, initial_rotation=lean))
    block = DeclaredBlock(0.15, 0.5, 0.25, 11.25)
    return write(Campaign("made", block, Conditions(), (channel,), tuple(tests)), folder)


@pytest.mark.slow
def test_the_loop_killed_or_interrupted_keeps_its_fits_and_what_was_there_and_a_second_is_refused(tmp_path):
    campaign, out = measured(tmp_path / "campaign"), tmp_path / "out"
    out.mkdir()
    before = {"loop.json": "of before", "report.html": "of before"}
    for name, text in before.items():
        (out / name).write_text(text)
    command = faults.command("studies.loop", campaign, "--out", out)
    for way in (signal.SIGKILL, signal.SIGINT):
        child = faults.started(command)
        had = len(list(out.glob(".fits/*/[!.]*.npz")))
        faults.wait_for(lambda n=had: len(list(out.glob(".fits/*/[!.]*.npz"))) > n + 2, child)
        refused = subprocess.run(command, capture_output=True, text=True)
        assert refused.returncode == 2
        assert f"process {child.pid} is writing it; wait until it is done, or choose another" in refused.stderr
        assert child.poll() is None
        err = told(child, way)
        assert child.returncode == (130 if way == signal.SIGINT else -way)
        if way == signal.SIGINT:
            assert err.strip().splitlines()[-1].startswith("interrupted: what was in the folder of --out before is as")
        assert {
            path.name: path.read_text() for path in out.iterdir() if path.is_file() and path.name in before
        } == before
    kept = {path.name: path.stat().st_mtime_ns for path in out.glob(".fits/*/[!.]*.npz")}
    child = faults.started(command)
    faults.wait_for(lambda: len(list(out.glob(".fits/*/[!.]*.npz"))) > len(kept), child)
    found = {path.name: path.stat().st_mtime_ns for path in out.glob(".fits/*/[!.]*.npz")}
    assert all(found[name] == when for name, when in kept.items())  # none was done again
    assert child.communicate(timeout=600) and child.returncode == 0
    names = {"baseline.toml", "model.toml", "loop.json", "loop.nc", "report.html"}
    assert {path.name for path in out.iterdir()} == names
    fresh = subprocess.run(faults.command("studies.loop", campaign, "--out", tmp_path / "fresh"), capture_output=True)
    assert fresh.returncode == 0
    for name in ("baseline.toml", "model.toml", "loop.json"):
        assert (tmp_path / "fresh" / name).read_bytes() == (out / name).read_bytes(), name
    predict = faults.command("studies.loop", "predict", out / "model.toml", campaign, "--out", tmp_path / "ahead")
    assert subprocess.run(predict, capture_output=True).returncode == 0
    with xr.open_datatree(out / "loop.nc") as tree:
        assert "tests" in tree.children


@pytest.mark.slow
def test_trials_killed_in_the_middle_keep_their_rows_and_make_no_half_campaign(tmp_path):
    """The loop is stood in for by a program that sleeps: what is tried is the bed of trials."""
    program = tmp_path / "loop.py"
    program.write_text("import time; time.sleep(600)")
    command = faults.command("studies.loop_trials", "--effects", "null", "--out", tmp_path / "t", "--command",
                             f"{sys.executable} {program}")  # fmt: skip
    child = faults.started(command)
    case = tmp_path / "t" / "null-1001"
    faults.wait_for(lambda: (case / "loop.log").exists(), child, 600.0)
    made = {path: path.stat().st_mtime_ns for path in case.rglob("*.*") if path.is_file() and path.name != "loop.log"}
    assert any(path.name == "truth.toml" for path in made)
    os.killpg(child.pid, signal.SIGKILL)
    child.communicate()
    assert not (case / "row.json").exists()
    again = faults.started(command)
    (case / "loop.log").unlink()
    faults.wait_for(lambda: (case / "loop.log").exists(), again)
    os.kill(again.pid, signal.SIGINT)  # its child is told by it, not by the terminal
    _, err = again.communicate(timeout=120)
    assert again.returncode == 130, err
    assert err.strip().splitlines()[-1] == "interrupted: campaigns that were closed are kept, the same command goes on"
    assert all(path.stat().st_mtime_ns == when for path, when in made.items() if path.suffix in (".toml", ".csv"))


WITHOUT = "cannot be had on this system"
ANSWER = """
import warnings
warnings.simplefilter("error", ResourceWarning)
from studies.will_it_fall import main
main(["0.2", "0.8", "--pga", "2.5", "--period", "0.9"])
"""


def alone(script, *before, **environment):
    """A script in a process with almost nothing in its environment."""
    given = {"PATH": os.environ["PATH"], "PYTHONPATH": os.pathsep.join(filter(None, sys.path))} | environment
    command = [*before, sys.executable, "-c", script]
    return subprocess.run(command, capture_output=True, text=True, env=given, timeout=600)


@pytest.mark.slow
def test_without_a_network(tmp_path):
    """In a network of its own, which has no way out: nothing is asked of one."""
    if shutil.which("unshare") is None or subprocess.run(["unshare", "-n", "true"], capture_output=True).returncode:
        pytest.skip(f"a process without a network {WITHOUT}")
    done = subprocess.run(
        ["unshare", "-n", *faults.command(*QUICK, "--out", tmp_path)], capture_output=True, text=True, timeout=600
    )
    assert done.returncode == 0, done.stderr
    assert load_dataset(tmp_path / "fig18.nc").attrs["study"] == "fig18"


@pytest.mark.slow
def test_without_a_home_and_with_a_clock_of_1970():
    expected = alone(ANSWER, HOME=os.path.expanduser("~"))
    assert expected.returncode == 0, expected.stderr
    clock = "import time; time.time = lambda: 0.0; time.time_ns = lambda: 0\n"
    found = alone(clock + ANSWER, HOME="/proc/none")
    assert (found.returncode, found.stdout) == (0, expected.stdout), found.stderr


KERNEL = """
import dem
run = dem.simulate(dem.single_block(0.2, 0.8, 0.25, 597.0), t_end=0.001, mu=0.5, damping_ratio=0.1, dt=1e-5)
print(run.z[-1])
"""


@pytest.mark.slow
def test_installed_where_nothing_can_be_written_and_without_a_home(tmp_path):
    """The package on a disk that is read-only: compiled for this process alone, which a line says."""
    import dem

    package = os.path.dirname(os.path.dirname(dem.__file__))
    mount = f"mount --bind '{package}' '{package}' && mount -o remount,ro,bind '{package}' && exec \"$@\""
    way = ["unshare", "-m", "sh", "-c", mount, "sh"]
    if shutil.which("unshare") is None or subprocess.run([*way, "true"], capture_output=True).returncode:
        pytest.skip(f"a read-only copy {WITHOUT}")
    found = alone(KERNEL, *way, HOME="/proc/none")
    assert found.returncode == 0, found.stderr
    assert found.stdout == alone(KERNEL, HOME=os.path.expanduser("~")).stdout
    assert "compiled code is not kept" in found.stderr and "set NUMBA_CACHE_DIR to a folder that can" in found.stderr
