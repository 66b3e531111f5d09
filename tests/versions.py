"""Run the tests with the lowest and the newest dependencies that pyproject.toml allows, in environments of their own.

    python tests/versions.py lowest newest                   all default tests, this Python
    python tests/versions.py lowest --python 3.12 --quick    a few tests of every package

`lowest` takes of each dependency named in pyproject.toml the lowest version that its bound, the other bounds and the
Python allow (of what these need in turn, the newest); `newest` takes the newest of all.  What was installed is printed.
Wants uv, and a network or a folder of wheels (UV_FIND_LINKS).
"""

from __future__ import annotations

import argparse
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# Each dependency is used by one of these, and each kernel is compiled.
QUICK = (
    "tests/excitation", "tests/dem/test_shapes.py", "tests/dem/test_energy.py", "tests/dem/test_assembly_runs.py",
    "tests/rocking/test_block.py", "tests/rocking/test_exact.py", "tests/rocking/test_method1_closed_forms.py",
    "tests/rocking/test_batch.py", "tests/rocking/test_diffrax_events.py", "tests/rocking/test_other_engines.py",
    "tests/rocking/test_fragility.py", "tests/rocking/effects/test_lagrange.py", "tests/studies/test_overturning.py",
    "tests/studies/test_analysis.py", "tests/studies/sweep", "tests/studies/loop/test_fitting.py",
)  # fmt: skip
# Taken as wheels alone: the lowest version of these is the lowest with one for this Python, not one to be built.
COMPILED = (
    "numpy", "scipy", "pillow", "matplotlib", "mujoco", "numba", "llvmlite", "netcdf4", "heyoka", "pymunk", "obspy",
    "lxml", "pandas",
)  # fmt: skip
SHOWN = (
    "numpy", "scipy", "jax", "jaxlib", "diffrax", "numba", "xarray", "netCDF4", "matplotlib", "pillow", "tqdm",
    "tomli-w", "jinja2", "obspy", "distributed", "pytest", "hypothesis", "heyoka", "mujoco", "pymunk",
)  # fmt: skip


def environment(folder: Path, python: str, which: str, uv: str) -> Path:
    """A new environment with the project of ROOT and its test extra; its interpreter."""
    subprocess.run([uv, "venv", "--quiet", "--seed", "--python", python, str(folder)], check=True)
    interpreter = folder / "bin" / "python"
    resolution = {"lowest": "lowest-direct", "newest": "highest"}[which]
    command = [uv, "pip", "install", "--quiet", "--python", str(interpreter), "--resolution", resolution]
    wheels = [part for name in COMPILED for part in ("--only-binary", name)]
    subprocess.run([*command, *wheels, "--editable", f"{ROOT}[test]"], check=True)
    return interpreter


def versions(interpreter: Path) -> str:
    """What was installed, in a line."""
    code = (
        "import platform; from importlib.metadata import version\n"
        f"print('Python', platform.python_version(), *(f'{{n}} {{version(n)}}' for n in {SHOWN!r}), sep=', ')"
    )
    return subprocess.check_output([str(interpreter), "-c", code], text=True).strip()


def tested(which: str, python: str, uv: str, quick: bool, jobs: str) -> bool:
    """Whether the tests pass; compiled code is kept apart from that of other versions."""
    with tempfile.TemporaryDirectory(prefix=f"versions_{which}_") as temporary:
        interpreter = environment(Path(temporary) / "venv", python, which, uv)
        print(f"{which}: {versions(interpreter)}", flush=True)
        apart = {"NUMBA_CACHE_DIR": f"{temporary}/numba", "MPLCONFIGDIR": f"{temporary}/matplotlib"}
        command = [str(interpreter), "-m", "pytest", "-q", "-n", jobs, "-p", "no:cacheprovider"]
        done = subprocess.run([*command, *(QUICK if quick else ())], cwd=ROOT, env=os.environ | apart)
        print(f"{which} on Python {python}: {'passed' if done.returncode == 0 else 'FAILED'}", flush=True)
        return done.returncode == 0


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python tests/versions.py", description=__doc__.split("\n", 1)[0])
    parser.add_argument("which", nargs="+", choices=("lowest", "newest"))
    parser.add_argument("--python", default=platform.python_version(), help="version or path (default: this one)")
    parser.add_argument("--quick", action="store_true", help="a few tests of every package")
    parser.add_argument("--jobs", default="auto", help="processes of pytest, 0 for none of its own (default: auto)")
    options = parser.parse_args()
    uv = shutil.which("uv")
    if uv is None:
        raise SystemExit("uv: not found on the path; want it installed (python -m pip install uv)")
    passed = [tested(which, options.python, uv, options.quick, options.jobs) for which in options.which]
    sys.exit(0 if all(passed) else 1)


if __name__ == "__main__":
    main()
