"""What pushes the block at the same times of every test, or of every one that is shaken: a fan, a drive that kicks.

A push of any shape has a coefficient for each short interval of a test.  Each acts on the swings of that time alone,
so that one linearisation says what all of them explain together, and those of longer intervals, which are sums of
them; the few that explain most for their number are fitted like anything else.  Any effect that a model lacks repeats
itself where tests do, at the same times then: what the others say of a test has to explain that one.

Source   forward selection: Miller (2002), Subset Selection in Regression, ch. 3; its price: Chen & Chen (2008),
         Biometrika 95, 759-771; length of intervals: Akaike (1974), IEEE Trans. Autom. Control 19, 716-723; B-splines
         as sums of finer ones: de Boor, A practical guide to splines (1978); tests left out in turn: Stone (1974),
         J. R. Stat. Soc. B 36, 111-147.
Status   gusts of a laboratory's fan are found, and none in campaigns where something else acts (tests)
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rocking import G_STANDARD
from rocking.altered import samples_of
from rocking.effects.learned_push import MOST, PUSHES, LearnedPush
from studies.loop.fits.fitting import Fit
from studies.loop.fits.linearising import HUBER, STEP, Linear, Prior, linearised, reduced, weights_of
from studies.loop.models.candidates import Candidate
from studies.loop.models.model import LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.observed.observing import jobs_of, observe
from studies.loop.observed.windows import Window
from studies.loop.runs.simulation import Simulator
from studies.loop.swings.trials import PAYS, Trial

Array = NDArray[np.float64]

PUSH = LearnedPush.name

SHORTEST = 0.2
"""Interval over 1/p: a shorter push than that moves a block by its sum alone."""

HALVINGS = 3
"""How often the longest interval is halved that is tried."""

FEWEST_TESTS = 4
"""Tests below which what is the same in all of them says little."""

MOST_PUSHES = 60
"""Coefficients that are fitted at the most."""

STILL = 3.0
"""How many times as far as in any release a base has to move in every test that is shaken, for a push to be told to go
with the shaking."""

CARRIED_OVER = 0.8
"""Share of what is explained that has to be explained by what other tests say."""


def pushing(simulator: Simulator, onto: Trial) -> tuple[Candidate, ...]:
    """A push at the times that explain most on top of a trial; none where other tests than a test say little of it.

    In all tests, or in those alone that are shaken, whichever explains more.  Not where accelerometers are read, which
    would feel a force otherwise than what the base does, nor where runs take long.
    """
    swing, declared = onto.swing, onto.swing.model.declared
    tests = sorted({w.test for w in swing.windows})
    if onto.costly or PUSH in onto.effects or len(tests) < FEWEST_TESTS or any(w.accelerometers for w in swing.windows):
        return ()
    longest = max(float(w.times[-1]) - simulator.spans[w.test][0] for w in swing.windows)
    interval = max(longest / (MOST - 3), SHORTEST / declared.p())
    size = 0.02 * G_STANDARD * declared.alpha
    every = [Parameter(f"{PUSH}.{name}", size, -50.0 * size, 50.0 * size) for name in PUSHES]
    every = every[: min(MOST, math.ceil(longest / interval) + 3)]
    fixed = {f"{PUSH}.interval": interval}
    slopes = _slopes(simulator, swing.model.changed(fixed), every, swing.windows, interval)
    plain = linearised(simulator, swing.model, swing.parameters, swing.windows)
    shaken = {test for test in tests if simulator.tests[test].kind == "forced"}
    still = _still(simulator, tests)
    found = [_best(*_of_each_test(onto, plain, slopes, tests), range(len(tests)), interval, swing)]
    if FEWEST_TESTS <= len(shaken) < len(tests) and still is not None:
        alone = [x if w.test in shaken else 0.0 * x for x, w in zip(slopes, swing.windows, strict=True)]
        own = [k for k, test in enumerate(tests) if test in shaken]
        found.append(_best(*_of_each_test(onto, plain, alone, tests), own, interval, swing))
    if all(each is None for each in found):
        return ()
    worth = [-math.inf if each is None else each.worth for each in found]
    k = max(range(len(found)), key=worth.__getitem__)
    best = found[k]
    assert best is not None
    fitted = tuple(every[j] for j in best.chosen)
    fixed = {f"{PUSH}.interval": best.interval}
    if k:
        fixed |= {f"{PUSH}.at_rest": 0.0, f"{PUSH}.still": float(still or 0.0)}
    label = "learned[push at the same times of shaking]" if k else "learned[push at the same times]"
    return (Candidate(label, PUSH, fitted, (), fixed),)


def _still(simulator: Simulator, tests: Sequence[int]) -> float | None:
    """Acceleration [m/s^2] between what bases do in releases, whose sensors may have recorded noise, and in tests that
    are shaken; None where these do not move by far more."""
    bases = {test: samples_of(simulator.bases[test], simulator.spans[test]).a_x for test in tests}
    moved = {test: float(np.max(np.abs(a_x))) for test, a_x in bases.items()}
    still = max((moved[test] for test in tests if simulator.tests[test].kind != "forced"), default=0.0)
    shaken = min((moved[test] for test in tests if simulator.tests[test].kind == "forced"), default=0.0)
    return math.sqrt(max(still, shaken / STILL**2) * shaken) if shaken > STILL * still else None


class _Best(NamedTuple):
    """Coefficients that are worth most."""

    worth: float
    chosen: list[int]
    interval: float  # [s]


def _best(
    matrices: Array, gradients: Array, pushed: Sequence[int], interval: float, swing: Fit
) -> _Best | None:  # fmt: skip
    """The best coefficients of intervals of all lengths; none where other tests than a test say little of them.

    matrices, gradients: of `_of_each_test`, of the shortest intervals.
    pushed: which of the tests are.
    swing: the fit of the swings without a push.
    """
    best: _Best | None = None
    price, spread = math.log(max(swing.samples, 2)), max(1.0, swing.chi2 / max(swing.samples, 1))
    for halving in range(HALVINGS + 1):
        sums = _sums(gradients.shape[1], halving)
        coarser, by = sums.T @ matrices @ sums, gradients @ sums
        chosen, gained = _chosen(coarser.sum(axis=0), by.sum(axis=0), price)
        pays = gained > PAYS * spread + price * len(chosen) and _carries_over(coarser, by, chosen, pushed)
        # Of how long intervals are Akaike's criterion asks: whole records predict by them, and bear no coarse shape.
        worth = gained - 2.0 * len(chosen)
        if pays and (best is None or worth > best.worth):
            best = _Best(worth, chosen, interval * 2**halving)
    return best


def _sums(count: int, halving: int) -> Array:
    """Of so many coefficients those that make up each one of intervals that are 2^halving times as long.

    Returns:
        Shape (coefficient, one of the longer intervals).
    """
    sums = np.eye(count)
    for _ in range(halving):
        # The first of either has its middle an interval of its own before the beginning.
        shares = np.zeros((sums.shape[1], (sums.shape[1] + 2) // 2 + 1))
        for j in range(shares.shape[1]):
            for k, share in enumerate((1.0, 4.0, 6.0, 4.0, 1.0), start=2 * j - 3):
                if 0 <= k < len(shares):
                    shares[k, j] = share / 8.0
        sums = sums @ shares
    return sums


def _slopes(
    simulator: Simulator, model: LoopModel, every: Sequence[Parameter], windows: Sequence[Window], interval: float
) -> list[Array]:
    """Derivatives by all coefficients, by window, shape (sample, coefficient); runs are those in which one acts."""
    models, jobs = [model.changed({p.name: 0.0 for p in every})], jobs_of(windows, 0)
    there, places = [*windows], list[tuple[int, int]]()
    begun = [simulator.spans[w.test][0] for w in windows]
    since = [(w.start - t, float(w.times[-1]) - t) for w, t in zip(windows, begun, strict=True)]
    for j, p in enumerate(every):
        models.append(model.changed({p.name: STEP * p.scale}))
        felt = [i for i, (first, last) in enumerate(since) if last > (j - 3) * interval and first < (j + 1) * interval]
        jobs += jobs_of([windows[i] for i in felt], j + 1)
        there += [windows[i] for i in felt]
        places += [(i, j) for i in felt]
    read = observe(simulator, models, jobs, there)
    out = [np.zeros((w.data.size, len(every))) for w in windows]
    for (i, j), moved in zip(places, read[len(windows) :], strict=True):
        apart = (read[i] - moved) * windows[i].weights / STEP
        out[i][:, j] = np.where(np.isfinite(apart), apart, 0.0)
    return out


def _of_each_test(onto: Trial, plain: Linear, slopes: Sequence[Array], tests: Sequence[int]) -> tuple[Array, Array]:
    """Normal equations of the coefficients, by test, shapes (test, coefficient, coefficient) and (test, coefficient).

    The states, and what is fitted already, are projected off; the latter by what all tests say of it.
    """
    swing, k, n = onto.swing, len(onto.swing.parameters), slopes[0].shape[1]
    weights = weights_of(swing.residuals, HUBER, False)
    both = [np.hstack(pair) for pair in zip(plain.by_parameters, slopes, strict=True)]
    priors = [
        p and Prior(p.residual, np.append(p.by_parameters, np.zeros(n)), p.by_theta) for p in plain.priors
    ]  # fmt: skip
    linear = Linear(plain.residuals, both, plain.by_state, priors)
    matrix, _, each = reduced(linear, swing.windows, weights)
    absorbed = np.linalg.pinv(matrix[:k, :k]) @ matrix[:k, k:] if k else np.zeros((0, n))
    matrices, gradients = np.zeros((len(tests), n, n)), np.zeros((len(tests), n))
    for part, w, weight in zip(each, swing.windows, weights, strict=True):
        A = part.A[:, k:] - part.A[:, :k] @ absorbed
        at = tests.index(w.test)
        matrices[at] += weight * (A.T @ A)
        gradients[at] -= weight * (A.T @ part.r)
    return matrices, gradients


def _gain(matrix: Array, gradient: Array) -> float:
    """By how much chi-square falls."""
    return float(gradient @ np.linalg.pinv(matrix, rcond=1e-8, hermitian=True) @ gradient)


def _chosen(matrix: Array, gradient: Array, price: float) -> tuple[list[int], float]:
    """Coefficients that are worth their price, chosen one after the other, with those beside them; what chi-square
    falls by.

    A push is not over at once: whole records show what a swing does not of how it begins and ends.  Of many
    coefficients that are nothing one is worth the price of a single one by chance.
    """
    shown = {int(j) for j in np.flatnonzero(np.diag(matrix) > 1e-6 * np.max(np.diag(matrix), initial=0.0))}
    chosen: list[int] = []
    gained = 0.0

    def with_neighbours(those: Sequence[int]) -> list[int]:
        return sorted({j + d for j in those for d in (-1, 0, 1)} & shown)

    while True:
        others = [j for j in sorted(shown - {*chosen}) if len(with_neighbours([*chosen, j])) <= MOST_PUSHES]
        each = [_gain(matrix[np.ix_(c, c)], gradient[c]) for c in ([*chosen, j] for j in others)]
        k = int(np.argmax(each)) if each else 0
        if not each or each[k] - gained < price + 2.0 * math.log(len(shown)):
            break
        chosen.append(others[k])
        gained = each[k]
    all_of_them = with_neighbours(chosen)
    return all_of_them, _gain(matrix[np.ix_(all_of_them, all_of_them)], gradient[all_of_them])


def _carries_over(matrices: Array, gradients: Array, chosen: Sequence[int], pushed: Sequence[int]) -> bool:
    """Whether what the other tests say of a push explains a test, of all tests together that are pushed."""
    at = np.ix_(chosen, chosen)
    own, g = np.array([m[at] for m in matrices]), gradients[:, chosen]
    all_of_them = _gain(own.sum(axis=0), g.sum(axis=0))
    explained = 0.0
    for t in pushed:
        others = np.linalg.pinv(own.sum(axis=0) - own[t], rcond=1e-8, hermitian=True) @ (g.sum(axis=0) - g[t])
        explained += float(2.0 * g[t] @ others - others @ own[t] @ others)
    return explained > CARRIED_OVER * all_of_them
