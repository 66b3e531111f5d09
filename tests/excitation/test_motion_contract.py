"""What must hold for every motion, whatever it is."""

import doctest
import json
import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest

import excitation as ex

T = np.linspace(-0.5, 7.0, 1501)


def test_same_numbers_for_an_array_and_for_one_time_at_a_time(any_motion):
    """Python floats in a namespace of plain scalars, as the readable solver calls it."""
    from rocking import scalars

    par = [float(v) for v in any_motion.parameters]
    one_by_one = np.array([any_motion.kernel(scalars, t, par) for t in T.tolist()])
    assert np.column_stack(any_motion(T)) == pytest.approx(one_by_one, rel=1e-13, abs=1e-13)
    pitch = np.array([any_motion.pitch_kernel(scalars, t, par) for t in T.tolist()])
    assert np.column_stack(any_motion.pitch(T)) == pytest.approx(pitch, rel=1e-13, abs=1e-13)


def test_same_numbers_traced_by_jax(any_motion):
    import jax

    with jax.enable_x64(True):
        par = jax.numpy.asarray(any_motion.parameters)

        def both(t, p):
            return any_motion.kernel(jax.numpy, t, p) + any_motion.pitch_kernel(jax.numpy, t, p)

        traced = jax.jit(jax.vmap(both, in_axes=(0, None)))(T, par)
        expected = np.array(any_motion(T) + any_motion.pitch(T))
        assert np.array(traced) == pytest.approx(expected, rel=1e-11, abs=1e-11)


def test_same_numbers_compiled_by_numba(any_motion):
    from numba import types

    from rocking.solvers.numba.compiling import bound

    signature = types.UniTuple(types.float64, 2)(types.float64, types.float64[::1])
    for kernel, expected in (
        (any_motion.kernel, any_motion(T)),
        (any_motion.pitch_kernel, any_motion.pitch(T)),
    ):
        function = bound(kernel, 2, signature)
        found = np.array([function(t, any_motion.parameters) for t in T.tolist()])
        assert found == pytest.approx(np.column_stack(expected), rel=1e-12, abs=1e-12)


def test_a_rocking_block_answers_alike_under_numba_and_scipy(any_motion):
    """Two solvers that share the formula and nothing else; impact times to 1e-6 s, as their tolerances allow."""
    import rocking

    system = rocking.Method1(rocking.Block(b=0.15, h=0.5), g=9.81)
    runs = [
        rocking.solve(system, any_motion, t_end=2.5, solver=name, rtol=1e-9, atol=1e-12) for name in ("numba", "scipy")
    ]
    first = min(4, *(len(run.impact_times) for run in runs))
    assert runs[0].impact_times[:first] == pytest.approx(runs[1].impact_times[:first], abs=1e-6)
    assert runs[0].outcome == runs[1].outcome


def test_breakpoints_ascend_and_the_motion_is_continuous_between_them(any_motion):
    points = any_motion.breakpoints
    assert list(points) == sorted(points)
    edges = np.array([-0.4, *points, 7.0])
    for a, b in pairwise(edges):
        t = a + (b - a) * np.array([1e-9, 0.3, 0.7, 1.0 - 1e-9])
        shift = 1e-8 * (b - a)
        here, there = np.array(any_motion(t[1:3])), np.array(any_motion(t[1:3] + shift))
        # Slopes stay below 1e4 m/s^3 in every motion here.
        assert np.max(np.abs(here - there)) < 1e4 * shift


def test_times_that_are_not_finite_are_refused_by_every_motion(any_motion):
    for ask in (any_motion, any_motion.pitch):
        with pytest.raises(ValueError, match="want finite times"):
            ask([0.0, np.inf])


def test_times_that_are_no_numbers_are_refused_by_every_motion(any_motion):
    for ask in (any_motion, any_motion.pitch, any_motion.to_xarray):
        with pytest.raises(ValueError, match=r"^t='a': want numbers"):
            ask("a")
        with pytest.raises(ValueError, match=r"^t=\[\[1, 2\], \[3\]\]: want numbers"):
            ask([[1, 2], [3]])


def test_dataset_states_units_and_gives_the_motion_back(any_motion, tmp_path):
    """By way of a NetCDF file."""
    import xarray as xr

    t = getattr(any_motion, "times", T)
    any_motion.to_xarray(t).to_netcdf(tmp_path / "motion.nc")
    with xr.open_dataset(tmp_path / "motion.nc") as file:
        ds = file.load()
    assert {name: ds[name].attrs["units"] for name in ds.variables if ds[name].dims == ("time",)} == {
        "time": "s", "a_x": "m s-2", "a_z": "m s-2", "pitch": "rad", "pitch_acceleration": "rad s-2",
    }  # fmt: skip
    assert all("units" in ds[name].attrs for name in ds.variables)  # samples of what is inside too
    again = ex.from_xarray(ds)
    middle = 0.5 * (t[1:] + t[:-1])
    assert np.array(again(middle)) == pytest.approx(np.array(any_motion(middle)), rel=1e-9, abs=1e-9)
    found, expected = (np.array(motion.pitch(middle)) for motion in (again, any_motion))
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert again == any_motion and repr(again) == repr(any_motion)


def test_every_kind_of_motion_is_tried_here(motions):
    """All that the package exports, so that nothing escapes the tests above."""
    kinds = {kind for kind in vars(ex).values() if isinstance(kind, type) and issubclass(kind, ex.Motion)}
    abstract = {ex.Motion, ex.CentredPulse, ex.FinitePulse}
    assert kinds - abstract == {type(motion) for motion in motions.values()}
    assert set(ex.formulas().values()) == kinds - abstract - {ex.SampledMotion, ex.PiecewiseLinear}


def test_a_dataset_of_a_formula_whose_samples_were_changed_is_refused(motions):
    ds = motions["combined, pitching"].to_xarray(T)
    for name in ("a_x", "a_z", "pitch", "pitch_acceleration"):
        changed = ds.copy(deep=True)
        changed[name].values[700] += 0.1
        with pytest.raises(ValueError, match=f"{name}: is not that of Combined"):
            ex.from_xarray(changed)


def test_a_recipe_without_its_samples_is_refused(motions):
    ds = motions["combined with samples"].to_xarray(T)
    assert {"horizontal_a_x", "horizontal_pitch"} <= set(ds.variables)
    with pytest.raises(ValueError, match=r"motion_arguments=.*: want the arguments of Combined as JSON"):
        ex.from_xarray(ds.drop_vars("horizontal_a_x"))
    del ds["horizontal_a_x"].attrs["units"]
    with pytest.raises(ValueError, match="horizontal_a_x: has units None"):
        ex.from_xarray(ds)


def test_the_first_five_minutes_are_as_the_package_says(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert doctest.testmod(ex).failed == 0 and doctest.testmod(ex).attempted > 10


def test_importing_the_package_loads_numpy_alone():
    code = "import json, sys; import excitation; print(json.dumps(sorted({m.split('.')[0] for m in sys.modules})))"
    loaded = json.loads(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout)
    assert not {"scipy", "xarray", "matplotlib", "obspy", "numba", "jax", "pandas"} & set(loaded)
