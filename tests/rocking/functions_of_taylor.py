"""What the tests of functions of the Taylor solver share: NumPy arrays for vectors of the processor, runs, rows.

Nothing is compiled: every function is called by its Python source, loads and stores are those of arrays, and a vector
of the processor is a row of one.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numba.core.dispatcher import Dispatcher

from rocking.hybrid import ROTATION
from rocking.solvers.piecewise import polynomial
from rocking.solvers.taylor import flight, lanes, roots, turns, waits
from rocking.solvers.taylor import table as row
from rocking.solvers.taylor.records import BLOCK
from rocking.solvers.taylor.vector import LANES

G = 9.81
P2, ALPHA = 9.0, 0.23


class Row(np.ndarray):
    """One number for each lane."""

    def like(self, other: Any) -> Any:
        """A number in every lane."""
        return lanes_of(other)


def lanes_of(values: Any) -> Any:
    """The values, or one for all, as a row of lanes."""
    return np.broadcast_to(np.asarray(values, dtype=float), (LANES,)).copy().view(Row)


def put(t: Any, place: int, value: Any) -> None:
    t[place] = value


PLAIN = {
    "fma": lambda a, b, c: a * b + c,
    "fma_of": lambda a, b, c: a * b + c,
    "where": np.where,
    "where_of": np.where,
    "least": np.minimum,
    "least_of": np.minimum,
    "most": np.maximum,
    "most_of": np.maximum,
    "size": np.abs,
    "size_of": np.abs,
    "root_of": np.sqrt,
    "load": lambda t, place: lanes_of(t[place]),
    "store": put,
    "gather": lambda values, index: values[np.asarray(index, dtype=int)],
    "bits": lambda mask: sum(1 << lane for lane in range(LANES) if mask[lane]),
    "count": lambda mask: int(np.sum(mask)),
}


@pytest.fixture(autouse=True)
def interpreted(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Every function by its Python source."""
    for module in (polynomial, flight, roots, waits, lanes, turns):
        for name, thing in list(vars(module).items()):
            if isinstance(thing, Dispatcher):
                monkeypatch.setattr(module, name, thing.py_func)
            elif name in PLAIN:
                monkeypatch.setattr(module, name, PLAIN[name])
    with np.errstate(all="ignore"):
        yield


COEFFICIENTS = [lanes_of((-1.0) ** (n // 2) * (n + 1.3) ** 1.5 * np.linspace(0.5, 1.5, LANES)) for n in range(10)]


def column(c: Any, lane: int) -> np.ndarray:
    return np.array([part[lane] for part in c])


def runs_of(wave: bool, max_events: int = 50) -> Any:
    """Two runs: over a record of 40 or 30 samples, the second behind the first in one array; or over a sine."""
    rng = np.random.default_rng(9)
    values = np.zeros(128)
    values[:40], values[64:94] = rng.normal(size=40), rng.normal(size=30)
    motions = [[5.0, 0.4, 1.7, 1.5], [-9.0, 0.1, 2.0, 1.25]] if wave else [
        [1.5, 0.02, 0.25, 0.0, 40.0, 4.0], [-2.0, 0.03, 0.35, 64.0, 30.0, 3.0]]  # fmt: skip
    pars = np.array([[P2, ALPHA, G, 0.19, 0.8, 1e-6], [16.0, 0.3, 9.7, 0.25, 0.7, 1e-5]])
    starts = np.array([[ROTATION, 1.0, 0.1, 0.0, 0.0, 1.0], [ROTATION, -1.0, -0.4, 0.3, 0.4, 2.3]])
    return row.Runs(
        pars, starts, np.array(motions), None if wave else values, np.abs(values).reshape(-1, BLOCK).max(axis=1),
        max_events, np.full((2, 20), np.nan),
    )  # fmt: skip


def rows_are(table: Any, lane: int = 3, **want: float) -> None:
    for name, value in want.items():
        assert table[getattr(row, name), lane] == pytest.approx(value, rel=1e-12, abs=1e-300, nan_ok=True), name
