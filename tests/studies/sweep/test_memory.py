"""A sweep whose dataset is far larger than the memory that it may have: computed, put together, counted and opened."""

import json
import subprocess
import sys

import pytest

# Most chunks are there already, as an interruption leaves them, with numbers of a formula in place of runs: the rest
# is computed. Then the memory is limited and the sweep goes on.
CHILD = """
import json, resource, sys
from pathlib import Path

import numpy as np
import xarray as xr

from studies.sweep import Sweep, run
from studies.sweep.__main__ import main
from studies.sweep.chunks import Folder, as_dataset, boxes
from studies.sweep.evaluation import FELL, VARIABLES
from studies.sweep.running import identity_of

folder, POINTS, MISSING = Path(sys.argv[1]), 15_000, (3, 700)
AXES = {
    "h": np.linspace(0.25, 1.0, 160).tolist(), "slenderness": np.linspace(0.1, 0.5, 300).tolist(),
    "friction": np.linspace(0.3, 1.2, 300).tolist(),
}
RAMP = {"ramp": {"kind": "ramped_sinusoid", "duration": 0.5, "final_amplitude": 20.0}}
sweep = Sweep(axes=AXES, excitations=RAMP)
bytes_of_all = sweep.size * (8 * len(VARIABLES) + 1)

# Compiled, and every library loaded, by a small sweep of the same kind.
small = Sweep(axes=AXES | {"h": [0.5], "slenderness": [0.2]}, excitations=RAMP)
run(small, folder / "small.nc", progress=False).close()

parts = Folder(folder / "large.nc.parts")
parts.begin(identity_of(sweep, POINTS))


def numbers(number):
    # Digits that no compression makes small; a third of the points falls.
    result = {name: np.random.default_rng(number).random(POINTS) for name in VARIABLES}
    return result | {"outcome": (np.arange(POINTS) % 3 != 0).astype(np.int8), "declined": []}


chunks = list(boxes(sweep.shape, POINTS))
for number, box in enumerate(chunks):
    if number not in MISSING:
        parts.keep(number, as_dataset(sweep, box, numbers(number)))


def data():
    # Memory of this process that it can write to [bytes], which RLIMIT_DATA limits.
    return 1024 * int(Path("/proc/self/status").read_text().split("VmData:")[1].split()[0])


def peak():
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


before, allowed = peak(), bytes_of_all // 2
resource.setrlimit(resource.RLIMIT_DATA, (data() + allowed, resource.RLIM_INFINITY))
try:
    np.empty(bytes_of_all, np.int8)
    refused = False
except MemoryError:
    refused = True
(folder / "large.toml").write_text(
    "\\n".join(["[axes]", *(f"{name} = {values}" for name, values in AXES.items()), "[excitations.ramp]",
               *(f"{name} = {json.dumps(value)}" for name, value in RAMP["ramp"].items())])
)
main([str(folder / "large.toml"), "--out", str(folder / "large.nc"), "--chunk", str(POINTS), "--workers", "2"])
after = peak()
with xr.open_dataset(folder / "large.nc") as ds:
    chosen = (0, 1, 399, 900, len(chunks) - 1)
    same = all(
        np.array_equal(
            ds[name][tuple(slice(*pair) for pair in chunks[number])].values.ravel(), numbers(number)[name]
        )
        for number in chosen for name in (*VARIABLES, "outcome")
    )
    own = ds[list(VARIABLES)][{dim: slice(*pair) for dim, pair in zip(AXES, chunks[MISSING[1]])}].load()
print(json.dumps({
    "whole": bytes_of_all, "more": after - before, "allowed": allowed, "refused": refused, "same": same,
    "file": (folder / "large.nc").stat().st_size, "parts": parts.path.exists(),
    "computed": int(np.isfinite(own["rocking_amplitude"]).sum()),
}))
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="the limit that is set, and the file it is read from, are Linux's")
def test_a_sweep_larger_than_the_memory_that_it_may_have_is_finished_and_opened(tmp_path):
    done = subprocess.run([sys.executable, "-c", CHILD, str(tmp_path)], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr[-2000:]
    found = json.loads(done.stdout.splitlines()[-1])
    # The limit bites, the numbers do not fit the memory by compression, and nothing is lost on the way.
    assert found["refused"] and found["same"] and not found["parts"]
    assert found["file"] > found["whole"] / 2
    assert found["computed"] > 0
    # Resident memory grows by chunks and by caches of the file, not with the dataset.
    assert found["more"] < found["whole"] / 4
