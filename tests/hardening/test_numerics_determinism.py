"""Same seed, same bits: on one core or all of them, in another process, with another order of hashing.

Beside what tests of batches, assemblies and sweeps say of themselves.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

BEGIN = """
import os, sys, hashlib
import numpy as np
if sys.argv[1] == "one":
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})

def say(name, *arrays):
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(np.ascontiguousarray(array).tobytes())
    print(name, digest.hexdigest())

def summary(batch):
    return [batch.outcome, batch.overturning_time, batch.peak_rotation, batch.onset_time, batch.impacts, batch.t_end]
"""

COMPILED = """
import dem
from excitation import KanaiTajimi, PointSource, RampedSinusoid
from rocking import Block, Method1, Method2, solve_batch
from rocking.effects.rounded_edges import RoundedEdges
from rocking.effects.viscous_damping import ViscousDamping

quake = [KanaiTajimi(1.5, 8.0).record(0.01, seed) for seed in range(6)]
say("stochastic motions", *(r.acceleration for r in quake))
say("point source", PointSource(5.5, 20e3).record(0.01, 3).acceleration)
wobbly = [RampedSinusoid(2.0, 6.0, 8.0, imperfection=0.1, seed=seed) for seed in range(40)]
say("seeded envelopes", *(m(np.linspace(0.0, 6.0, 500))[0] for m in wobbly))

rolling = Method2(Block(0.15, 0.5), friction=0.4, normal_restitution=0.3)
say("method 2", *summary(solve_batch(rolling, wobbly, t_end=6.0)))
lines = [r.motion(interpolation="linear") for r in quake] * 40
scaled = [Method1(Block(0.1 + 0.001 * i, 0.5)) for i in range(len(lines))]
say("taylor", *summary(solve_batch(scaled, lines, t_end=9.0, solver="taylor")))
effects = [RoundedEdges(radius=0.003), ViscousDamping(coefficient=0.1)]
say("effects", *summary(solve_batch(Method1(Block(0.15, 0.5)), wobbly, t_end=6.0, effects=effects)))
heap = dem.rubble(12, seed=4)
contact = dem.Contact(0.7, damping_ratio=0.1)
run = dem.simulate_assembly(heap, wobbly[0], t_end=0.2, contact=contact, workers=1 if sys.argv[1] == "one" else 2)
say("assembly", run.x, run.z, run.theta, run.energies.balance)
"""

JAX = """
from excitation import RampedSinusoid
from rocking import Block, Method1, solve_batch

shaking = [RampedSinusoid(1.0 + 0.1 * i, 6.0, 8.0) for i in range(24)]
linear = Method1(Block(0.15, 0.5), form="linear")
batch = solve_batch(linear, shaking, t_end=6.0, solver="exact", device="jax-cpu")
assert batch.peak_rotation.dtype == np.float64
say("device", *summary(batch))
say("diffrax", *summary(solve_batch(Method1(Block(0.15, 0.5)), shaking, t_end=6.0, solver="diffrax")))
"""


def digests(program: str, cores: str, hashing: str, **environment: str) -> dict[str, str]:
    """Digest of the bits of each part, from a process of its own."""
    environment = {**os.environ, "PYTHONHASHSEED": hashing, **environment}
    found = subprocess.run(
        [sys.executable, "-c", BEGIN + program, cores],
        env=environment,
        cwd=Path(__file__).parents[2],
        capture_output=True,
        text=True,
    )
    assert found.returncode == 0, found.stderr
    return dict(line.rsplit(" ", 1) for line in found.stdout.splitlines())


LINUX = pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="cores are chosen by a call of Linux")


@LINUX
def test_cores_and_hashing_change_no_bit() -> None:
    one, all_of_them = digests(COMPILED, "one", "1"), digests(COMPILED, "all", "2")
    assert len(one) == 7
    assert one == all_of_them


# The program of the GPU keeps to 64 bits, whatever JAX is told to take by default.
@LINUX
@pytest.mark.slow
def test_cores_and_the_precision_that_jax_is_set_to_change_no_bit_of_its_runs() -> None:
    one = digests(JAX, "one", "1", JAX_ENABLE_X64="0")
    assert len(one) == 2
    assert one == digests(JAX, "all", "2", JAX_ENABLE_X64="1")
