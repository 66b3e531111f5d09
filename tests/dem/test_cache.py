"""The compiled step is kept on disk, found again, dropped when any source changes; imports stay light."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import dem

SCRIPT = """
import dem, sys
assert "numba" not in sys.modules, "numba loaded at import"
history = dem.simulate(
    dem.single_block(0.15, 0.5, 0.25, 597.0), t_end=0.01, dt=1e-5, mu=0.5, damping_ratio=0.1, theta0=0.1
)
from dem.step import advance
print(dem.__file__, sum(advance.stats.cache_hits.values()), sum(advance.stats.cache_misses.values()), history.theta[-1])
"""


@pytest.fixture
def package(tmp_path):
    """A copy of the package that the test may edit."""
    copy = tmp_path / "dem"
    shutil.copytree(Path(dem.__file__).parent, copy, ignore=shutil.ignore_patterns("__pycache__"))
    return copy


ASSEMBLY = """
import dem, sys
assert "numba" not in sys.modules, "numba loaded at import"
contact = dem.Contact(0.5, damping_ratio=0.1)
history = dem.simulate_assembly(dem.column(2, 0.15, 0.5, 0.25, 597.0), t_end=0.01, contact=contact)
from dem.assembly_step import advance_assembly as loop
print(dem.__file__, sum(loop.stats.cache_hits.values()), sum(loop.stats.cache_misses.values()), history.z[-1, 1])
"""


@pytest.mark.slow  # compiles twice, 15 s each
def test_the_loop_of_assemblies_is_cached_and_replaced_too(package):
    first, second = run(package, ASSEMBLY), run(package, ASSEMBLY)
    assert first[:2] == (0, 1)
    assert second[:2] == (1, 0) and second[2:] == first[2:]
    forces = package / "contact_forces.py"
    forces.write_text(forces.read_text().replace("kept[q.SPRING_N] + law[q.KN] * approach", "0.5 * law[q.KN] * d"))
    edited = run(package, ASSEMBLY)
    assert edited[:2] == (0, 1) and edited[2] != first[2]
    assert len(edited[3]) == len(first[3]) == 2 and not set(edited[3]) & set(first[3])


def run(package, script=SCRIPT):
    """Cache hits, misses, last tilt and number of cache files after a run in its own process."""
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=package.parent, env=environment, capture_output=True, text=True, check=True
    )
    where, hits, misses, theta = done.stdout.split()
    assert Path(where).parent == package
    return int(hits), int(misses), float(theta), sorted(path.name for path in package.glob("__pycache__/*.nb[ic]"))


def test_second_process_hits_the_cache_and_an_edit_elsewhere_replaces_it(package):
    first, second = run(package), run(package)
    assert first[:2] == (0, 1)
    assert second[:2] == (1, 0)
    assert second[2:] == first[2:]

    law = package / "contact_law.py"
    law.write_text(law.read_text().replace("stored + law.kn * approach", "stored + 0.5 * law.kn * approach"))
    edited = run(package)
    assert edited[:2] == (0, 1)
    assert edited[2] != first[2]
    assert len(edited[3]) == len(first[3]) == 2
    assert not set(edited[3]) & set(first[3])


def test_motions_of_arrays_that_cannot_be_written_to_are_not_compiled_for_anew():
    from dem.step import advance

    def run(writable):
        def motion(t):
            zeros = np.zeros_like(t)
            zeros.setflags(write=writable)
            return zeros, zeros

        block = dem.single_block(0.15, 0.5, 0.25, 597.0)
        return dem.simulate(block, motion, t_end=0.01, dt=1e-5, mu=0.5, damping_ratio=0.1, theta0=0.1).theta[-1]

    assert run(True) == run(False)
    assert len(advance.signatures) == 1
