"""How likely the noted outcomes are: probability of falling from runs at several strengths, with an error rate.

    P(falls) = q + (1 - 2 q) sum_k w_k F_k,    w_k ~ exp(-d_k^2 / (2 s^2))

F_k is whether the model falls under the motion at exp(d_k) times its strength.  The spread s of the strength (what is
not known of the motion, and what the model misses) and the error rate q (what has nothing to do with strength) are
fitted with each model, so that a model is not believed more than its own record of right outcomes allows.

Source   a psychometric function with a lapse rate: Wichmann & Hill (2001), Perception & Psychophysics 63, 1293-1313.
Status   closed forms for one strength; the null of a gain is simulated from the runs themselves (tests).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

SPREADS = (0.03, 0.1, 0.16, 0.25, 0.5)
ERROR_RATES = (0.005, 0.01, 0.02, 0.035, 0.05, 0.07, 0.1, 0.14, 0.19, 0.25, 0.32, 0.4)


@dataclass(frozen=True)
class Noise:
    """Spread of the logarithm of the strength [1], and rate of errors that no strength explains [1]."""

    spread: float
    error_rate: float


def weights(strengths: Sequence[float], spread: float) -> Array:
    """Weight of each strength, summing to one."""
    w = np.exp(-0.5 * (np.asarray(strengths) / spread) ** 2)
    return np.asarray(w / w.sum())


def shares(falls: Bools, strengths: Sequence[float], spread: float) -> Array:
    """Weighted share of strengths at which a model falls, shape (..., test) from (..., strength, test)."""
    return np.asarray(np.einsum("...kn,k->...n", falls.astype(float), weights(strengths, spread)))


def probability(falls: Bools, strengths: Sequence[float], noise: Noise) -> Array:
    """Probability of falling, shape (..., test) from falls of shape (..., strength, test)."""
    return noise.error_rate + (1.0 - 2.0 * noise.error_rate) * shares(falls, strengths, noise.spread)


def by_test(p: Array, fell: Bools) -> Array:
    """Logarithm of the probability of what was noted, by test."""
    return np.asarray(np.log(np.where(fell, p, 1.0 - p)))


@dataclass(frozen=True)
class Scored:
    """Log-likelihood of each model with its own noise; arrays of shape (model,)."""

    value: Array
    noise: tuple[Noise, ...]


def score(falls: Bools, strengths: Sequence[float], fell: Bools) -> Scored:
    """Largest log-likelihood of each model over the noise.

    Args:
        falls: shape (model, strength, test).
        strengths: their logarithms.
        fell: what was noted, shape (test,).
    """
    table, noises = _table(falls, strengths, fell[None, :])
    best = np.argmax(table[:, 0], axis=1)
    return Scored(np.max(table[:, 0], axis=1), tuple(noises[k] for k in best))


def best_over_draws(falls: Bools, strengths: Sequence[float], draws: Bools) -> Array:
    """Largest log-likelihood over models and noise for each set of outcomes, shape (draw,) from (draw, test)."""
    out = np.full(len(draws), -np.inf)
    for one in falls:
        table, _ = _table(one[None], strengths, draws)
        out = np.maximum(out, table[0].max(axis=1))
    return out


def _table(falls: Bools, strengths: Sequence[float], draws: Bools) -> tuple[Array, list[Noise]]:
    """Log-likelihoods, shape (model, draw, noise), and the noises."""
    noises = [Noise(s, q) for s in SPREADS for q in ERROR_RATES]
    out = np.empty((len(falls), len(draws), len(noises)))
    yes = draws.astype(float)
    for k, noise in enumerate(noises):
        p = probability(falls, strengths, noise)
        odds = np.log(p) - np.log1p(-p)
        out[:, :, k] = odds @ yes.T + np.log1p(-p).sum(axis=1)[:, None]
    return out, noises


def wrong(p: Array, fell: Bools) -> float:
    """Share of tests whose more probable outcome is not the noted one; NaN of none."""
    return float(np.mean((p > 0.5) != fell)) if fell.size else float("nan")
