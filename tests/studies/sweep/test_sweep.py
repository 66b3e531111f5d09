"""Sweeps carried out: numbers, chunks, interruption by kill -9, a cluster whose worker is killed."""

import json
import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from rocking import Block, Method1, solve
from rocking.closed_forms import half_sine_pulse
from studies.criteria.overturning import Settings, overturning
from studies.sweep import Sweep, run
from studies.sweep.chunks import boxes, count_boxes
from studies.sweep.evaluation import DECLINED, FELL, STANDS

sys.path.insert(0, str(Path(__file__).parents[1]))
from cf import by_checker, problems

RAMP = {"ramp": {"kind": "ramped_sinusoid", "duration": 10.0, "final_amplitude": 20.0}}
DECLARED = """
[axes]
method = ["dem"]
slenderness = [0.2, 0.3]
frequency = [1.0, 1.5, 2.0, 2.5]

[excitations.ramp]
kind = "ramped_sinusoid"
duration = 40.0
final_amplitude = 20.0
"""


@pytest.mark.parametrize(
    ("shape", "points"), [((3, 4, 5), 7), ((3, 4, 5), 1), ((3, 4, 5), 1000), ((7,), 3), ((2, 1, 9), 4)]
)
def test_boxes_cover_every_point_once(shape, points):
    seen = np.zeros(shape, int)
    covered = list(boxes(shape, points))
    for box in covered:
        assert math.prod(b - a for a, b in box) <= points
        seen[tuple(slice(*pair) for pair in box)] += 1
    assert (seen == 1).all()
    assert len(covered) == count_boxes(shape, points)


# West: (b/h) g starts the rocking of a block of any size.  That of 4 m, 716 kg, leans on the springs of its corners
# (19.8 MN/m) by up to 0.35 mm before, 7 times what is off the floor.
def test_distinct_elements_start_to_rock_at_west_s_acceleration_whatever_their_size(tmp_path):
    gentle = {"ramp": {"kind": "ramped_sinusoid", "duration": 5.0, "final_amplitude": 8.0}}
    sweep = Sweep(
        axes={"method": ["dem"], "h": [0.5, 4.0]}, excitations=gentle,
        fixed={"slenderness": 0.3, "friction": 0.7, "frequency": 1.0},
    )  # fmt: skip
    with run(sweep, tmp_path / "s.nc", progress=False) as ds:
        started = ds.rocking_amplitude.sel({"method": "dem"}).values
    # The ramp grows by 1.6 m/s^2 in a cycle: the first half of one whose peak is above West's is at most 0.8 later.
    assert np.all(started > 0.3 * 9.80665)
    assert np.all(started < 0.3 * 9.80665 + 0.8)


# Coulomb: of a friction below b/h the block slides and never rocks, under 60 m/s^2 of a half sine beyond ten metres.
def test_a_block_of_distinct_elements_that_only_slides_stands_however_far_it_goes(tmp_path):
    pulse = {"pulse": {"kind": "HalfSinePulse", "highest": 60.0, "steps": 4, "bisections": 1}}
    sweep = Sweep(
        axes={"method": ["dem", "method2"], "slenderness": [1.6]}, excitations=pulse,
        fixed={"excitation": "pulse", "h": 0.5, "friction": 0.7, "frequency": 1.0},
    )  # fmt: skip
    with run(sweep, tmp_path / "s.nc", progress=False) as ds:
        assert ds.outcome.values.ravel().tolist() == [STANDS, STANDS]
        assert np.isnan(ds.rocking_amplitude.values).all()


def test_points_are_what_single_runs_give(tmp_path):
    sweep = Sweep(
        axes={"method": ["method1", "method2"], "frequency": [1.0, 2.0], "slenderness": [0.2, 0.3]}, excitations=RAMP
    )
    with run(sweep, tmp_path / "s.nc", progress=False, chunk_points=3) as ds:
        assert ds.overturning_amplitude.dims == ("method", "frequency", "slenderness")
        for method in ("method1", "method2"):
            for frequency in (1.0, 2.0):
                single = overturning(
                    method, Block(0.15, 0.5, 0.25, density=597.0), frequency, Settings(ramp=20.0, duration=10.0)
                )
                at = ds.sel({"method": method}).sel(frequency=frequency, slenderness=0.3)
                assert float(at.overturning_amplitude) == pytest.approx(single.amplitude, rel=1e-9, nan_ok=True)


