"""The two trajectories that all benchmarks of the single block share, and how CPU time is taken.

E1   block of 0.15 x 0.50 m, Method 1, 10 s of a 3 Hz sine that grows to 1 g.
E2   the same block, 30 s of noise at 200 Hz, straight between samples, band 0.5 to 25 Hz, peak 0.40 g.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from excitation import PiecewiseLinear, RampedSinusoid
from rocking import Block, Method1

BLOCK = Block(0.15, 0.50)
G = Method1(BLOCK).g
FIFTH = 4


def noise(seed: int, dt: float = 0.005, duration: float = 30.0, peak: float = 0.4 * G) -> np.ndarray:
    """Samples [m/s^2] of band-limited noise."""
    n = round(duration / dt) + 1
    spectrum = np.fft.rfft(np.random.default_rng(seed).standard_normal(n))
    frequency = np.fft.rfftfreq(n, dt)
    spectrum[(frequency < 0.5) | (frequency > 25.0)] = 0.0
    a = np.fft.irfft(spectrum, n)
    return np.asarray(peak * a / np.abs(a).max())


def cases(seed: int = 17) -> dict[str, tuple[Any, float]]:
    """(motion, end [s]) by name; of seed 17 the run has some 250 impacts, of seed 0 some 330."""
    return {"E1": (RampedSinusoid(3.0, 10.0, G), 10.0), "E2": (PiecewiseLinear(0.005, noise(seed)), 30.0)}


def least(work: Callable[[], Any], runs: int) -> tuple[float, Any]:
    """(least CPU time [s] of several runs after a first one, result)."""
    result, times = work(), []
    for _ in range(runs):
        start = time.process_time()
        result = work()
        times.append(time.process_time() - start)
    return min(times), result


def acceleration(motion: Any) -> Callable[[float], float]:
    """a_x(t) [m/s^2] as a plain function."""
    if getattr(motion, "ramped_sine", None) is not None:
        omega, phase, rate, _ = motion.ramped_sine
        return lambda t: rate * t * math.sin(omega * t + phase)
    start, dt, values = motion.piecewise_linear
    last = len(values) - 2
    samples = [float(v) for v in values]

    def straight(t: float) -> float:
        k = min(max(int((t - start) / dt), 0), last)
        return samples[k] + (t - start - k * dt) / dt * (samples[k + 1] - samples[k])

    return straight
