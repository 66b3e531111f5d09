"""Least squares over windows, each with a state of its own that is eliminated: variable projection, window by window.

Parameters may be fitted in a transformed scale (logarithm).  A fit that its keeper knows is not done again.

Source   Levenberg (1944), Marquardt (1963).
Status   recovery of planted parameters (tests).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studies.loop.fits.linearising import (
    HUBER,
    ROBUST,
    compared_all,
    free_states,
    linearised,
    objectives,
    read_of,
    reduced,
    stepped,
    weights_of,
)
from studies.loop.models.model import LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.observed.windows import Window
from studies.loop.runs.keeping import Results, digest_of
from studies.loop.runs.simulation import Simulator

Array = NDArray[np.float64]

REACH = 4.0
"""A step of a fit moves a logarithm by so many scales at the most: where it says little, its slope points anywhere."""

DRAWN_IN = 10.0
"""And for fits of whole records by Huber's sum."""

POLISH = 4
"""Iterations by the logarithm after these."""


@dataclass(frozen=True)
class Fit:
    """What came out of a fit."""

    model: LoopModel
    parameters: tuple[Parameter, ...]
    windows: tuple[Window, ...]  # with the fitted states
    chi2: float  # sum of squares over the variances, less for windows far off, prior included
    rms: float  # root mean square over the standard deviations, plain
    samples: int
    converged: bool
    residuals: tuple[Array, ...]  # weighted, by window
    whole: bool = False  # whether the windows are whole records

    @property
    def values(self) -> dict[str, float]:
        """Fitted values by full name."""
        return {p.name: self.model.get(p.name) for p in self.parameters}

    @property
    def by_window(self) -> Array:
        """Rms over the standard deviation, by window."""
        return np.array([math.sqrt(float(np.mean(r * r))) for r in self.residuals])

    @property
    def weights(self) -> Array:
        """How much each window counts [1]."""
        return weights_of(self.residuals, ROBUST if self.whole else HUBER, self.whole)

    def of(self, chosen: Sequence[int]) -> Fit:
        """What it says of some windows; sums stay those of all."""
        some = [(self.windows[i], self.residuals[i]) for i in chosen]
        return replace(self, windows=tuple(w for w, _ in some), residuals=tuple(r for _, r in some))

    @property
    def spread(self) -> float:
        """Mean square over the variances, windows far off counting as little as in a fit; 1 or more."""
        squares = sum(w * float(r @ r) for w, r in zip(self.weights, self.residuals, strict=True))
        return max(1.0, squares / max(self.samples, 1))


def fit(
    simulator: Simulator,
    model: LoopModel,
    parameters: Sequence[Parameter],
    windows: Sequence[Window],
    *,
    huber: float | None = None,
    whole: bool = False,
    iterations: int = 15,
    tolerance: float = 1e-3,
    start_damping: float = 1e-3,
    central: bool = False,
) -> Fit:
    """Fit the parameters and the states at the starts of the windows.

    Args:
        simulator, model: where to start; effects of the parameters are in it.
        parameters: what to fit; none fits the states alone.
        windows: with states to start from.
        huber: rms of a window beyond which it counts less; `HUBER`, or `ROBUST` for whole records, if not given; inf
            for plain least squares.
        whole: whether windows are whole records, which count by the logarithm beyond that.
        iterations: the most that are done.
        tolerance: a relative fall of the sum of squares below which the fit has converged.
        central: whether slopes are central differences; whole records bend too much for one-sided ones.

    Returns:
        Fit: the best point that was met.
    """
    if huber is None:
        huber = ROBUST if whole else HUBER
    how = _How(huber, whole, iterations, tolerance, start_damping, central)
    if simulator.keeper is None:
        return _fit(simulator, model, parameters, windows, how)
    key = digest_of("fit", simulator.digest, model, tuple(parameters), tuple(windows), how)
    kept = simulator.keeper.read(key)
    if kept is not None:
        return _restored(kept, model, parameters, windows, whole)
    found = _fit(simulator, model, parameters, windows, how)
    simulator.keeper.write(key, _results(found))
    return found