def test_the_dataset_keeps_cf(tmp_path):
    sweep = Sweep(axes={"method": ["method1", "method2"], "friction": [0.5, 0.6]}, excitations=RAMP)
    run(sweep, tmp_path / "s.nc", progress=False).close()
    assert problems(tmp_path / "s.nc") == []
    pytest.importorskip("compliance_checker", reason="want compliance-checker, of the extra test")
    assert by_checker(tmp_path / "s.nc") == []


def test_a_pulse_fells_at_the_closed_form(tmp_path):
    # Linear Method 1 under half a sine, theta'' from rest at g alpha in the formula, at (b/h) g here: slender blocks,
    # for which the two differ by less than 0.1 %.
    sweep = Sweep(
        axes={"frequency": [0.5, 1.0]},
        fixed={"slenderness": 0.05, "excitation": "pulse"},
        excitations={"pulse": {"kind": "HalfSinePulse", "highest": 20.0, "steps": 60}},
    )
    with run(sweep, tmp_path / "s.nc", progress=False) as ds:
        block = Block(0.025, 0.5)
        for frequency in (0.5, 1.0):
            # The period of a half-sine pulse here is that of the whole sine.
            expected = half_sine_pulse(2.0 * math.pi * frequency / block.p()) * 9.80665 * block.alpha
            found = float(ds.overturning_amplitude.sel(frequency=frequency))
            assert found == pytest.approx(expected, rel=2e-3)


def test_least_amplitude_of_a_pulse_is_between_standing_and_falling(tmp_path):
    from excitation import OneSinePulse

    sweep = Sweep(
        axes={"frequency": [1.0]}, fixed={"excitation": "pulse"},
        excitations={"pulse": {"kind": "OneSinePulse", "highest": 30.0}},
    )  # fmt: skip
    with run(sweep, tmp_path / "s.nc", progress=False) as ds:
        found = ds.overturning_amplitude.item()
    for factor, falls in ((1.0 - 1e-5, False), (1.0 + 1e-5, True)):
        motion = OneSinePulse(amplitude=factor * found, period=1.0)
        assert solve(Method1(Block(0.15, 0.5), form="linear"), motion, t_end=11.0).overturned is falls


def test_a_large_block_is_watched_until_it_is_down(tmp_path):
    """20/p of a block of 25 m is 26 s; six seconds after the pulse the slow ones are still on their way."""
    from excitation import HalfSinePulse

    sweep = Sweep(
        axes={"h": [0.5, 25.0]}, fixed={"slenderness": 0.2, "frequency": 1.0, "excitation": "pulse"},
        excitations={"pulse": {"kind": "HalfSinePulse"}}, run={"form": "nonlinear"},
    )  # fmt: skip
    with run(sweep, tmp_path / "s.nc", progress=False, workers=1) as ds:
        found = float(ds.overturning_amplitude.sel(h=25.0))
    for factor, falls in ((1.0 - 1e-5, False), (1.0 + 1e-5, True)):
        motion = HalfSinePulse(amplitude=factor * found, period=1.0)
        whole = solve(Method1(Block(5.0, 25.0), form="nonlinear"), motion, t_end=90.0, solver="scipy", save_at=())
        assert whole.overturned is falls


def test_what_does_not_fall_and_what_is_declined_is_flagged(tmp_path):
    weak = {"ramp": {"kind": "ramped_sinusoid", "duration": 5.0, "final_amplitude": 2.0}}
    sweep = Sweep(axes={"method": ["method1", "dem"], "restitution": [0.5, 1.0]}, excitations=weak)
    with run(sweep, tmp_path / "s.nc", progress=False) as ds:
        assert ds.outcome.sel({"method": "method1"}).values.tolist() == [STANDS, STANDS]
        assert ds.outcome.sel({"method": "dem"}).values.tolist() == [2, STANDS]
        assert "dem: restitution=" in json.loads(ds.attrs["declined"])[0]
        assert np.isnan(ds.overturning_amplitude).all()


