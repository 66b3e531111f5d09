"""Batches: every run is the run that `solve` gives."""

import math
import os
import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from excitation import OneSinePulse, PiecewiseLinear, RampedSinusoid
from rocking import Block, Method1, Method2, solve, solve_batch
from rocking.motion import Still
from rocking.solvers.diffrax.runs import groups

MOTIONS = [RampedSinusoid(f, 6.0, a) for f in (0.8, 2.0, 4.0) for a in (2.0, 8.0, 25.0)]
SYSTEMS = {
    "linear": lambda b, h: Method1(Block(b, h), form="linear"),
    "nonlinear": lambda b, h: Method1(Block(b, h)),
    "method2": lambda b, h: Method2(Block(b, h), friction=0.5, normal_restitution=0.2),
}


def same(single, batch, i):
    assert batch.overturned[i] == single.overturned
    assert batch.side[i] == single.side
    assert batch.impacts[i] == len(single.impact_times)
    for name in ("peak_rotation", "overturning_time", "onset_time", "t_end"):
        assert np.array_equal(getattr(batch, name)[i], getattr(single, name), equal_nan=True), name


@pytest.mark.parametrize("kind", SYSTEMS)
def test_every_run_of_a_batch_is_the_single_run_bit_for_bit(kind):
    systems = [SYSTEMS[kind](0.1 + 0.02 * i, 0.5) for i in range(len(MOTIONS))]
    batch = solve_batch(systems, MOTIONS, t_end=6.0)
    assert len(set(batch.outcome.tolist())) >= 2  # some fall and some do not, or the test says little
    for i, (system, motion) in enumerate(zip(systems, MOTIONS, strict=True)):
        same(solve(system, motion, t_end=6.0, save_at=()), batch, i)


# The taylor solver carries a batch in the lanes of vectors and counts the end of a chatter instead of following it.
@pytest.mark.parametrize("form", ["linear", "nonlinear"])
def test_every_run_of_a_batch_by_taylor_is_the_single_run_bit_for_bit(form):
    systems = [Method1(Block(0.1 + 0.02 * i, 0.5), form=form) for i in range(len(MOTIONS))]
    batch = solve_batch(systems, MOTIONS, t_end=6.0, solver="taylor")
    assert len(set(batch.outcome.tolist())) >= 2
    for i, (system, motion) in enumerate(zip(systems, MOTIONS, strict=True)):
        same(solve(system, motion, t_end=6.0, save_at=(), solver="taylor"), batch, i)


def test_records_sinusoids_and_rest_go_in_one_batch():
    time = np.arange(0.0, 5.0, 0.01)
    records = [PiecewiseLinear(0.01, a * np.sin(9.0 * time) * np.sin(0.7 * time)) for a in (3.0, 9.0)]
    motions = [records[0], MOTIONS[4], records[1], Still(), records[0], MOTIONS[5]]
    tilts = [0.0, 0.0, 0.0, 0.05, -0.1, 0.02]
    batch = solve_batch(BLOCK, motions, t_end=6.0, theta=tilts, solver="taylor")
    for i, (motion, theta) in enumerate(zip(motions, tilts, strict=True)):
        same(solve(BLOCK, motion, theta=theta, t_end=6.0, save_at=(), solver="taylor"), batch, i)


# Rounding, multiplied by the impacts: the few of these runs leave 1e-9 of it.
def test_every_run_of_a_batch_by_exact_is_the_single_run_to_rounding():
    systems = [SYSTEMS["linear"](0.1 + 0.02 * i, 0.5) for i in range(len(MOTIONS))]
    batch = solve_batch(systems, MOTIONS, t_end=3.0, solver="exact")
    for i, (system, motion) in enumerate(zip(systems, MOTIONS, strict=True)):
        single = solve(system, motion, t_end=3.0, save_at=(), solver="exact")
        assert (batch.side[i], batch.impacts[i]) == (single.side, len(single.impact_times))
        for name in ("peak_rotation", "overturning_time", "onset_time", "t_end"):
            assert getattr(batch, name)[i] == pytest.approx(getattr(single, name), abs=1e-9, nan_ok=True), name


def test_free_runs_start_from_the_tilts_given():
    block = Block(0.2, 0.8)
    tilts = np.array([-0.2, 0.05, 0.1, 0.25])
    batch = solve_batch(Method1(block), t_end=5.0, theta=tilts)
    # The largest tilt is that of the release, but for the one beyond alpha = 0.245, which falls.
    assert batch.peak_rotation[:3] == pytest.approx(np.abs(tilts[:3]), rel=1e-15)
    assert batch.overturned.tolist() == [False, False, False, True]
    assert batch.side.tolist() == [0, 0, 0, 1]
    for i, theta in enumerate(tilts):
        same(solve(Method1(block), t_end=5.0, theta=float(theta), save_at=()), batch, i)


def test_number_of_cores_changes_no_bit():
    code = (
        "import numba, sys; numba.set_num_threads(int(sys.argv[1]))\n"
        "from rocking import *; from excitation import RampedSinusoid\n"
        "motions = [RampedSinusoid(1.0 + 0.1 * i, 5.0, 12.0) for i in range(24)]\n"
        "r = solve_batch(Method1(Block(0.15, 0.5)), motions, t_end=5.0)\n"
        "print(r.peak_rotation.tobytes().hex(), r.impacts.tolist())\n"
    )
    # Whatever the tests themselves were given.
    told = {**os.environ, "NUMBA_NUM_THREADS": "2"}
    said = [
        subprocess.run([sys.executable, "-c", code, n], capture_output=True, text=True, env=told) for n in ("1", "2")
    ]
    assert [s.returncode for s in said] == [0, 0], said[1].stderr
    assert said[0].stdout == said[1].stdout


