"""What a sweep is: axes, what stays fixed, excitations; declared in Python or in a small TOML, checked before it runs.

    title = "Size and slenderness under a ramp and a pulse"

    [axes]                                  # in the order of the dimensions
    method = ["method1", "method2", "dem"]
    h = [0.25, 0.5, 1.0]                    # height [m]
    slenderness = { start = 0.1, stop = 0.5, count = 9 }        # b/h; log = true spaces logarithmically
    frequency = [1.0, 2.0, 3.0]             # of the base motion [Hz]; of a pulse, 1 over its period
    excitation = ["ramp", "pulse"]

    [fixed]                                 # what is no axis; what is in neither has a default
    friction = 0.7
    restitution = 1.0                       # over Housner's

    [excitations.ramp]
    kind = "ramped_sinusoid"                # criterion: envelope at overturning
    duration = 90.0                         # [s]
    final_amplitude = 245.0                 # [m/s^2]

    [excitations.pulse]
    kind = "OneSinePulse"                   # any pulse of `excitation`; criterion: least amplitude that fells
    highest = 60.0                          # amplitude up to which is looked [m/s^2]
    steps = 40                              # geometric steps from West's acceleration up to it
    bisections = 20                         # of the step in which it is found
    after = 6.0                             # time for which a block is watched after the pulse at least [s]

Source   none, own convention
Status   every refusal is tested
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

import excitation
from excitation.pulse import CentredPulse, FinitePulse
from rocking import G_STANDARD
from studies.criteria.overturning import METHODS
from studies.running.toml_file import read_toml

Axis = tuple[Any, ...]


@dataclass(frozen=True)
class Parameter:
    """What may be an axis: unit, name, value where nothing is said, and the open range of its numbers."""

    units: str
    long_name: str
    default: Any
    low: float = 0.0
    high: float = math.inf
    low_allowed: bool = False


PARAMETERS: Mapping[str, Parameter] = {
    "method": Parameter("", "method", "method1"),
    "h": Parameter("m", "height of the block", 0.5),
    "slenderness": Parameter("1", "breadth over height of the block", 0.3),
    "frequency": Parameter("Hz", "frequency of the base motion", 3.0),
    "friction": Parameter("1", "friction coefficient", 0.7, low_allowed=True),
    "restitution": Parameter("1", "restitution over Housner's", 1.0, high=2.0),
    "excitation": Parameter("", "excitation", "ramp"),
}
"""Names that an axis or a fixed value may have."""

MOST_VALUES, MOST_POINTS = 1_000_000, 1_000_000_000
"""Values of an axis, and points of a sweep: a millisecond each, the latter take eleven days."""

RAMP = "ramped_sinusoid"
RAMP_DEFAULTS = {"duration": 90.0, "final_amplitude": 25.0 * G_STANDARD}
PULSE_DEFAULTS = {"highest": 100.0, "steps": 40, "bisections": 20, "after": 6.0}
MOST = {"steps": 10_000, "bisections": 100}
"""Of what the search for a pulse's least amplitude may take."""
RUN_DEFAULTS = {"solver": "numba", "form": "linear", "rtol": 1e-9, "atol": 1e-12, "depth": 0.25}


def pulses() -> tuple[str, ...]:
    """Names of the pulses of `excitation` that an amplitude and a period make."""
    found = excitation.formulas().items()
    return tuple(sorted(n for n, kind in found if issubclass(kind, (FinitePulse, CentredPulse)) and _plain(kind)))


def _plain(kind: Any) -> bool:
    try:
        kind(amplitude=1.0, period=1.0)
    except TypeError:
        return False
    return True


