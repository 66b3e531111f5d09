"""The paper's checkable statements in one table: number found, what decides, whether it holds, what it hangs on.

    python -m studies.claims [--out DIR]    ->  claims.txt, claims.csv and claims.nc there

takes the datasets that are in the folder and computes nothing anew but the numbers of the statements.  The bounds were
written down before the first result: `studies.claims.bounds`.  A statement whose study has not been made is listed too.
"""

from __future__ import annotations

import argparse
import csv
import math
import shlex
import textwrap
from pathlib import Path
from typing import Any

import xarray as xr

from studies.claims.bounds import CLAIMS
from studies.running.command_line import DEFAULT_OUT, run
from studies.running.files import (
    BadInputError,
    DatasetError,
    load_dataset,
    provenance,
    save_dataset,
    save_text,
    write_whole,
)
from studies.running.registry import studies
from studies.running.statements import HOLDS, UNDECIDED, VERDICTS, Claim, Finding, table
from studies.running.study import Study

MISSING = "its study has not been made"


def gathered(folder: Path) -> xr.Dataset:
    """The statements of every dataset in the folder, and those whose study is not there.

    Raises:
        BadInputError: no dataset of a study is in the folder, or one is damaged or of something else.
    """
    found, made = [], 0
    for study in studies().values():
        path = folder / f"{study.name}.nc"
        if not path.exists():
            continue
        made += 1
        rows = _checked(study, path)
        if rows.sizes.get("statement"):
            rows = rows.drop_vars([name for name in rows.variables if "statement" not in rows[name].dims])
            found.append(_complete(rows, study.name))
    if not made:
        raise BadInputError(f"--out {folder}: no dataset of a study is there; python -m studies all makes them")
    known = {str(key) for rows in found for key in rows.statement_key.values}
    absent = [Finding(claim, math.nan, MISSING) for key, claim in CLAIMS.items() if key not in known]
    if absent:
        found.append(_complete(table(absent), ""))
    return xr.concat(found, "statement", data_vars="minimal", coords="minimal", join="outer", combine_attrs="override")


def _checked(study: Study, path: Path) -> xr.Dataset:
    ds = load_dataset(path)
    again = f"python -m studies.{study.name} makes it again"
    if ds.attrs.get("study") != study.name:
        raise DatasetError(f"{path}: is of study {ds.attrs.get('study')!r}, want {study.name!r}; {again}")
    try:
        return study.check(ds)
    except (AttributeError, IndexError, KeyError, TypeError, ValueError) as error:
        said = f"{type(error).__name__}: {error}".splitlines()[0][:120]
        raise DatasetError(f"{path}: lacks what the study puts there ({said}); {again}") from error


def _complete(rows: xr.Dataset, study: str) -> xr.Dataset:
    """The rows with every column of the table of statements, what is missing empty, and the study's name."""
    empty = table([Finding(Claim("", "", "", ""), math.nan)])
    count = rows.sizes["statement"]
    columns: dict[str, Any] = {}
    for name, column in empty.data_vars.items():
        if name in rows:
            columns[str(name)] = ("statement", rows[name].values, column.attrs)
        else:
            columns[str(name)] = ("statement", [""] * count, column.attrs)
    keys = [str(key) or f"{study}.{i + 1}" for i, key in enumerate(columns["statement_key"][1])]
    columns["statement_key"] = ("statement", keys, empty.statement_key.attrs)
    names = [study or key.partition(".")[0] for key in keys]
    columns["statement_study"] = ("statement", names, {"long_name": "study that holds the number"})
    return xr.Dataset(columns, {"statement": ("statement", rows.statement.values, empty.statement.attrs)})


def _verdict(row: xr.Dataset) -> str:
    if row.statement_detail.item() == MISSING:
        return "not made"
    informative = int(row.statement_holds) == UNDECIDED and row.statement_bound.item().endswith("(no bound)")
    return "number only" if informative else VERDICTS[int(row.statement_holds)]


def as_text(ds: xr.Dataset, width: int = 110) -> str:
    """The table in lines."""
    lines, counts = [], dict[str, int]()
    for i in range(ds.sizes["statement"]):
        row = ds.isel(statement=i)
        verdict = _verdict(row)
        counts[verdict] = counts.get(verdict, 0) + 1
        lines.append(f"{verdict.upper():14s} {row.statement.item()}  [{row.statement_key.item()}]")
        unit = row.statement_units.item()
        number = f"{float(row.statement_number):.4g}" + (f" {unit}" if unit not in ("", "1") else "")
        said = [
            ("paper", row.statement_place.item()),
            ("found", f"{number};  {row.statement_bound.item()}"),
            ("", row.statement_detail.item()),
            ("depends", row.statement_depends.item()),
        ]
        for head, text in said:
            if text:
                lines += textwrap.wrap(text, width, initial_indent=f"    {head:8s} ", subsequent_indent=" " * 13)
        lines.append("")
    return "\n".join([*lines, "; ".join(f"{n} {verdict}" for verdict, n in counts.items())]) + "\n"


def _write_csv(ds: xr.Dataset, path: Path) -> None:
    columns = ["statement_key", "statement", "statement_place", "statement_number", "statement_units"]
    columns += ["statement_bound", "statement_holds", "statement_detail", "statement_depends", "statement_study"]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(zip(*(ds[name].values.tolist() for name in columns), strict=True))


def main(argv: list[str]) -> None:
    """Gather, print and save."""
    parser = argparse.ArgumentParser(
        prog="python -m studies.claims",
        description="The paper's checkable statements, from the datasets that `python -m studies all` has made.",
    )
    parser.add_argument("--out", type=Path, default=DEFAULT_OUT, metavar="DIR", help="folder (default: %(default)s)")
    folder: Path = parser.parse_args(argv).out
    ds = gathered(folder)
    command = shlex.join(["python", "-m", "studies.claims", *argv])
    ds.attrs = provenance("Statements of Winkler, Meguro & Yamazaki (1995) as numbers", command)
    text = as_text(ds)
    print(text, end="")
    save_dataset(ds, folder / "claims.nc")
    save_text(text, folder / "claims.txt")
    write_whole(folder / "claims.csv", lambda path: _write_csv(ds, path))
    held = int((ds.statement_holds == HOLDS).sum())
    print(f"{held} of {ds.sizes['statement']} hold; wrote {folder / 'claims.nc'}, claims.txt and claims.csv")


if __name__ == "__main__":
    run(main)