def test_summary_goes_to_xarray_with_units():
    ds = solve_batch(Method1(Block(0.2, 0.8)), MOTIONS, t_end=6.0).to_xarray(
        {"frequency": ("run", [1.0] * len(MOTIONS))}
    )
    assert ds.sizes == {"run": len(MOTIONS)}
    assert ds.peak_rotation.attrs["units"] == "rad"
    assert "frequency" in ds.coords


BLOCK = Method1(Block(0.2, 0.8))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: solve_batch([], t_end=1.0), "systems: none given"),
        (lambda: solve_batch([BLOCK] * 2, MOTIONS, t_end=1.0), "systems: 2 of them, want 1 or 9"),
        (lambda: solve_batch(BLOCK, t_end=0.0), r"t_end=0\.0 s"),
        (lambda: solve_batch(BLOCK, t_end=1.0, theta=[0.1, math.nan]), "theta: want finite numbers"),
        (lambda: solve_batch(BLOCK, t_end=1.0, theta=[0.1, 2.0]), r"theta=.*2\.0.* rad: want between"),
        (lambda: solve_batch(BLOCK, MOTIONS, t_end=1.0, theta=[0.1, 0.2]), r"theta: shape \(2,\), want"),
        (
            lambda: solve_batch(BLOCK, t_end=1.0, solver="scipy"),
            "solver='scipy': it has no batch; want 'numba', 'taylor', 'exact' or 'diffrax'",
        ),
        (
            lambda: solve_batch([BLOCK, Method1(Block(0.2, 0.8), form="linear")], t_end=1.0, solver="diffrax"),
            "systems, motions: want them of one method",
        ),
        (
            lambda: solve_batch(BLOCK, t_end=1.0, solver="exact"),
            "solver='exact' declines: it carries the linear Method 1",
        ),
        (
            lambda: solve_batch(BLOCK, [MOTIONS[0], OneSinePulse(1.0, 1.0)], t_end=1.0, solver="taylor"),
            "solver='taylor' declines: OneSinePulse has no closed form",
        ),
        (
            lambda: solve_batch(
                [BLOCK, Method1(Block(0.2, 0.8), form="linear")], MOTIONS[:2], t_end=1.0, solver="taylor"
            ),
            "systems: want them of one method and form",
        ),
        (
            lambda: solve_batch([BLOCK, Method1(Block(0.2, 0.8), form="linear")], MOTIONS[:2], t_end=1.0),
            "systems: want them of one method and form",
        ),
        (
            lambda: solve_batch(BLOCK, [MOTIONS[0], RampedSinusoid(1.0, 2.0, 3.0, imperfection=0.1)], t_end=1.0),
            "motions: want them of one kind",
        ),
    ],
)
def test_bad_argument_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()


# Blocks that differ, sinusoids that differ, and starts at rest, released and pushed: one loop of JAX carries them all.
@pytest.mark.slow
def test_a_batch_by_diffrax_is_that_of_numba() -> None:
    systems = [Method1(Block(0.15, h), restitution=e) for h, e in ((0.5, 0.9), (0.6, 0.8), (0.5, 0.95), (0.4, 0.9))]
    motions = [RampedSinusoid(f, 3.0, a) for f, a in ((1.0, 2.0), (1.5, 9.0), (2.0, 5.0), (3.0, 30.0))]
    start = {"theta": [0.0, 0.0, -0.1, 0.0], "omega": [0.0, 0.0, 0.0, 0.3]}
    sharp = {"t_end": 3.5, "rtol": 1e-12, "atol": 1e-15}
    one, other = (solve_batch(systems, motions, solver=name, **sharp, **start) for name in ("numba", "diffrax"))
    assert 0 < one.overturned.sum() < 4
    assert other.device.startswith(("jax-cpu: cpu", "gpu: "))
    for name in ("outcome", "side", "impacts"):
        np.testing.assert_array_equal(getattr(other, name), getattr(one, name), err_msg=name)
    # Errors of 1e-12 grow over some ten impacts.
    for name in ("overturning_time", "peak_rotation", "onset_time", "t_end"):
        np.testing.assert_allclose(getattr(other, name), getattr(one, name), rtol=0.0, atol=1e-7, err_msg=name)
    alone = solve_batch(systems[1], motions[1], solver="diffrax", **sharp)
    assert alone.impacts.tolist() == [one.impacts[1]]
    assert alone.peak_rotation[0] == pytest.approx(one.peak_rotation[1], abs=1e-7)


# One compiled loop serves all groups of a batch; a few runs are not filled up to hundreds.
@pytest.mark.parametrize(("count", "sizes"), [(1, [1]), (3, [4]), (200, [256]), (300, [256, 256]), (600, [256] * 3)])
def test_on_a_cpu_diffrax_runs_groups_of_one_size_the_last_filled_up_with_the_last_run(count, sizes):
    with jax.default_device(jax.devices("cpu")[0]):
        found = [np.asarray(group) for group in groups(jnp.arange(count), True, count)]
    assert [rows.size for rows in found] == sizes
    np.testing.assert_array_equal(np.concatenate(found), np.minimum(np.arange(sum(sizes)), count - 1))
