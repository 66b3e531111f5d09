"""Batches on a device of JAX: the runs of the compiled batch to rounding, and no device that was not asked for."""

import math
from typing import Any

import jax
import numpy as np
import pytest

from excitation import PiecewiseLinear, RampedSinusoid
from rocking import Block, Method1, solve_batch
from rocking.maps import overturning_map
from rocking.solvers import devices
from rocking.solvers.exact import jax_batch
from rocking.solvers.exact.batch import RampedSines, ScaledRecord, exact_batch
from rocking.solvers.exact.jax_batch import carry_on_device
from rocking.solvers.taylor.batch import (
    COUNT,
    ENDED,
    FINISHED,
    FIRST,
    LARGEST,
    LAST_MODE,
    OVERTURNED,
    OVERTURNING,
    SIDE,
    carry_portions,
    parameter_row,
    start_rows,
)
from rocking.solvers.taylor.records import LARGEST_SAMPLE, SCALE, joined

RUNS = 400


def has_a_gpu() -> bool:
    return any(device.platform == "gpu" for device in jax.devices())


GPU = pytest.mark.skipif(not has_a_gpu(), reason="JAX finds no GPU")
ON = pytest.mark.parametrize("on", ["jax-cpu", pytest.param("gpu", marks=GPU)])


def shaking(seed: int, n: int) -> np.ndarray:
    """Random samples, smoothed a little, with a peak of 1."""
    raw = np.convolve(np.random.default_rng(seed).standard_normal(n + 4), np.ones(5) / 5.0, "valid")
    return raw / np.abs(raw).max()


def blocks(rng: np.random.Generator) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """(rows of parameters, start) of very slender to stocky blocks with restitution 0, 1 and between."""
    h, slenderness = 10.0 ** rng.uniform(-1.0, 1.0, RUNS), 10.0 ** rng.uniform(-1.7, -0.1, RUNS)
    e = rng.uniform(0.2, 1.0, RUNS)
    e[::17], e[5::17] = 0.0, 1.0
    pars = [
        parameter_row(Method1(Block(float(s * size), float(size)), form="linear", restitution=float(ratio)))
        for s, size, ratio in zip(slenderness, h, e, strict=True)
    ]
    released = np.arange(RUNS) % 3 == 0
    par = np.array(pars)
    theta = np.where(released, rng.uniform(-0.9, 0.9, RUNS) * par[:, 1], 0.0)
    return par, {"theta": theta, "omega": np.where(released, rng.uniform(-0.1, 0.1, RUNS) * np.sqrt(par[:, 0]), 0.0)}


def in_single_precision(on: str, pars: np.ndarray, samples: Any, starts: np.ndarray, motions: np.ndarray) -> None:
    """The falls of double precision; tilts and times of most runs to a few units of single."""
    compiled = carry_portions(
        "linear", samples, lambda a, b: [np.ascontiguousarray(t[a:b]) for t in (pars, starts, motions)], RUNS, 10**6
    )
    device = devices.jax_device(on)
    traced = carry_on_device(samples, pars, starts, motions, 10**6, device, precision="float32")
    for column in (OVERTURNED, SIDE, FINISHED):
        np.testing.assert_array_equal(traced[:, column], compiled[:, column])
    np.testing.assert_array_equal(np.isnan(traced), np.isnan(compiled))
    unit = np.finfo(np.float32).eps
    np.testing.assert_allclose(traced[:, FIRST], compiled[:, FIRST], rtol=8.0 * unit, atol=8.0 * unit)
    # Most to a few units; those of many impacts by as much as these multiply it.
    for column in (LARGEST, ENDED, OVERTURNING):
        assert np.nanquantile(np.abs(traced[:, column] - compiled[:, column]), 0.75) < 16.0 * unit
    # A chatter ends at a count that rounding decides for some.
    assert np.mean(traced[:, COUNT] != compiled[:, COUNT]) < 0.05
    # Were numbers of double precision carried along somewhere, rounding would not be that of single.
    assert np.max(np.abs(traced[:, LARGEST] - compiled[:, LARGEST])) > unit