# The exact solver carries linear Method 1 under ramps alone (`rocking.solvers.exact`): what is left must not look like
# blocks that stand.
@pytest.mark.parametrize(
    ("excitation", "outcomes"),
    [
        ({"kind": "ramped_sinusoid", "duration": 20.0, "final_amplitude": 20.0}, [FELL, DECLINED]),
        ({"kind": "OneSinePulse", "highest": 30.0, "steps": 4}, [DECLINED, DECLINED]),
    ],
)
def test_what_a_solver_declines_does_not_stand_and_has_its_sentence(tmp_path, excitation, outcomes):
    sweep = Sweep(
        axes={"method": ["method1", "method2"], "frequency": [2.0]}, excitations={"ramp": excitation},
        run={"solver": "exact"},
    )  # fmt: skip
    with run(sweep, tmp_path / "s.nc", progress=False) as ds:
        assert ds.outcome.values.ravel().tolist() == outcomes
        reasons = json.loads(ds.attrs["declined"])
        assert "method2: solver='exact' declines: it carries linear Method 1 alone, not 'method2'" in reasons
        assert [reason.partition(":")[0] for reason in reasons] == ["method1", "method2"][-outcomes.count(DECLINED) :]


# Coulomb: a base that pushes a block horizontally no harder than mu g turns none whose b/h is larger; with more
# friction than b/h it rocks from (b/h) g = 2.942 m/s^2 on (West's formula).
@pytest.mark.parametrize(
    "excitation",
    [
        {"kind": "ramped_sinusoid", "duration": 20.0, "final_amplitude": 20.0},
        {"kind": "OneSinePulse", "highest": 30.0, "steps": 10},
    ],
)
def test_a_block_that_slides_does_not_begin_to_rock(tmp_path, excitation):
    sweep = Sweep(
        axes={"friction": [0.2, 0.5]}, fixed={"method": "method2", "frequency": 3.0}, excitations={"ramp": excitation}
    )
    with run(sweep, tmp_path / "s.nc", progress=False) as ds:
        slides, rocks = ds.rocking_amplitude.values
        assert np.isnan(slides)
        assert rocks == pytest.approx(0.3 * 9.80665, rel=2e-3)
        assert np.isnan(ds.rocking_time.values[0])


def _command(toml: Path, out: Path) -> list[str]:
    return [sys.executable, "-m", "studies.sweep", str(toml), "--out", str(out), "--chunk", "1", "--workers", "2"]


def _same(one: Path, other: Path) -> None:
    with xr.open_dataset(one) as a, xr.open_dataset(other) as b:
        a, b = a.load(), b.load()
    for ds in (a, b):
        for name in ("command", "commit", "history", "sources"):  # not of the result
            ds.attrs.pop(name)
    xr.testing.assert_identical(a, b)


