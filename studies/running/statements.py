"""Statements of a paper as numbers: what decides, whether it holds, and the table of them in a dataset.

A `Claim` says beforehand what number is to be found and which bound decides; a `Finding` is that number.  A claim
without a relation asks for a number and decides nothing.

Source   none, own convention
Status   a number that is not known decides nothing (tests)
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np
import xarray as xr

HOLDS, DOES_NOT, UNDECIDED = 1, 0, -1
VERDICTS = {HOLDS: "holds", DOES_NOT: "does not hold", UNDECIDED: "not decided"}
FLAGS = {
    "flag_values": np.array([HOLDS, DOES_NOT, UNDECIDED], dtype=np.int8),
    "flag_meanings": "holds does_not_hold not_decided",
}

Relation = Literal["<=", "<", ">=", ">", ""]


@dataclass(frozen=True)
class Claim:
    """One statement, in our words, with what decides it."""

    key: str  # "study.word"
    statement: str
    place: str  # where in the paper
    number: str  # what is computed
    relation: Relation = ""
    bound: float = math.nan
    units: str = "1"
    depends: str = ""  # parameters that the paper does not print and on which the number hangs

    @property
    def study(self) -> str:
        """The study whose dataset holds what decides."""
        return self.key.partition(".")[0]

    @property
    def decides(self) -> str:
        """The number asked for and its bound, in a line."""
        unit = "" if self.units == "1" else f" {self.units}"
        return f"{self.number} {self.relation} {self.bound:g}{unit}" if self.relation else f"{self.number} (no bound)"

    def verdict(self, number: float) -> int:
        """HOLDS, DOES_NOT, or UNDECIDED where the number is not known or there is no bound."""
        if math.isnan(number) or not self.relation:
            return UNDECIDED
        met = {
            "<=": number <= self.bound,
            "<": number < self.bound,
            ">=": number >= self.bound,
            ">": number > self.bound,
        }
        return HOLDS if met[self.relation] else DOES_NOT


@dataclass(frozen=True)
class Finding:
    """A claim, the number found, and the number in its parts."""

    claim: Claim
    number: float
    detail: str = ""

    @property
    def verdict(self) -> int:
        """As of `Claim.verdict`."""
        return self.claim.verdict(self.number)


def listed(numbers: dict[str, float], digits: int = 3) -> str:
    """Named numbers in a line."""
    return "; ".join(f"{name} {number:.{digits}g}" for name, number in numbers.items())


def table(findings: Iterable[Finding]) -> xr.Dataset:
    """The findings over the dimension `statement`."""
    rows = list(findings)

    def text(long_name: str, values: list[str]) -> tuple[str, list[str], dict[str, str]]:
        return "statement", values, {"long_name": long_name}

    return xr.Dataset(
        {
            "statement_key": text("name of the statement", [row.claim.key for row in rows]),
            "statement_place": text("where in the paper", [row.claim.place for row in rows]),
            "statement_number": ("statement", [row.number for row in rows], {"long_name": "number found"}),
            "statement_units": text("unit of the number", [row.claim.units for row in rows]),
            "statement_bound": text("what decides", [row.claim.decides for row in rows]),
            "statement_detail": text("the number in its parts", [row.detail for row in rows]),
            "statement_depends": text("what the number hangs on", [row.claim.depends for row in rows]),
            "statement_holds": (
                "statement",
                np.array([row.verdict for row in rows], dtype=np.int8),
                {"long_name": "does the statement hold", **FLAGS},
            ),
        },
        coords={
            "statement": ("statement", [row.claim.statement for row in rows], {"long_name": "statement of the paper"})
        },
    )