def fit_records(
    simulator: Simulator, model: LoopModel, parameters: Sequence[Parameter], windows: Sequence[Window], *,
    iterations: int = 15, again: bool = True,
) -> Fit:  # fmt: skip
    """Fit whole records, those far off counting by the logarithm.

    A record that is lost at the start may stay so, since it hardly counts: if one is lost at the end, the fit begins
    again where Huber's sum draws it in.

    again: False to leave that out.
    """
    found = fit(simulator, model, parameters, windows, whole=True, iterations=iterations, central=True)
    if not parameters or not again or found.by_window.max(initial=0.0) < ROBUST:
        return found
    drawn = fit(simulator, model, parameters, windows, huber=DRAWN_IN, iterations=iterations, central=True)
    other = fit(simulator, drawn.model, parameters, drawn.windows, whole=True, iterations=POLISH, central=True)
    return min(found, other, key=lambda f: f.chi2)


@dataclass(frozen=True)
class _How:
    """Options of a fit."""

    huber: float
    whole: bool
    iterations: int
    tolerance: float
    start_damping: float
    central: bool


def _results(found: Fit) -> dict[str, Array]:
    """A fit as arrays."""
    return {
        "values": np.array([found.model.get(p.name) for p in found.parameters]),
        "states": np.array([(w.theta, w.omega) for w in found.windows]).reshape(len(found.windows), 2),
        "numbers": np.array([found.chi2, found.rms, found.samples, found.converged]),
        "sizes": np.array([r.size for r in found.residuals], dtype=np.int64),
        "residuals": np.concatenate([np.zeros(0), *found.residuals]),
    }


def _restored(
    kept: Results, model: LoopModel, parameters: Sequence[Parameter], windows: Sequence[Window], whole: bool
) -> Fit:
    """The fit that was kept as arrays."""
    values = {p.name: float(v) for p, v in zip(parameters, kept["values"], strict=True)}
    moved = [w.moved(float(a), float(b)) for w, (a, b) in zip(windows, kept["states"], strict=True)]
    chi2, rms, samples, converged = kept["numbers"]
    each = np.split(kept["residuals"], np.cumsum(kept["sizes"])[:-1]) if windows else []
    return Fit(
        model.changed(values), tuple(parameters), tuple(moved), float(chi2), float(rms), int(samples),
        bool(converged), tuple(each), whole,
    )  # fmt: skip


def _fit(
    simulator: Simulator, model: LoopModel, parameters: Sequence[Parameter], windows: Sequence[Window], how: _How
) -> Fit:
    windows = list(windows)
    damping, converged = how.start_damping, False
    read = read_of(simulator, model, windows)
    for _ in range(how.iterations):
        lin = linearised(simulator, model, parameters, windows, central=how.central, read=read)
        each = objectives(model, lin.residuals, windows, how.huber, how.whole)
        objective = float(each.sum())
        weights = weights_of(lin.residuals, how.huber, how.whole)
        matrix, gradient, back = reduced(lin, windows, weights)
        accepted = False
        for _ in range(8):
            step = _solve(matrix, gradient, damping)
            values = _moved(model, parameters, step)
            actual = np.array([
                p.inner(values[p.name]) - p.inner(model.get(p.name)) for p in parameters
            ])  # fmt: skip
            try:
                trial = model.changed(values)
                known = None if parameters else read
                better = _better(simulator, trial, windows, stepped(windows, back, actual), each, how, known)
            except ValueError:
                damping = max(damping, 1e-6) * 10.0
                continue
            if better.objective < objective:
                accepted = True
                break
            damping = max(damping, 1e-6) * 10.0
            if damping > 1e8 or not parameters:  # states alone are not damped
                break
        if not accepted:
            converged = True
            break
        fall = (objective - better.objective) / max(better.objective, 1e-30)
        model, windows, read = trial, better.windows, better.read
        damping = max(damping * 0.2, 1e-9)
        if fall < how.tolerance:
            converged = True
            break
    left = compared_all(read, windows)
    joined = np.concatenate(left) if left else np.zeros(0)
    return Fit(
        model, tuple(parameters), tuple(windows), float(objectives(model, left, windows, how.huber, how.whole).sum()),
        math.sqrt(float(np.mean(joined**2))) if joined.size else math.nan, joined.size, converged, tuple(left),
        how.whole,
    )  # fmt: skip


