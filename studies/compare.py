"""Two datasets of a study beside each other: what moved, by how much and where.

    python -m studies.compare A.nc B.nc [--rtol 1e-9]

Numbers are compared at the coordinates that both have; where two axes of numbers share no value, B is interpolated to
A's points.  Exit status 0 if nothing moved beyond the tolerance, 1 if something did, if B lacks a variable that A has
or if nothing could be compared.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from studies.running.command_line import positive, run
from studies.running.files import DatasetError, load_dataset

PASSING = ("commit", "command", "inputs", "source", "history")
"""Attributes that may differ without anything having moved."""

TELLING = ("units of ", "in A alone: ")
"""How a line begins that says that something moved or is missing; what B has besides is new."""


@dataclass(frozen=True)
class Moved:
    """What became of one variable."""

    name: str
    units: str
    compared: int  # values
    moved: int  # of them, beyond the tolerance
    largest: float  # absolute
    relative: float  # largest relative to A
    where: str  # the coordinates of the largest relative change
    note: str = ""


def _number(variable: xr.DataArray) -> bool:
    return variable.dtype.kind in "fiub"


def common(a: xr.Dataset, b: xr.Dataset) -> tuple[xr.Dataset, xr.Dataset, list[str]]:
    """Both datasets at coordinates that both have, and what was done to get there.

    Raises:
        DatasetError: they have no point in common along an axis, nor one of A within the numbers of B.
    """
    notes = []
    for dim in sorted(map(str, set(a.dims) & set(b.dims))):
        if dim not in a.coords or dim not in b.coords or a.indexes[dim].equals(b.indexes[dim]):
            continue
        shared = a.indexes[dim].intersection(b.indexes[dim])
        numbers = _number(a[dim]) and _number(b[dim])
        if not (len(shared) or numbers):
            raise DatasetError(f"{dim}: {_ends(a[dim])} of A and {_ends(b[dim])} of B; want values that both have")
        if len(shared):
            notes.append(f"{dim}: {len(shared)} values in both of {a.sizes[dim]} and {b.sizes[dim]}")
            a, b = a.sel({dim: shared}), b.sel({dim: shared})
        else:
            within = ((a[dim] >= float(b[dim].min())) & (a[dim] <= float(b[dim].max()))).values
            if not within.any():
                raise DatasetError(f"{dim}: {_ends(a[dim])} of A and {_ends(b[dim])} of B; want ranges that overlap")
            a = a.isel({dim: within})
            notes.append(f"{dim}: no value in both; B is interpolated to {a.sizes[dim]} points of A")
            b = b[[name for name, v in b.data_vars.items() if v.dtype.kind == "f"]].interp({dim: a[dim]})
    return a, b, notes


def _ends(axis: xr.DataArray) -> str:
    """First and last value of an axis."""
    return f"{axis.values[0]} to {axis.values[-1]}" if axis.size else "no value"


def _where(variable: xr.DataArray, index: tuple[Any, ...]) -> str:
    point = variable[index] if index else variable
    return ", ".join(f"{name}={point[name].item()}" for name in variable.dims if name in point.coords)


def moved(name: str, a: xr.DataArray, b: xr.DataArray, rtol: float) -> Moved:
    """One variable in both datasets."""
    units = str(a.attrs.get("units", ""))
    if a.dims != b.dims or a.shape != b.shape:
        return Moved(name, units, 0, 0, np.nan, np.nan, "", f"shapes {a.dims}{a.shape} and {b.dims}{b.shape}")
    if not (_number(a) and _number(b)):
        differ = a.values != b.values
        first = tuple(np.argwhere(differ)[0]) if differ.any() else ()
        note = f"{a.values[first]!s} -> {b.values[first]!s}" if differ.any() else ""
        return Moved(name, "", a.size, int(differ.sum()), np.nan, np.nan, _where(a, first) if note else "", note)
    x, y = a.values.astype(np.float64), b.values.astype(np.float64)
    lost = np.isnan(x) != np.isnan(y)
    same = (np.isnan(x) & np.isnan(y)) | (x == y)
    with np.errstate(divide="ignore", invalid="ignore"):
        apart = np.where(x == y, 0.0, np.abs(y - x))
        relative = np.where(apart == 0.0, 0.0, apart / np.abs(x))
    beyond = lost | (~same & ~(relative <= rtol))  # infinity becoming a number leaves no ratio
    if not beyond.any():
        return Moved(name, units, a.size, 0, float(np.nanmax(apart, initial=0.0)), 0.0, "")
    relative = np.where(np.isnan(relative), np.inf, relative)
    rank = np.where(lost, np.inf, np.where(beyond, relative, -1.0))
    index = tuple(np.unravel_index(int(np.argmax(rank)), rank.shape))
    note = f"{x[index]:.6g} -> {y[index]:.6g}" + (f"; {int(lost.sum())} known in one alone" if lost.any() else "")
    known = np.where(lost | same, 0.0, apart), np.where(lost | same, 0.0, relative)
    return Moved(
        name, units, a.size, int(beyond.sum()), float(known[0].max()), float(known[1].max()), _where(a, index), note
    )


def compared(a: xr.Dataset, b: xr.Dataset, rtol: float = 1e-9) -> tuple[list[Moved], list[str]]:
    """Every variable that both have, those that moved most first; and what else differs, in lines."""
    both_a, both_b, notes = common(a, b)
    for label, one, other in (("A", a, b), ("B", b, a)):
        alone = sorted(set(map(str, one.variables)) - set(map(str, other.variables)))
        if alone:
            notes.append(f"in {label} alone: {', '.join(alone)}")
    for name in sorted(set(a.attrs) | set(b.attrs)):
        if name not in PASSING and a.attrs.get(name) != b.attrs.get(name):
            notes.append(f"attribute {name}: {a.attrs.get(name, 'absent')} -> {b.attrs.get(name, 'absent')}")
    # Dimensions were brought to the same values; other coordinates are results like any.
    names = [str(name) for name in both_a.variables if name in both_b.variables and name not in both_a.dims]
    rows = [moved(name, both_a[name], both_b[name], rtol) for name in names]
    for name in sorted(map(str, set(a.variables) & set(b.variables))):
        units = a[name].attrs.get("units", "none"), b[name].attrs.get("units", "none")
        if units[0] != units[1]:
            notes.append(f"units of {name}: {units[0]} -> {units[1]}")
    return sorted(rows, key=lambda row: (row.moved == 0, -np.nan_to_num(row.relative))), notes


def _line(row: Moved) -> str:
    if not row.moved and not row.note:
        return f"{row.name}: {row.compared} values, none moved"
    if not row.compared:
        return f"{row.name}: cannot be compared, {row.note}"
    number = "" if np.isnan(row.relative) else f", by up to {row.relative:.3g} ({row.largest:.3g} {row.units})"
    return f"{row.name}: {row.moved} of {row.compared} values moved{number}; at {row.where or 'the value'}: {row.note}"


def main(argv: list[str]) -> None:
    """Compare two files and say what moved."""
    parser = argparse.ArgumentParser(
        prog="python -m studies.compare", description="What moved between two datasets, by how much and where."
    )
    parser.add_argument("a", type=Path, metavar="A.nc", help="dataset before")
    parser.add_argument("b", type=Path, metavar="B.nc", help="dataset after")
    parser.add_argument("--rtol", type=float, default=1e-9, help="relative change that counts (default: %(default)s)")
    arguments = parser.parse_args(argv)
    positive("--rtol", arguments.rtol, zero=True)
    pair = [load_dataset(path) for path in (arguments.a, arguments.b)]
    rows, notes = compared(pair[0], pair[1], arguments.rtol)
    print("\n".join([*notes, *map(_line, rows)]))
    moved_or_lost = any(row.moved or row.note for row in rows) or any(n.startswith(TELLING) for n in notes)
    if moved_or_lost or not any(row.compared for row in rows):
        sys.exit(1)


if __name__ == "__main__":
    run(main)
