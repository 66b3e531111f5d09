"""Whatever obspy reads: miniSEED, SAC, GSE2, WIN, REFTEK and many more.

Source   Beyreuther et al. (2010), ObsPy: a Python toolbox for seismology; the optional extra `records`.
Status   such files hold numbers without a unit, so it has to be stated; instrument responses are not removed.  obspy
         runs in a process of its own, which takes a second or two: a damaged file can crash its compiled readers.
"""

from __future__ import annotations

import hashlib
import io
import json
import subprocess
import sys
from importlib.util import find_spec
from typing import Any

import numpy as np

from excitation.formats.directions import direction_of
from excitation.record import Record, RecordFileError
from excitation.units import factor

NAME = "obspy"
TITLE = "whatever obspy reads (extra `records`)"
COMMAND = (sys.executable, "-m", "excitation.formats.obspy_child")
TIME_LIMIT = 120.0
"""Seconds after which a file is given up."""


def available() -> bool:
    """Whether obspy is installed."""
    return find_spec("obspy") is not None


def _traces(name: str, data: bytes) -> list[tuple[dict[str, str], np.ndarray]]:
    """(facts, samples) of each trace, by obspy in a child process."""
    try:
        child = subprocess.run(COMMAND, input=data, capture_output=True, timeout=TIME_LIMIT, check=False)
    except subprocess.TimeoutExpired:
        raise RecordFileError(f"{name}: obspy was not done with it after {TIME_LIMIT:g} s") from None
    if child.returncode == 1:
        raise RecordFileError(f"{name}: is in no format read here, nor in one that obspy reads")
    if child.returncode != 0:
        raise RecordFileError(f"{name}: made obspy's reader crash (status {child.returncode}), want a whole file")
    with np.load(io.BytesIO(child.stdout), allow_pickle=False) as packed:
        facts: list[dict[str, str]] = json.loads(str(packed["facts"]))
        return [(fact, packed[f"samples_{k}"]) for k, fact in enumerate(facts)]


def parse(name: str, data: bytes, units: str | None) -> list[Record]:
    """One record for each trace, in the stated unit.

    Raises RecordFileError if obspy is missing or does not read the file, no unit is stated or a trace is no series.
    """
    if not available():
        raise RecordFileError(f"{name}: is in no format read here; with obspy (extra `records`) more can be read")
    traces = _traces(name, data)
    if not traces:
        raise RecordFileError(f"{name}: holds no trace that obspy finds, want one or more")
    if units is None:
        raise RecordFileError(f"{name}: {traces[0][0]['_format']} states no unit, want units='m/s^2' or alike")
    scale = factor(units, "acceleration")
    return [_record(name, facts, scale * values, units, data) for facts, values in traces]


def _record(name: str, facts: dict[str, str], values: Any, units: str, data: bytes) -> Record:
    step = float(facts["step"])
    if values.ndim != 1 or values.size < 2 or not np.all(np.isfinite(values)):
        raise RecordFileError(f"{name}, trace {facts['id']}: has gaps or fewer than two samples, want a whole series")
    if not (np.isfinite(step) and step > 0.0):
        raise RecordFileError(f"{name}, trace {facts['id']}: has a time step of {step} s, want above zero")
    direction = direction_of(facts["channel"][-1:])
    return Record(
        step, values, component=facts["channel"], azimuth_deg=direction.azimuth_deg,
        vertical=direction.vertical,
        station=f"{facts['network']}.{facts['station']}".strip("."), start_time=facts["start"], source=name,
        format=f"{NAME}: {facts['_format']}", file_units=units, sha256=hashlib.sha256(data).hexdigest(),
    )  # fmt: skip
