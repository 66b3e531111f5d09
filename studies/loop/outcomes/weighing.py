"""What follows from all that was run: intervals, rivals that cannot be told apart, the test to do next.

Source   intervals: Bayesian bootstrap over motions, Rubin (1981), since tests of one motion are no independent facts.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studies.loop.outcomes.data import OutcomeData
from studies.loop.outcomes.likelihood import ERROR_RATES, Array, Noise, by_test, probability, shares
from studies.loop.outcomes.runs import FINE, NOMINAL, Runs
from studies.loop.outcomes.search import Search, Tried, closer

TWIN = 8.0
"""Rivals whose criterion is within this of the best cannot be told apart: odds of exp(-4) or better."""

DRAWS = 1000
LEVEL = 0.95

WILKS = 1.92
"""Fall of the log-likelihood from the best to the ends of a 95 % interval, where it is smooth."""


def densely(search: Search, tried: Tried) -> Tried:
    """With more points about the best ones, so that intervals have something to be read from."""
    for spread in (0.04, 0.02, 0.01):
        tried = closer(search, tried, spread, search.count, f"dense {tried.names}")
    return search.settled(tried, 8)


def intervals(
    search: Search, tried: Tried, group: NDArray[np.int64], floor: float, seed: int = 0
) -> dict[str, tuple[float, float, float]]:
    """Value and 95 % interval of each parameter.

    Motions are weighed anew and the best of the points is read off each time; points that are about as likely as the
    best are within the interval in any case.

    Args:
        tried: with points that lie densely about the best.
        group: motion of each fitted test, shape (test,).
        floor: share of outcomes that base noise alone flips: twice the standard deviation of their number, at what each
            is worth, is allowed on top of Wilks's fall, since so much of a peak is luck.
    """
    models = [point.model for point in tried.points]
    falls = search.runs.falls(models, NOMINAL)
    rates = [probability(falls, NOMINAL, Noise(1.0, q)) for q in ERROR_RATES]
    table = np.array([by_test(p, search.fell) for p in rates])  # (rate, model, test)
    weights = np.random.default_rng(seed).standard_exponential((DRAWS, int(group.max()) + 1))[:, group]
    value = np.max(np.einsum("rmt,dt->rmd", table, weights), axis=0)
    chosen = np.argmax(value, axis=0)
    each = table.sum(axis=2)
    whole, rate = np.max(each, axis=0), ERROR_RATES[int(np.argmax(np.max(each, axis=1)))]
    n = search.fell.size
    drop = WILKS + 2.0 * np.sqrt(n * floor * (1.0 - floor) + 1.0) * np.log((1.0 - rate) / rate)
    chosen = np.concatenate([chosen, np.flatnonzero(whole >= whole.max() - drop)])
    out = {}
    for p in tried.parameters:
        every = np.array([model.get(p.name) for model in models])
        low, high = np.quantile(every[chosen[:DRAWS]], [0.5 * (1.0 - LEVEL), 0.5 * (1.0 + LEVEL)])
        low, high = min(low, every[chosen[DRAWS:]].min()), max(high, every[chosen[DRAWS:]].max())
        at = tried.top.model.get(p.name)
        # Between two points that were run nothing is known.
        gap = _gap(every, at)
        out[p.name] = (at, max(min(low, at) - gap, p.low), min(max(high, at) + gap, p.high))
    return out


def _gap(values: Array, at: float) -> float:
    """Half of the way to the third nearest value."""
    away = np.sort(np.abs(values - at))
    return 0.5 * float(away[min(3, away.size - 1)])


def near(search: Search, refined: Sequence[Tried], best: Tried) -> tuple[Tried, ...]:
    """Those that are within TWIN of the best, the best first."""
    limit = search.criterion(best) - TWIN
    return (best, *(t for t in refined if t.names != best.names and search.criterion(t) > limit))


def twins(rivals: Sequence[Tried]) -> tuple[tuple[str, ...], ...]:
    """Sets of effects that these outcomes cannot tell apart, by what was added last."""
    names = list(dict.fromkeys(t.effects[-1] for t in rivals if t.effects))
    return (tuple(names),) if len(names) > 1 else ()


def next_test(data: OutcomeData, runs: Runs, rivals: Sequence[Tried]) -> str:
    """The motion and strength at which the rivals' probabilities of falling differ most, as a sentence."""
    record = (
        "One record of the rotation (a free decay from a lean, a film of it will do) says more of the block "
        "than dozens of outcomes."
    )
    if len(rivals) < 2:
        return record
    falls = runs.falls([t.top.model for t in rivals], FINE)
    best: tuple[float, int, float, Array] | None = None
    for k, strength in enumerate(FINE):
        # A little more or less than that strength, as a table repeats it.
        some = [j for j in range(len(FINE)) if abs(j - k) <= 1]
        p = shares(falls[:, some], [FINE[j] - strength for j in some], 0.1)
        gap = p.max(axis=0) - p.min(axis=0)
        i = int(np.argmax(gap))
        if best is None or gap[i] > best[0]:
            best = (float(gap[i]), i, strength, p[:, i])
    assert best is not None
    _, i, strength, p = best
    test = runs.tests[i]
    said = "; ".join(
        f"{' and '.join(t.names) or 'the calibrated block'}: {q:.2f}" for t, q in zip(rivals, p, strict=True)
    )
    motion = f" (motion {test.motion})" if test.motion else ""
    return (
        f"Repeat test {test.id}{motion} a few times at {np.exp(strength):.2f} of its strength; probability of "
        f"falling by {said}. {record}"
    )
