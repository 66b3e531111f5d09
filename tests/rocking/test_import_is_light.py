"""Importing `rocking` loads no backend: a script that only wants a Block pays for none."""

import subprocess
import sys

import pytest

HEAVY = ["numba", "scipy", "jax", "diffrax", "xarray", "matplotlib"]


def loaded_after(statement: str) -> set[str]:
    """Names among HEAVY that a fresh interpreter has loaded after a statement."""
    code = f"import sys\n{statement}\nprint(*(m for m in {HEAVY!r} if m in sys.modules))"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(result.stdout.split())


def test_import_of_rocking_loads_no_backend() -> None:
    assert loaded_after("import rocking") == set()


def test_blocks_and_methods_are_made_without_a_backend() -> None:
    made = "Method1(Block(0.2, 0.8)).parameters; Method2(Block(0.2, 0.8), friction=1.0).parameters"
    assert loaded_after(f"from rocking import *; {made}") == set()


def test_the_scipy_solver_needs_no_compiler() -> None:
    run = "from rocking import *; solve(Method1(Block(0.2, 0.8)), theta=0.1, t_end=0.5, solver='scipy')"
    assert loaded_after(run) == {"scipy"}


@pytest.mark.parametrize("name", HEAVY)
def test_the_watch_would_see_a_backend(name: str) -> None:
    assert name in loaded_after(f"import types, sys; sys.modules[{name!r}] = types.ModuleType({name!r})")
