"""Boost.Odeint (C++) and SUNDIALS' CVODE (C) on the same trajectory; built on the spot where compiler and headers are.

Debian: libboost-dev, libsundials-dev.
"""

from __future__ import annotations

import subprocess
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).parent
BUILDS = {
    "odeint": ("odeint.cpp", ["g++", "-O3", "-march=native", "-std=c++17"], []),
    "CVODE": ("cvode.c", ["gcc", "-O3", "-march=native"], ["-lsundials_cvode", "-lsundials_nvecserial", "-lm"]),
}


FOLDER = tempfile.TemporaryDirectory()
"""Where programs are built and cases written; it goes with the process."""


@cache
def build(name: str) -> Path | str:
    """The program, or a sentence on why there is none."""
    source, compiler, libraries = BUILDS[name]
    program = Path(FOLDER.name) / name
    try:
        done = subprocess.run(
            [*compiler, str(HERE / source), "-o", str(program), *libraries], capture_output=True, text=True
        )
    except FileNotFoundError:
        return f"{name} left out: no {compiler[0]} here"
    if done.returncode != 0:
        first = next((line for line in done.stderr.splitlines() if "error" in line), done.stderr[:120])
        return f"{name} left out, it does not build: {first.strip()}"
    return program


def run(name: str, system: Any, motion: Any, t_end: float, runs: int, rtol: float) -> tuple[float, np.ndarray] | str:
    """(CPU time of a run [s], impact times [s]), or a sentence on why there are none."""
    par = system.parameters
    record = getattr(motion, "ramped_sine", None) is None
    dt, values = (motion.piecewise_linear[1], motion.piecewise_linear[2]) if record else (1.0, np.zeros(0))
    omega, rate = (1.0, 0.0) if record else (motion.ramped_sine[0], motion.ramped_sine[2])
    head = [int(system.form == "linear"), int(record), runs, par.p2, par.alpha, par.g, par.onset, par.e, par.omega_rest]
    head += [t_end, rtol, 1e-3 * rtol, dt if record else motion.max_step, omega, rate, dt, len(values)]
    program = build(name)
    if isinstance(program, str):
        return program
    case = Path(FOLDER.name) / "case.txt"
    numbers = [*(repr(float(v)) if isinstance(v, float) else str(v) for v in head), *map(repr, values.tolist())]
    case.write_text(" ".join(numbers))
    try:
        out = subprocess.run([str(program), str(case)], capture_output=True, text=True, timeout=60.0)
    except subprocess.TimeoutExpired:
        return f"{name} left out: not done in a minute"
    if out.returncode != 0:
        return f"{name} left out, it stopped: {out.stderr[:120]}"
    times = [float(line) for line in out.stdout.split()]
    return times[0], np.array(times[1:])