@dataclass(frozen=True)
class _Better:
    """Windows with states that are no worse than they were, what their channels read, and the sum of squares."""

    windows: list[Window]
    read: list[Array]
    objective: float


def _better(
    simulator: Simulator, model: LoopModel, windows: Sequence[Window], stepped: Sequence[Window], before: Array,
    how: _How, known: Sequence[Array] | None,
) -> _Better:  # fmt: skip
    """Of each window the stepped state, or a shorter step or none where that is better.

    A window whose linearisation says nothing (an impact on the wrong side of a sample) would else stop all others.

    known: what the channels read under this model from the states before the step, if that is known.
    """

    def read_at(indices: Sequence[int], states: Sequence[Window]) -> list[Array]:
        before, kept = [windows[i] for i in indices], [None if known is None else known[i] for i in indices]
        return _read_where_changed(simulator, model, states, before, kept)

    chosen, free = list(stepped), np.array([bool(free_states(w)) for w in windows], dtype=bool)
    read = read_at(range(len(windows)), chosen)
    each = objectives(model, compared_all(read, chosen), chosen, how.huber, how.whole)
    for share in (0.25, 0.0):
        worse = [*map(int, np.flatnonzero((each > before) & free))]
        if not worse:
            break
        other = [
            windows[i].moved(
                windows[i].theta + share * (stepped[i].theta - windows[i].theta),
                windows[i].omega + share * (stepped[i].omega - windows[i].omega),
            )
            for i in worse
        ]  # fmt: skip
        there = read_at(worse, other)
        found = objectives(model, compared_all(there, other), other, how.huber, how.whole)
        for i, window, seen, value in zip(worse, other, there, found, strict=True):
            if value < each[i]:
                chosen[i], read[i], each[i] = window, seen, value
    return _Better(chosen, read, float(each.sum()))


def _read_where_changed(
    simulator: Simulator, model: LoopModel, windows: Sequence[Window], before: Sequence[Window],
    known: Sequence[Array | None],
) -> list[Array]:  # fmt: skip
    """What the channels of windows read; without a run where that is known and the state is as it was before."""
    same = [(w.theta, w.omega) == (b.theta, b.omega) for w, b in zip(windows, before, strict=True)]
    kept = [read if at_it else None for read, at_it in zip(known, same, strict=True)]
    runs = iter(read_of(simulator, model, [w for w, read in zip(windows, kept, strict=True) if read is None]))
    return [next(runs) if read is None else read for read in kept]


def _solve(matrix: Array, gradient: Array, damping: float) -> Array:
    if not gradient.size:
        return np.zeros(0)
    scale = np.sqrt(np.maximum(np.diag(matrix), 1e-30))
    normal = matrix / np.outer(scale, scale)
    return np.asarray(-np.linalg.lstsq(normal + damping * np.eye(len(scale)), gradient / scale, rcond=1e-12)[0] / scale)


def _moved(model: LoopModel, parameters: Sequence[Parameter], step: Array) -> dict[str, float]:
    moved = (min(max(float(d), -REACH), REACH) if p.log else float(d) for p, d in zip(parameters, step, strict=True))
    return {p.name: p.outer(p.inner(model.get(p.name)) + d) for p, d in zip(parameters, moved, strict=True)}