@dataclass(frozen=True)
class Sweep:
    """A declared sweep; what is in neither `axes` nor `fixed` has its default.

    Args:
        axes: values by name, in the order of the dimensions.
        fixed: one value by name.
        excitations: kind and numbers of each excitation by its name; a ramped sinusoid "ramp" if not given.
        run: solver, form, rtol, atol of Methods 1 and 2; depth of the blocks [m].
        title: of the dataset.

    Raises:
        ValueError: a name or a value is not one that it can have.
    """

    axes: Mapping[str, Any]
    fixed: Mapping[str, Any] = field(default_factory=dict)
    excitations: Mapping[str, Mapping[str, Any]] = field(default_factory=lambda: {"ramp": {"kind": RAMP}})
    run: Mapping[str, Any] = field(default_factory=dict)
    title: str = "Criteria of rocking and overturning"

    def __post_init__(self) -> None:
        if not isinstance(self.title, str) or not self.title.isprintable():
            raise ValueError(f"title={_shown(self.title)}: want text that can be printed")
        axes = {name: _axis(name, values) for name, values in self.axes.items()}
        if not axes:
            raise ValueError("axes: none given, want one or more")
        fixed = {name: _value(name, value) for name, value in self.fixed.items()}
        both = sorted(set(axes) & set(fixed))
        if both:
            raise ValueError(f"{both[0]}: is an axis and fixed; want one of the two")
        object.__setattr__(self, "axes", axes)
        object.__setattr__(self, "fixed", {n: p.default for n, p in PARAMETERS.items() if n not in axes} | fixed)
        object.__setattr__(self, "excitations", {n: _excitation(n, e) for n, e in self.excitations.items()})
        object.__setattr__(self, "run", _run_settings(self.run))
        self._check_together()
        if self.size > MOST_POINTS:
            raise ValueError(f"axes: {' x '.join(map(str, self.shape))} points, want at most {MOST_POINTS} in all")

    def _check_together(self) -> None:
        for name in self.all_values("excitation"):
            if name not in self.excitations:
                raise ValueError(f"excitation={name!r}: want one of {', '.join(sorted(self.excitations))}")
        for name in self.all_values("method"):
            if name not in METHODS:
                raise ValueError(f"method={name!r}: want one of {', '.join(METHODS)}")
        if "method2" in self.all_values("method") and max(self.all_values("friction")) >= 4.0 / 3.0:
            raise ValueError("friction: want below 4/3 with method2 (a corner may jam)")

    def all_values(self, name: str) -> Axis:
        """Every value that a parameter takes in the sweep."""
        return tuple(self.axes[name]) if name in self.axes else (self.fixed[name],)

    def __repr__(self) -> str:
        axes = " x ".join(f"{len(values)} {name}" for name, values in self.axes.items())
        return f"<Sweep {self.title!r}: {axes} = {self.size} points>"

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Lengths of the axes."""
        return tuple(len(values) for values in self.axes.values())

    @property
    def size(self) -> int:
        """Number of points."""
        return math.prod(self.shape)

    def as_json(self) -> str:
        """All of it, as `from_mapping` takes it."""
        return json.dumps(asdict(self), sort_keys=False)


def _value(name: str, value: Any) -> Any:
    if name not in PARAMETERS:
        raise ValueError(f"{_key(name)}: want one of {', '.join(PARAMETERS)}")
    parameter = PARAMETERS[name]
    if not parameter.units:
        if not isinstance(value, str):
            raise ValueError(f"{name}={_shown(value)}: want a name")
        return value
    number = _number(value)
    low = number >= parameter.low if parameter.low_allowed else number > parameter.low
    if not (math.isfinite(number) and low and number < parameter.high):
        least = f"{parameter.low:g} or more" if parameter.low_allowed else f"above {parameter.low:g}"
        most = "" if parameter.high == math.inf else f" and below {parameter.high:g}"
        unit = "" if parameter.units == "1" else f" {parameter.units}"
        raise ValueError(f"{name}={_shown(value)}{unit}: want a number {least}{most}")
    return number


def _number(value: Any) -> float:
    """A number as such; NaN for anything else."""
    if isinstance(value, bool) or not isinstance(value, (int, float, np.number)):
        return math.nan
    try:
        return float(value)
    except OverflowError:
        return math.nan


def _key(name: Any) -> str:
    """A name as an error shows it: as it is where that can be printed."""
    return name if isinstance(name, str) and name.isprintable() and len(name) <= 60 else _shown(name)


def _shown(value: Any) -> str:
    """A value as an error shows it."""
    try:
        text = repr(value)
    except ValueError:  # Python prints no integer of more than 4300 digits
        return "a number of thousands of digits"
    return text if len(text) <= 80 else f"{text[:77]}..."


def _spaced(name: str, spec: Mapping[str, Any]) -> list[float]:
    """Values from start, stop, count and log."""
    shown = _shown(dict(spec))
    if not {"start", "stop", "count"} <= set(spec) or set(spec) - {"start", "stop", "count", "log"}:
        raise ValueError(f"{name}={shown}: want start, stop and count, and perhaps log")
    start, stop, count, log = _number(spec["start"]), _number(spec["stop"]), spec["count"], spec.get("log", False)
    if not (math.isfinite(start) and math.isfinite(stop)):
        raise ValueError(f"{name}={shown}: want start and stop as numbers")
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST_VALUES:
        raise ValueError(f"{name}={shown}: want start, stop and a whole count above 0, at most {MOST_VALUES}")
    if not isinstance(log, bool):
        raise ValueError(f"{name}={shown}: want log = true or false")
    if log:
        if not (start > 0.0 and stop > 0.0):
            raise ValueError(f"{name}={shown}: want start and stop above 0 with log")
        return [float(x) for x in np.geomspace(start, stop, count)]
    return [float(x) for x in np.linspace(start, stop, count)]


def _axis(name: str, values: Any) -> Axis:
    if name not in PARAMETERS:
        raise ValueError(f"{_key(name)}: want one of {', '.join(PARAMETERS)}")
    listed = _spaced(name, values) if isinstance(values, Mapping) else values
    if isinstance(listed, str) or not isinstance(listed, (list, tuple, range, np.ndarray)) or len(listed) == 0:
        raise ValueError(f"{name}={_shown(values)}: want a list of one or more values")
    if len(listed) > MOST_VALUES:
        raise ValueError(f"{name}: {len(listed)} values, want at most {MOST_VALUES}")
    found = tuple(_value(name, value) for value in listed)
    if len(set(found)) < len(found):
        raise ValueError(f"{name}: want each value once")
    if PARAMETERS[name].units and list(found) != sorted(found):
        raise ValueError(f"{name}: want ascending values")
    return found


def _excitation(name: str, given: Any) -> dict[str, Any]:
    if not isinstance(given, Mapping):
        raise ValueError(f"excitations.{_key(name)}={_shown(given)}: want a table")
    kind = given.get("kind")
    if kind != RAMP and kind not in pulses():
        raise ValueError(f"excitations.{_key(name)}.kind={_shown(kind)}: want one of {', '.join((RAMP, *pulses()))}")
    known = RAMP_DEFAULTS if kind == RAMP else PULSE_DEFAULTS
    for key, value in given.items():
        if key == "kind":
            continue
        if key not in known:
            raise ValueError(f"excitations.{_key(name)}.{_key(key)}: want one of {', '.join(('kind', *known))}")
        whole = key in ("steps", "bisections")
        number = math.nan if whole and not isinstance(value, int) else _number(value)
        if not 0.0 < number <= MOST.get(key, sys.float_info.max):
            wanted = f"a whole number above 0, at most {MOST[key]}" if whole else "a number above 0"
            raise ValueError(f"excitations.{_key(name)}.{key}={_shown(value)}: want {wanted}")
    return {"kind": kind} | known | {key: value for key, value in given.items() if key != "kind"}


def _run_settings(given: Mapping[str, Any]) -> dict[str, Any]:
    from rocking.solvers import available, load

    for key in given:
        if key not in RUN_DEFAULTS:
            raise ValueError(f"run.{_key(key)}: want one of {', '.join(RUN_DEFAULTS)}")
    settings: dict[str, Any] = RUN_DEFAULTS | dict(given)
    if not isinstance(settings["solver"], str) or settings["solver"] not in available():
        raise ValueError(f"run.solver={_shown(settings['solver'])}: want one of {', '.join(available())}")
    try:
        batch = hasattr(load(settings["solver"]), "solve_batch")
    except ImportError as error:
        raise ValueError(f"run.solver={settings['solver']!r}: {error}") from error
    if not batch:
        raise ValueError(f"run.solver={settings['solver']!r}: it has no batch; want one that has, as 'numba' does")
    if settings["form"] not in ("linear", "nonlinear"):
        raise ValueError(f"run.form={_shown(settings['form'])}: want 'linear' or 'nonlinear'")
    for key in ("rtol", "atol", "depth"):
        number = _number(settings[key])
        if not (math.isfinite(number) and number > 0.0):
            raise ValueError(f"run.{key}={_shown(settings[key])}: want a number above 0")
    return settings


def from_mapping(declared: Mapping[str, Any]) -> Sweep:
    """A sweep from what a TOML holds.

    Raises:
        ValueError: a name or a value is not one that it can have.
    """
    known = ("title", "axes", "fixed", "excitations", "run")
    for key in declared:
        if key not in known:
            raise ValueError(f"{_key(key)}: want one of {', '.join(known)}")
    for key in known[1:]:
        if key in declared and not isinstance(declared[key], Mapping):
            raise ValueError(f"{key}={_shown(declared[key])}: want a table")
    return Sweep(**{"axes": {}} | dict(declared))


def read(path: Path | str) -> Sweep:
    """A sweep from a TOML.

    Raises:
        ValueError: it cannot be read, or a name or a value is not one that it can have.
    """
    return from_mapping(read_toml(Path(path)))
