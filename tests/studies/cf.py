"""What the CF conventions ask of our files: by the checker of IOOS, and what that does not look at.

Source   CF Metadata Conventions 1.11: sections 2.2 (types), 2.3 (names), 2.5.1 (missing data), 2.6 (attributes of the
         file), 3.1 (units), 3.5 (flags), 5 (coordinates)
"""

import re
import warnings

import netCDF4
import numpy as np

UNITS = {
    "1", "m", "s", "Hz", "rad", "kg", "N", "J", "m s-2", "m s-1", "rad s-1", "rad s-2", "m/s", "rad/s", "m/s^2", "m2",
    "N m-1", "N s m-1", "kg m2", "N/m", "N s/m", "kg m-3", "N m", "degree", "percent", "kg/m3", "s-1",
}  # fmt: skip
"""Units that our variables have; each is one that UDUNITS knows."""

TYPES = ("i1", "i2", "i4", "i8", "u1", "f4", "f8", "S1")


def problems(path) -> list[str]:
    """What is wrong with a file, a sentence each."""
    with netCDF4.Dataset(path) as file:
        found = [] if str(getattr(file, "Conventions", "")).startswith("CF-1") else ["no Conventions"]
        found += [f"no {name}" for name in ("title", "source", "references") if not getattr(file, name, "")]
        names = [*file.variables, *file.dimensions, *file.ncattrs()]
        found += [f"name {name}" for name in names if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name)]
        for name, variable in file.variables.items():
            found += [f"{name}: {text}" for text in _of_variable(file, name, variable)]
    return found


def _of_variable(file, name, variable) -> list[str]:
    found, kept = [], variable.ncattrs()
    kind = variable.dtype
    if kind is not str and kind.str[1:] not in TYPES and kind.kind not in "SU":
        found.append(f"type {kind}")
    if not ({"long_name", "standard_name"} & set(kept)):
        found.append("no long_name")
    if "units" in kept and variable.units not in UNITS:
        found.append(f"unit {variable.units!r}")
    if {"flag_values", "flag_meanings"} & set(kept):
        values, meanings = np.atleast_1d(variable.flag_values), variable.flag_meanings.split()
        if len(values) != len(meanings) or len(set(values.tolist())) < len(values):
            found.append("flags and meanings do not match")
        if not set(np.unique(np.ma.compressed(variable[:]))) <= set(values.tolist()):
            found.append("a value that is no flag")
    if name in file.dimensions:
        found += _of_coordinate(variable, kept)
    for other in getattr(variable, "coordinates", "").split():
        if other not in file.variables:
            found.append(f"coordinate {other} is not there")
    return found


def _of_coordinate(variable, kept) -> list[str]:
    if "_FillValue" in kept or "missing_value" in kept:
        return ["a coordinate with missing values"]
    if variable.dtype is str or variable.dtype.kind in "SU":
        return [] if len(set(variable[:].tolist())) == variable.size else ["a name twice"]
    step = np.diff(np.asarray(variable[:], dtype=float))
    return [] if (step > 0).all() or (step < 0).all() else ["a coordinate that is not monotonic"]


ALLOWED = {
    # A time that has passed since the start, in s; the standard name is for dates, in units of "s since ...".
    "Coordinate variable 'time' should have standard_name='time', found: 'None'",
}
"""What the checker asks for and does not apply."""

CANNOT = {"check_coordinate_variables_strict_monotonicity"}
"""Checks that fail by themselves on coordinates that are names; `_of_coordinate` looks at those."""


def by_checker(path) -> list[str]:
    """What the compliance checker of IOOS finds against CF 1.11, a sentence each."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from compliance_checker.suite import CheckSuite

        CheckSuite.load_all_available_checkers()
        suite = CheckSuite()
        with suite.load_dataset(str(path)) as file:
            results, failed = suite.run_all(file, ["cf:1.11"], skip_checks=[])["cf:1.11"]
    found = [f"{name}: {error}" for name, (error, *_) in failed.items() if name not in CANNOT]
    for result in results:
        reached, wanted = result.value if isinstance(result.value, tuple) else (bool(result.value), True)
        if reached != wanted:
            said = [text for text in result.msgs if text not in ALLOWED]
            found += said or ([] if result.msgs else [result.name])
    return found
