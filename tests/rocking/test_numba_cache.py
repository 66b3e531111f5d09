"""Compiled code is kept on disk: found again by the next process, and never older than the physics."""

import importlib
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest
from numba import types

import rocking
from rocking.solvers.numba import batch, compiling, counter, windows
from rocking.solvers.numba.compiling import _digest, bound_motion

RUN = {
    "method1": "Method1(Block(0.2, 0.8), g=9.81)",
    "method2": "Method2(Block(0.2, 0.8), friction=1.2, normal_restitution=0.5, g=9.81)",
}


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A copy of the package, without any cache, in a folder to put on the path."""
    source = Path(rocking.__file__).parent
    shutil.copytree(source, tmp_path / "rocking", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path


def second_impact(folder: Path, method: str, before: str = "") -> float:
    """Time of the second impact of free rocking, from a process of its own that imports the copy.

    before: what the process does between the imports and the run.
    """
    code = (
        f"import rocking; from rocking import *; import rocking.solvers.numba.solver\n{before}\n"
        f"assert rocking.__file__.startswith({str(folder)!r}), rocking.__file__\n"
        f"print(solve({RUN[method]}, theta=0.12, t_end=1.5, solver='numba').impact_times[1].hex())"
    )
    return float.fromhex(printed(folder, code))


def printed(folder: Path, code: str) -> str:
    """What a process of its own prints that has `folder` first on its path."""
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    environment.pop("NUMBA_CACHE_DIR", None)
    result = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stderr
    return result.stdout.strip()


def cache_files(folder: Path) -> dict[str, int]:
    """Cache files and when each was written."""
    return {p.name: p.stat().st_mtime_ns for p in folder.rglob("*.nb[ci]")}


def edit(path: Path, old: str, new: str) -> None:
    """Replace a text that occurs once."""
    text = path.read_text()
    assert text.count(old) == 1, f"{old!r} occurs {text.count(old)} times in {path.name}"
    path.write_text(text.replace(old, new))


# With p^2 doubled every time of free rocking shrinks by sqrt(2): theta'' = -p^2 (...), time enters through p t alone.
@pytest.mark.slow
def test_method_1_is_compiled_once_and_again_when_its_physics_is_edited(package: Path) -> None:
    first = second_impact(package, "method1")
    compiled = cache_files(package)
    assert compiled
    assert second_impact(package, "method1") == first
    assert cache_files(package) == compiled, "the second process compiled something again"
    edit(
        package / "rocking" / "method1.py",
        "return rotating * y[1], -rotating * (par.p2 / par.g * (q.s * A_z * sin + A_x * xp.cos(psi)) + pitching)",
        "return rotating * y[1], -2.0 * rotating * (par.p2 / par.g * (q.s * A_z * sin + A_x * xp.cos(psi)) + pitching)",
    )
    # Solver tolerance of two runs: 1e-8.
    assert second_impact(package, "method1") == pytest.approx(first / 2.0**0.5, rel=1e-8)
    assert len(cache_files(package)) == len(compiled), "files of the old physics are left behind"


# The impulses of Method 2 stand in another file than the compiled functions that call them.
@pytest.mark.slow
def test_method_2_sees_an_edit_of_a_function_that_it_calls_from_another_file(package: Path) -> None:
    first = second_impact(package, "method2")
    compiled = cache_files(package)
    assert second_impact(package, "method2") == first
    assert cache_files(package) == compiled, "the second process compiled something again"
    # Without the e_n at the corner the block bounces no more.
    edit(
        package / "rocking" / "impacts.py",
        "    P_z = (1.0 + e_n) * p_one_z + (1.0 + e_t) * d_z\n",
        "    P_z = p_one_z + (1.0 + e_t) * d_z\n",
    )
    assert abs(second_impact(package, "method2") - first) > 1e-4
    assert len(cache_files(package)) == len(compiled), "files of the old physics are left behind"


MANY_RUNS = """
import sys
import numpy as np
import rocking
from rocking import Block, Method1, Method2, solve_batch
from rocking.effects import compose
from rocking.effects.viscous_damping import ViscousDamping
from rocking.motion import Still
from rocking.solvers.numba.windows import Start, run_windows

assert rocking.__file__.startswith(FOLDER), rocking.__file__
for effects in ((), (ViscousDamping(0.3),)):
    system = compose(METHOD, effects)
    print([theta.hex() for theta in solve_batch(system, theta=[0.1, 0.12], omega=0.2, t_end=0.7).peak_rotation])
    start = Start(0, 0, 0.0, 0.7, *system.initial_state(0.12, 0.0))
    print([theta.hex() for theta in run_windows([system], [Still()], [start], [np.array([0.5, 0.7])]).y[:, 0]])
