"""Overturning maps and rocking spectra."""

import doctest
import math

import numpy as np
import pytest

from excitation import OneSinePulse, RampedSinusoid
from rocking import Block, Method1, closed_forms, maps, solve
from rocking.maps import block_of, overturning_map, rocking_spectrum


def test_every_point_of_a_map_is_the_single_run():
    def build(frequency, b):
        return Method1(Block(b, 0.5)), RampedSinusoid(frequency, 5.0, 12.0)

    axes = {"frequency": [1.0, 2.0, 4.0], "b": [0.08, 0.15]}
    ds = overturning_map(build, axes, t_end=5.0, units={"frequency": "Hz", "b": "m"})
    assert ds.sizes == {"frequency": 3, "b": 2}
    assert ds.frequency.attrs["units"] == "Hz"
    for i, frequency in enumerate(axes["frequency"]):
        for j, b in enumerate(axes["b"]):
            run = solve(*build(frequency, b), t_end=5.0, save_at=())
            at = ds.isel(frequency=i, b=j)
            assert bool(at.overturned) == run.overturned
            assert float(at.peak_rotation) == run.peak_rotation
            assert int(at.impacts) == len(run.impact_times)


@pytest.mark.parametrize("solver", ["taylor", "exact"])
def test_a_map_by_a_fast_solver_is_that_of_its_single_runs(solver):
    form = "linear" if solver == "exact" else "nonlinear"

    def build(frequency, b):
        return Method1(Block(b, 0.5), form=form), RampedSinusoid(frequency, 5.0, 12.0)

    axes = {"frequency": [1.0, 2.0, 4.0], "b": [0.08, 0.15]}
    ds = overturning_map(build, axes, t_end=3.0, solver=solver)
    for i, frequency in enumerate(axes["frequency"]):
        for j, b in enumerate(axes["b"]):
            run, at = solve(*build(frequency, b), t_end=3.0, save_at=(), solver=solver), ds.isel(frequency=i, b=j)
            assert (bool(at.overturned), int(at.impacts)) == (run.overturned, len(run.impact_times))
            assert float(at.peak_rotation) == pytest.approx(run.peak_rotation, abs=1e-10)


def test_a_spectrum_goes_through_taylor():
    alpha, period = [0.15, 0.25], [1.0, 2.0, 3.0]
    fast, known = (
        rocking_spectrum(RampedSinusoid(2.0, 4.0, 4.0), period, alpha, t_end=4.0, solver=solver, rtol=1e-11, atol=1e-14)
        for solver in ("taylor", "numba")
    )
    assert fast.overturned.values.tolist() == known.overturned.values.tolist()
    assert fast.relative_rotation.values == pytest.approx(known.relative_rotation.values, rel=1e-5, nan_ok=True)


def test_map_of_the_full_sine_pulse_turns_over_where_theory_says():
    """The edge of the map against the closed form: overturning without an impact under one cycle of a sine."""
    block = Block(0.06, 0.80)  # slender, so that the linear block of the closed form is meant
    p, g_alpha = block.p(9.81), 9.81 * block.alpha
    ratio = 2.0
    edge = closed_forms.full_sine_pulse(ratio)
    frequency = ratio * p / (2.0 * math.pi)

    def build(amplitude):
        system = Method1(block, form="linear", onset="linear", g=9.81)
        return system, OneSinePulse(amplitude * g_alpha, 1.0 / frequency)

    amplitudes = edge * np.array([0.999, 1.001])
    ds = overturning_map(build, {"amplitude": amplitudes}, t_end=12.0)
    # Below the edge the block comes back with an impact first; above, it goes over without one.
    assert int(ds.impacts[0]) >= 1
    assert bool(ds.overturned[1]) and int(ds.impacts[1]) == 0


def test_block_of_p_and_alpha_has_them():
    block = block_of(2.5, 0.3, g=9.81)
    assert block.p(9.81) == pytest.approx(2.5, rel=1e-14)
    assert block.alpha == pytest.approx(0.3, rel=1e-14)


def test_spectrum_obeys_the_similarity_of_rocking_blocks():
    """Dimensional analysis: theta depends on p T and a / g; twice the periods under twice the duration is the same."""
    alpha = [0.15, 0.25]
    slow = rocking_spectrum(RampedSinusoid(1.0, 8.0, 4.0), [2.0, 4.0, 6.0], alpha, t_end=8.0, rtol=1e-11, atol=1e-14)
    fast = rocking_spectrum(RampedSinusoid(2.0, 4.0, 4.0), [1.0, 2.0, 3.0], alpha, t_end=4.0, rtol=1e-11, atol=1e-14)
    assert slow.relative_rotation.dims == ("period", "alpha")
    assert slow.overturned.values.tolist() == fast.overturned.values.tolist()
    # To the tolerance of the runs, which impacts magnify; where a block falls the ratio is NaN on both sides.
    assert slow.relative_rotation.values == pytest.approx(fast.relative_rotation.values, rel=1e-5, nan_ok=True)


def test_examples_run():
    assert doctest.testmod(maps).failed == 0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: overturning_map(lambda: None, {}, t_end=1.0), "axes: none given"),
        (lambda: overturning_map(lambda b: None, {"b": []}, t_end=1.0), "b: want finite numbers"),
        (lambda: overturning_map(lambda b: None, {"b": [math.nan]}, t_end=1.0), "b: want finite numbers"),
        (lambda: rocking_spectrum(RampedSinusoid(1.0, 1.0, 1.0), [0.0], [0.2], t_end=1.0), r"period=0\.0 s"),
        (lambda: rocking_spectrum(RampedSinusoid(1.0, 1.0, 1.0), [1.0], [2.0], t_end=1.0), r"alpha=2\.0 rad"),
        (lambda: block_of(-1.0, 0.2), r"p=-1\.0 rad/s"),
    ],
)
def test_bad_argument_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()