def must_agree(
    on: str, pars: np.ndarray, samples: Any, starts: np.ndarray, motions: np.ndarray, lanes: int = jax_batch.MOST_LANES
) -> None:
    """The same outcomes and counts, and times and tilts to rounding, which each impact multiplies."""
    compiled = carry_portions(
        "linear", samples, lambda a, b: [np.ascontiguousarray(t[a:b]) for t in (pars, starts, motions)], RUNS, 10**6
    )
    traced = carry_on_device(samples, pars, starts, motions, 10**6, devices.jax_device(on), lanes)
    for column in (OVERTURNED, SIDE, COUNT, FINISHED, LAST_MODE):
        np.testing.assert_array_equal(traced[:, column], compiled[:, column])
    np.testing.assert_allclose(traced[:, FIRST], compiled[:, FIRST], rtol=0.0, atol=1e-11)
    for column in (OVERTURNING, LARGEST, ENDED):
        np.testing.assert_allclose(traced[:, column], compiled[:, column], rtol=0.0, atol=1e-7)
        # Most runs have few impacts, and differ by rounding alone.
        assert np.nanquantile(np.abs(traced[:, column] - compiled[:, column]), 0.9) < 1e-12
    assert 40 < compiled[:, OVERTURNED].sum() < RUNS - 40
    assert compiled[:, COUNT].mean() > 5.0


# Three records of different lengths and intervals, with a jump at either end, entered before them and within.
@pytest.mark.slow
@ON
def test_hundreds_of_runs_over_records_are_those_of_the_compiled_batch(on: str) -> None:
    rng = np.random.default_rng(0)
    pars, start = blocks(rng)
    records = [(np.array([rng.uniform(-0.5, 0.5), 0.01 * (1 + i)]), shaking(i, 200 * (i + 1))) for i in range(3)]
    samples, rows = joined(records)
    motions = rows[rng.integers(0, 3, RUNS)]
    motions[:, SCALE] = rng.uniform(0.2, 3.0, RUNS) * pars[:, 3] * pars[:, 2]
    t_start = np.where(np.arange(RUNS) % 5 == 0, 1.37, -0.6)
    t_end = t_start + rng.uniform(3.0, 9.0, RUNS)
    # Fewer lanes than runs: a lane takes one run after another.
    must_agree(on, pars, samples, start_rows(**start, t_start=t_start, t_end=t_end), motions, lanes=128)
    in_single_precision(on, pars, samples, start_rows(**start, t_start=t_start, t_end=t_end), motions)
    np.testing.assert_array_equal(rows[:, LARGEST_SAMPLE], 1.0)


@pytest.mark.slow
@ON
def test_hundreds_of_runs_over_sinusoids_are_those_of_the_compiled_batch(on: str) -> None:
    rng = np.random.default_rng(1)
    pars, start = blocks(rng)
    p, g_onset = np.sqrt(pars[:, 0]), pars[:, 2] * pars[:, 3]
    rate = g_onset * p * rng.uniform(0.1, 1.0, RUNS)
    motions = np.stack([p * rng.uniform(0.5, 6.0, RUNS), rng.uniform(-3.0, 3.0, RUNS), rate, 6.0 / p], axis=1)
    t_start = np.where(np.arange(RUNS) % 5 == 0, 1.37, -0.2) / p
    # Fewer lanes than runs, and below as many as there are runs.
    must_agree(on, pars, None, start_rows(**start, t_start=t_start, t_end=8.0 / p), motions, lanes=128)
    in_single_precision(on, pars, None, start_rows(**start, t_start=t_start, t_end=8.0 / p), motions)


# What a GPU compiles is lowered here for one, which wants no GPU: no operation is used that it does not have.
@pytest.mark.parametrize("wave", [True, False])
@pytest.mark.parametrize("precision", devices.PRECISIONS)
def test_the_program_lowers_for_a_gpu(wave: bool, precision: str) -> None:
    with jax.enable_x64(True):
        table = jax.ShapeDtypeStruct((100, 6), precision)
        motions = jax.ShapeDtypeStruct((100, 4 if wave else 6), precision)
        runs = jax_batch.Runs(table, table, motions, jax.ShapeDtypeStruct((100, 9), precision))
        base = jax_batch.Base(*(jax.ShapeDtypeStruct((n,), precision) for n in (640, 20)))
        whole = jax.ShapeDtypeStruct((), np.int64)
        program = jax.export.export(jax_batch.carried, platforms=["cuda"])(runs, base, whole, wave=wave, width=128)
    assert program.platforms == ("cuda",)
    # A number of double precision among single ones would be slow, and make all after it double.
    assert ("xf64" in str(program.mlir_module())) == (precision == "float64")


