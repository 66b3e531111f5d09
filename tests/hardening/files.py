"""Whole files of every kind that is read, small: what damage is done to."""

from __future__ import annotations

import importlib.util
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

HERE = Path(__file__).resolve().parent
T = 0.01 * np.arange(60)

SWEEP = """title = "two"
[axes]
method = ["method1"]
frequency = [1.0, 2.0]
slenderness = { start = 0.2, stop = 0.3, count = 2, log = true }
[fixed]
friction = 0.6
[excitations.ramp]
kind = "ramped_sinusoid"
duration = 10.0
final_amplitude = 20.0
[run]
solver = "numba"
rtol = 1e-8
"""

MODEL = """title = "made"
[block]
breadth = 0.15
height = 0.5
depth = 0.25
mass = 11.2
[model]
restitution = 0.92
gravity = 9.81
restitution_drift = 0.0
restitution_drift_fading = 0.0
number = 3
[effects.rounded_edges]
radius = 0.003
[mountings]
top = 0.01
[outcomes]
spread = 0.2
error_rate = 0.01
"""

CAMPAIGN = """title = "Block"
[block]
breadth = 0.15
height = 0.50
depth = 0.25
mass = 11.2
centre_of_mass_height = 0.25
[conditions]
friction = 0.7
restitution = 0.9
[[channel]]
name = "rotation"
kind = "rotation"
noise = 2.0e-4
[[channel]]
name = "base_x"
kind = "base_acceleration_x"
[[channel]]
name = "acc"
kind = "block_acceleration"
position = [0.0, 0.48]
direction = [1.0, 0.0]
[[test]]
id = "ramp"
kind = "forced"
data = "ramp.csv"
motion = "El Centro"
overturned = false
[[test]]
id = "free"
kind = "free"
data = "free.csv"
initial_rotation = 0.1
"""
RAMP = "\n".join(
    ["time,rotation,base_x", *(f"{t:.2f},{0.05 * np.sin(9 * t):.5f},{2.0 * np.sin(30 * t):.4f}" for t in T), ""]
)
FREE = "\n".join(["time,rotation", *(f"{t:.2f},{0.1 * np.cos(6 * t):.5f}" for t in T), ""])


def campaign() -> dict[str, bytes]:
    """The files of a campaign by name."""
    return {"campaign.toml": CAMPAIGN.encode(), "ramp.csv": RAMP.encode(), "free.csv": FREE.encode()}


@cache
def _synthetic() -> Any:
    spec = importlib.util.spec_from_file_location("made_records", HERE.parent / "excitation" / "synthetic_files.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def records() -> dict[str, bytes]:
    """A record in each format."""
    a, s = np.round(3.0 * np.sin(0.7 * np.arange(61)) * np.hanning(61), 6), _synthetic()
    texts = {
        "peer": s.peer_text(a, 0.005), "knet": s.knet_text(a), "dyna": s.dyna_text(a, 0.005),
        "smc": s.smc_text(a, 0.005), "nsmn": s.nsmn_text([a, 0.5 * a[::-1], 0.1 * a], 0.005),
        "csmip 1": "\n".join(s.csmip1_channel(a, 0.02 * np.arange(61))),
        "csmip 1, even": "\n".join(s.csmip1_even_channel(a, 200)),
        "csmip 2": "\n".join(s.csmip2_channel(a, 0.02)), "cosmos": "\n".join(s.cosmos_channel(a, 0.005)),
        "columns": "\n".join(["time [s],a_x [g]", *(f"{0.01 * i:.2f},{v}" for i, v in enumerate(a))]),
    }  # fmt: skip
    return {name: text.encode() for name, text in texts.items()}


def dataset() -> xr.Dataset:
    """Numbers, texts and a coordinate, as studies have them."""
    f = np.array([1.0, 2.0, 3.0])
    amplitude = ("frequency", np.exp(f), {"units": "m s-2"})
    ds = xr.Dataset({"a": amplitude}, {"frequency": ("frequency", f, {"units": "Hz"})})
    return ds.assign(note=("frequency", ["fell", "stands", "fell"])).assign_attrs(study="made", inputs="x")


def netcdf() -> bytes:
    """The dataset as a file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.nc"
        dataset().to_netcdf(path, engine="netcdf4")
        return path.read_bytes()


def of(target: str) -> list[bytes]:
    """The whole files that a reader begins with."""
    return {
        "records": lambda: list(records().values()), "campaign": lambda: [CAMPAIGN.encode()],
        "csv": lambda: [RAMP.encode()], "sweep": lambda: [SWEEP.encode()], "model": lambda: [MODEL.encode()],
        "netcdf": lambda: [netcdf()],
    }[target]()  # fmt: skip