@pytest.mark.slow
def test_after_kill_9_all_opens_and_the_same_command_goes_on_to_the_same_result(tmp_path):
    toml = tmp_path / "s.toml"
    toml.write_text(DECLARED)
    out, parts = tmp_path / "killed.nc", tmp_path / "killed.nc.parts"
    for chunks in (1, 4):
        child = subprocess.Popen(_command(toml, out), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = time.monotonic() + 300.0  # compiling on a machine that others share
        while len(list(parts.glob("chunk-*.nc"))) < chunks and child.poll() is None and time.monotonic() < end:
            time.sleep(0.002)
        os.kill(child.pid, signal.SIGKILL)
        assert child.wait() == -signal.SIGKILL
        assert not out.exists()
        for file in parts.glob("chunk-*.nc"):
            with xr.open_dataset(file) as ds:
                assert ds.outcome.dims == ("method", "slenderness", "frequency")
                assert ds.load().outcome.size == 1
    assert len(list(parts.glob("chunk-*.nc"))) >= 4
    done = subprocess.run(_command(toml, out), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert not parts.exists()
    assert subprocess.run(_command(toml, tmp_path / "whole.nc"), capture_output=True).returncode == 0
    _same(out, tmp_path / "whole.nc")
    with xr.open_dataset(out) as ds:
        assert int((ds.outcome == FELL).sum()) >= 6


def test_a_chunk_that_is_there_is_not_computed_again(tmp_path):
    sweep = Sweep(axes={"frequency": [1.0, 1.5, 2.0, 2.5]}, excitations=RAMP)
    done: list[int] = []

    def stop_after_two(number: int) -> None:
        done.append(number)
        if len(done) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(sweep, tmp_path / "s.nc", chunk_points=1, workers=1, progress=False, watch=stop_after_two)
    with run(sweep, tmp_path / "s.nc", chunk_points=1, workers=1, progress=False, watch=done.append):
        pass
    assert sorted(done) == [0, 1, 2, 3]


def test_another_sweep_in_the_same_place_is_refused(tmp_path):
    def stop(number: int) -> None:
        raise KeyboardInterrupt

    first = Sweep(axes={"frequency": [1.0, 1.5]}, excitations=RAMP)
    with pytest.raises(KeyboardInterrupt):
        run(first, tmp_path / "s.nc", chunk_points=1, workers=1, progress=False, watch=stop)
    with pytest.raises(ValueError, match="holds a sweep of another declaration; want the same, or remove it"):
        run(Sweep(axes={"frequency": [1.0, 2.5]}, excitations=RAMP), tmp_path / "s.nc", progress=False, chunk_points=1)
    with pytest.raises(ValueError, match="holds a sweep of another chunk size"):
        run(first, tmp_path / "s.nc", progress=False, chunk_points=2)


def test_a_damaged_chunk_is_named_removed_and_computed_again(tmp_path):
    sweep = Sweep(axes={"frequency": [1.0, 1.5, 2.0]}, excitations=RAMP)
    parts = tmp_path / "s.nc.parts"

    def damage(number: int) -> None:
        if number == 0:
            (parts / "chunk-000000000.nc").write_bytes(b"not a dataset")

    with pytest.raises(RuntimeError, match="was damaged and is removed"):
        run(sweep, tmp_path / "s.nc", chunk_points=1, workers=1, progress=False, watch=damage)
    with run(sweep, tmp_path / "s.nc", chunk_points=1, workers=1, progress=False) as ds:
        assert ds.sizes["frequency"] == 3


def test_workers_and_chunks_change_nothing_in_the_numbers(tmp_path):
    sweep = Sweep(axes={"method": ["method1", "method2"], "frequency": [1.0, 2.0, 3.0]}, excitations=RAMP)
    with run(sweep, tmp_path / "a.nc", workers=1, chunk_points=100, progress=False) as a:
        a.load()
    with run(sweep, tmp_path / "b.nc", workers=2, chunk_points=1, progress=False) as b:
        b.load()
    xr.testing.assert_equal(a, b)


CLUSTER = """
import os, signal, sys
from distributed import LocalCluster
from studies.sweep import read, run

def main():
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        killed = []
        def watch(number):
            if not killed:
                killed.append(next(iter(cluster.workers.values())).pid)
                os.kill(killed[0], signal.SIGKILL)
        with run(read(sys.argv[1]), sys.argv[2], scheduler=cluster.scheduler_address, chunk_points=1, progress=False,
                 watch=watch) as ds:
            print("killed", len(killed), "of", len(cluster.workers), "points", ds.outcome.size)

if __name__ == "__main__":
    main()
"""


@pytest.mark.slow
def test_a_worker_of_a_cluster_killed_on_the_way_changes_nothing(tmp_path):
    pytest.importorskip("distributed")
    toml, script = tmp_path / "s.toml", tmp_path / "cluster.py"
    toml.write_text(DECLARED)
    script.write_text(CLUSTER)
    done = subprocess.run(
        [sys.executable, str(script), str(toml), str(tmp_path / "cluster.nc")],
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert "killed 1" in done.stdout, done.stderr
    assert subprocess.run(_command(toml, tmp_path / "whole.nc"), capture_output=True).returncode == 0
    _same(tmp_path / "cluster.nc", tmp_path / "whole.nc")


@pytest.mark.slow
def test_no_scheduler_is_one_sentence(tmp_path):
    pytest.importorskip("distributed")
    toml = tmp_path / "s.toml"
    toml.write_text(DECLARED)
    command = [*_command(toml, tmp_path / "s.nc"), "--scheduler", "tcp://127.0.0.1:1"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith("error: scheduler='tcp://127.0.0.1:1': want the address of a dask")