"""


# A loop over runs that held compiled code of its own was kept by every process under a new key, and found by none.
@pytest.mark.slow
@pytest.mark.parametrize("method", ["Method1(Block(0.2, 0.8))", "Method2(Block(0.2, 0.8), friction=1.2)"])
def test_many_runs_are_compiled_once_with_effects_and_without(package: Path, method: str) -> None:
    code = MANY_RUNS.replace("METHOD", method).replace("FOLDER", repr(str(package)))
    first = printed(package, code)
    compiled = cache_files(package)
    assert any("batch_" in name for name in compiled)
    assert any("windows_" in name for name in compiled)
    assert printed(package, code) == first
    assert cache_files(package) == compiled, "the second process compiled something again"


@pytest.mark.slow
def test_what_is_edited_under_a_running_process_is_not_kept(package: Path) -> None:
    path = package / "rocking" / "method1.py"
    first = second_impact(package, "method1")
    for kept in package.rglob("*.nb[ci]"):
        kept.unlink()
    old = "return rotating * y[1], -rotating * (par.p2 / par.g * (q.s * A_z * sin + A_x * xp.cos(psi)) + pitching)"
    faster = old.replace("-rotating", "-2.0 * rotating")
    change = (
        "import pathlib, warnings\nwarnings.simplefilter('error')\n"
        f"warnings.filterwarnings('ignore', 'compiled code is not kept: .*method1.py was changed')\n"
        f"path = pathlib.Path({str(path)!r})\ntext = path.read_text()\nassert {old!r} in text\n"
        f"path.write_text(text.replace({old!r}, {faster!r}))"
    )
    assert second_impact(package, "method1", change) == first
    # Kept, the old physics would be found under the digest of the new.
    assert second_impact(package, "method1") == pytest.approx(first / 2.0**0.5, rel=1e-8)


def test_so_is_a_base_motion_of_another_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its file may have been imported at any time: what counts is whether it holds the functions that are in use."""
    path = tmp_path / "shaking_of_mine.py"
    path.write_text("def _wave(t):\n    return 2.0 * t\n\n\ndef kernel(xp, t, par):\n    return _wave(t), par[0]\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    kernel = importlib.import_module("shaking_of_mine").kernel
    signature = types.UniTuple(types.float64, 4)(types.float64, types.float64[::1])
    par = np.array([5.0])

    assert bound_motion(kernel, None, signature)(3.0, par) == (6.0, 5.0, 0.0, 0.0)
    kept = {p.name for p in tmp_path.rglob("*.nbi")}
    assert len(kept) == 1

    edit(path, "2.0 * t\n", "2.0 * t  # m/s^2\n")
    assert bound_motion(kernel, None, signature)(3.0, par) == (6.0, 5.0, 0.0, 0.0)

    edit(path, "2.0 * t ", "factor * t ")
    edit(path, "_wave(t):", "_wave(t, factor=4.0):")
    again = importlib.reload(importlib.import_module("shaking_of_mine")).kernel
    assert bound_motion(again, None, signature)(3.0, par) == (12.0, 5.0, 0.0, 0.0)
    # A default is no part of a function's code: here it is the digest that tells the two apart.
    edit(path, "factor=4.0", "factor=7.0")
    assert bound_motion(again, None, signature)(3.0, par) == (12.0, 5.0, 0.0, 0.0)
    later = importlib.reload(importlib.import_module("shaking_of_mine")).kernel
    assert bound_motion(later, None, signature)(3.0, par) == (21.0, 5.0, 0.0, 0.0)
    kernel, kept = later, {p.name for p in tmp_path.rglob("*.nbi")}

    edit(path, "factor * t ", "1.0 + factor * t ")
    with pytest.warns(RuntimeWarning, match=r"not kept: .*shaking_of_mine\.py was changed after this process began"):
        assert bound_motion(kernel, None, signature)(3.0, par) == (21.0, 5.0, 0.0, 0.0)
    assert {p.name for p in tmp_path.rglob("*.nbi")} <= kept


@pytest.mark.parametrize("module", [batch, windows])
def test_what_a_loop_takes_its_runs_with_is_among_its_sources(module: Any) -> None:
    """An intrinsic is no function, of which the digest would find the file."""

    def body(taken):
        return counting.take(taken)

    counting = module.counter
    assert _digest(body, [])[1] == sorted([__file__, counter.__file__, compiling.__file__])