def test_the_device_is_recorded_and_the_cpu_unless_asked_for_otherwise() -> None:
    still = ScaledRecord(np.zeros(2), 1.0)
    batch = exact_batch(still, p=5.0, alpha=0.2, e=0.9, theta=[0.01, 0.1], t_end=3.0)
    np.testing.assert_array_equal(batch.device, ["cpu", "cpu"])
    system = Method1(Block(0.2, 0.8), form="linear")
    motion = PiecewiseLinear(0.1, [0.0, 4.0, 0.0])
    assert solve_batch(system, motion, t_end=1.0, solver="exact").device == "cpu"
    assert solve_batch(system, motion, t_end=1.0, solver="taylor").to_xarray().attrs["device"] == "cpu"


def test_a_map_on_a_device_of_jax_is_the_map_and_says_where_it_was_made() -> None:
    def build(frequency: float, amplitude: float) -> Any:
        return Method1(Block(0.15, 0.5), form="linear"), RampedSinusoid(frequency, 3.0, amplitude)

    # As many runs as above, so that what was compiled there serves.
    axes = {"frequency": np.linspace(0.8, 4.0, 20), "amplitude": np.linspace(1.0, 30.0, RUNS // 20)}
    compiled = overturning_map(build, axes, t_end=3.0, solver="exact", device="cpu")
    traced = overturning_map(build, axes, t_end=3.0, solver="exact", device="jax-cpu")
    assert (compiled.attrs["device"], traced.attrs["device"]) == ("cpu", "jax-cpu: cpu")
    assert 40 < int(compiled.overturned.sum()) < RUNS - 40
    for name in ("overturned", "side", "impacts", "outcome"):
        np.testing.assert_array_equal(traced[name], compiled[name])
    for name in ("peak_rotation", "overturning_time", "onset_time", "t_end"):
        # Rounding, multiplied by the impacts: the solvers exact and taylor differ by 9e-11 on one of these runs.
        np.testing.assert_allclose(traced[name], compiled[name], rtol=0.0, atol=1e-9)


def test_a_gpu_is_taken_unasked_for_many_runs_alone_and_only_where_there_is_one(monkeypatch: Any) -> None:
    monkeypatch.setattr(devices, "jax_device", lambda name: name)
    monkeypatch.setattr(devices, "has_gpu", lambda: True)
    assert devices.chosen(None, 10**6) == "gpu"
    assert (devices.chosen(None, 10**5), devices.chosen("cpu", 10**6)) == (None, None)
    monkeypatch.setattr(devices, "has_gpu", lambda: False)
    assert devices.chosen(None, 10**6) is None


@pytest.mark.skipif(has_a_gpu(), reason="there is a GPU here")
def test_a_gpu_that_is_not_there_is_refused() -> None:
    with pytest.raises(ValueError, match=r"device='gpu': JAX finds none here"):
        exact_batch(RampedSines(12.0, 1.0, 10.0), p=5.0, alpha=0.2, e=0.9, t_end=1.0, device="gpu")
    with pytest.raises(ValueError, match=r"device='gpu': JAX finds none here"):
        solve_batch(Method1(Block(0.2, 0.8)), theta=[0.1], t_end=1.0, solver="diffrax", device="gpu")


@GPU
def test_a_map_on_a_gpu_is_that_of_the_cpu() -> None:
    omega, rate = np.meshgrid(2.0 * math.pi * np.linspace(0.5, 5.0, 80), np.linspace(0.3, 4.0, 80))
    same: dict[str, Any] = {"p": 5.5, "alpha": 0.29, "e": 0.87, "t_end": 10.0}
    one, other = (exact_batch(RampedSines(omega, rate, 10.0), device=name, **same) for name in ("cpu", "gpu"))
    assert other.device.flat[0].startswith("gpu")
    # A run on the verge of falling may differ: rounding decides.
    assert np.mean(one.overturned != other.overturned) < 1e-3
    single = exact_batch(RampedSines(omega, rate, 10.0), device="gpu", precision="float32", **same)
    assert single.device.flat[0].endswith("float32")
    assert np.all(single.finished)
    assert np.mean(one.overturned != single.overturned) < 1e-2


# Blocks of both methods released and shaken, one loop of JAX on the GPU; the CPU's is tested against other solvers.
@GPU
@pytest.mark.parametrize("form", ["linear", "nonlinear"])
def test_runs_of_diffrax_on_a_gpu_are_those_of_the_cpu(form: Any) -> None:
    heights = np.linspace(0.4, 0.8, 64)
    systems = [Method1(Block(0.15, float(h)), form=form) for h in heights]
    motions = [RampedSinusoid(1.5, 3.0, float(a)) for a in np.linspace(2.0, 30.0, 64)]
    sharp: dict[str, Any] = {"t_end": 3.0, "rtol": 1e-11, "atol": 1e-14, "solver": "diffrax"}
    one, other = (solve_batch(systems, motions, device=name, **sharp) for name in ("jax-cpu", "gpu"))
    assert other.device.startswith("gpu")
    assert 5 < one.overturned.sum() < 60
    np.testing.assert_array_equal(other.outcome, one.outcome)
    for name in ("overturning_time", "peak_rotation", "onset_time", "t_end"):
        # Errors of 1e-11 grow over some ten impacts.
        np.testing.assert_allclose(getattr(other, name), getattr(one, name), rtol=0.0, atol=1e-6, err_msg=name)


def test_single_precision_is_refused_where_it_does_not_serve_and_written_on_what_it_made() -> None:
    wave: dict[str, Any] = {"motion": RampedSines(12.0, 1.0, 10.0), "alpha": 0.2, "e": 0.9, "t_end": 1.0}
    made = exact_batch(p=5.0, device="jax-cpu", precision="float32", **wave)
    assert made.device == "jax-cpu: cpu, float32"
    with pytest.raises(ValueError, match=r"precision='float32': the compiled code of the CPU knows float64 alone"):
        exact_batch(p=5.0, precision="float32", **wave)
    with pytest.raises(ValueError, match=r"precision='float16': want one of float64, float32"):
        exact_batch(p=5.0, device="jax-cpu", precision="float16", **wave)
    with pytest.raises(ValueError, match=r"precision='float32': does not hold 1e\+40, want 'float64'"):
        exact_batch(p=1e20, device="jax-cpu", precision="float32", **wave)
    with pytest.raises(ValueError, match=r"precision='float32': does not hold 1e-40"):
        exact_batch(p=1e-20, device="jax-cpu", precision="float32", **wave)
    # The tail of a pulse is zero, and no reason to refuse it.
    t = np.linspace(-10.0, 10.0, 1001)
    pulse: dict[str, Any] = {"motion": ScaledRecord(6.0 * np.exp(-2.0 * t * t), 0.02), "alpha": 0.2, "e": 0.9}
    one, other = (
        exact_batch(p=5.0, t_end=20.0, **how, **pulse) for how in ({}, {"device": "jax-cpu", "precision": "float32"})
    )
    assert other.peak_rotation == pytest.approx(one.peak_rotation, abs=1e-5)
    assert other.impacts == one.impacts


def test_a_device_is_refused_by_solvers_of_the_cpu_and_by_other_names() -> None:
    system = Method1(Block(0.2, 0.8), form="linear")
    with pytest.raises(ValueError, match=r"device='gpu': solver 'taylor' knows the CPU alone; want 'exact'"):
        solve_batch(system, theta=[0.1], t_end=1.0, solver="taylor", device="gpu")
    with pytest.raises(ValueError, match=r"device='tpu': want one of cpu, gpu, jax-cpu"):
        solve_batch(system, theta=[0.1], t_end=1.0, solver="exact", device="tpu")
