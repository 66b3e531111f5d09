"""Coordinates and variables that several studies share, with units and names.

Source   CF conventions 1.11 for the attributes
Status   every dataset is checked (tests)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from studies.specimens import specimen

Variable = tuple[Any, Any, dict[str, Any]]

FREQUENCIES = tuple(np.arange(1.0, 5.01, 0.5).tolist())
"""Of the tests [Hz]: 1 to 5 Hz in steps of 0.5 Hz."""

QUICK_FREQUENCIES = (1.0, 3.0, 5.0)

PAPER = "Winkler, Meguro & Yamazaki (1995)"


def frequency_axis(frequencies: Sequence[float]) -> dict[str, Variable]:
    """The coordinate `frequency`."""
    attributes = {"units": "Hz", "long_name": "frequency of the base motion"}
    return {"frequency": ("frequency", list(frequencies), attributes)}


def block_axis(blocks: Sequence[int]) -> dict[str, Variable]:
    """The coordinate `block`, numbers of Table 1, with sizes and slenderness along it."""
    found = [specimen(number) for number in blocks]
    return {
        "block": ("block", list(blocks), {"units": "1", "long_name": "block of Table 1"}),
        "b": ("block", [x.b for x in found], {"units": "m", "long_name": "breadth"}),
        "h": ("block", [x.h for x in found], {"units": "m", "long_name": "height"}),
        "alpha": ("block", [x.alpha for x in found], {"units": "rad", "long_name": "slenderness angle"}),
    }


def names_axis(dim: str, names: Sequence[str], long_name: str) -> dict[str, Variable]:
    """A coordinate of names."""
    return {dim: (dim, list(names), {"long_name": long_name})}


def gathered(
    results: Sequence[Mapping[str, Any]],
    dims: Sequence[str],
    shape: tuple[int, ...],
    labels: Mapping[str, tuple[str, str]],
) -> dict[str, Variable]:
    """Variables over `dims` from one result for each point, in C order.

    Args:
        results: numbers and texts by name.
        dims, shape: of the variables.
        labels: (units, long name) of what is taken, by name; units "" for texts.
    """
    found: dict[str, Variable] = {}
    for name, (units, long_name) in labels.items():
        values = np.array([result[name] for result in results]).reshape(shape)
        found[name] = (tuple(dims), values, ({"units": units} if units else {}) | {"long_name": long_name})
    return found
