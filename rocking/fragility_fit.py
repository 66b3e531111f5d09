"""Lognormal fragility: maximum likelihood from single outcomes, and intervals of fractions.

    P(exceed | im) = Phi( ln(im / median) / beta )

The two numbers are the maximum of the likelihood of all outcomes, a probit regression on ln(im): no binning, no fit to
fractions.

Source   Baker (2015), Earthquake Spectra 31, 579-599: likelihood of a lognormal fragility; Clopper & Pearson (1934) and
         Wilson (1927): intervals of a fraction; Silvapulle (1981), J. R. Stat. Soc. B 43, 310-313: when an estimate
         exists; Liang & Zeger (1986), Biometrika 73, 13-22: covariance when outcomes come in groups.
Status   the lognormal form is an assumption: compare it with the fractions, which assume nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rocking.arguments import array_of
from rocking.validation import real

Array = NDArray[np.float64]

MAX_ITERATIONS = 100
"""Newton steps of the fit, each halved until the likelihood rises; a dozen are usual."""


@dataclass(frozen=True)
class LognormalFragility:
    """A fitted fragility with its uncertainty."""

    median: float  # intensity at which half of the cases exceed, in units of the intensity
    beta: float  # standard deviation of the logarithm of the intensity that is needed [1]
    covariance: Array  # of (ln median, ln beta), shape (2, 2)
    log_likelihood: float

    def probability(self, im: ArrayLike) -> Array:
        """Chance of exceedance at the intensity `im`, any shape; 0 at 0 and below."""
        from scipy.special import ndtr

        values = np.asarray(im, dtype=np.float64)
        safe = np.where(values > 0.0, values, 1.0)
        return np.asarray(np.where(values > 0.0, ndtr(np.log(safe / self.median) / self.beta), 0.0))

    def intervals(self, confidence: float = 0.95) -> tuple[tuple[float, float], tuple[float, float]]:
        """Confidence intervals of median and beta, from the normal limit of their logarithms."""
        from scipy.special import ndtri

        check_share("confidence", confidence)
        wide = float(ndtri(0.5 + 0.5 * confidence)) * np.sqrt(np.diag(self.covariance))
        median, beta = (
            (float(value * math.exp(-w)), float(value * math.exp(w)))
            for value, w in zip((self.median, self.beta), wide, strict=True)
        )
        return median, beta


def check_share(name: str, value: float) -> None:
    if not 0.0 < real(value) < 1.0:
        raise ValueError(f"{name}={value!r}: want above 0 and below 1")


def fraction(
    exceeded: ArrayLike,
    total: ArrayLike,
    *,
    confidence: float = 0.95,
    interval: Literal["clopper-pearson", "wilson"] = "clopper-pearson",
) -> tuple[Array, Array, Array]:
    """(fraction, lower, upper) for `exceeded` out of `total` cases, of the shape of both; NaN where there is no case.

    Args:
        exceeded, total: numbers of cases, integers, 0 <= exceeded <= total.
        confidence: of the interval.
        interval: "clopper-pearson" never covers less than `confidence`; "wilson" is narrower, and right on average.

    Raises:
        ValueError: the numbers are no counts, or an argument is out of range.
    """
    from scipy.stats import binomtest

    check_share("confidence", confidence)
    if interval not in ("clopper-pearson", "wilson"):
        raise ValueError(f"interval={interval!r}: want 'clopper-pearson' or 'wilson'")
    k, n = np.broadcast_arrays(array_of("exceeded", exceeded), array_of("total", total))
    if not (np.all(k == np.floor(k)) and np.all(n == np.floor(n)) and np.all((k >= 0) & (k <= n))):
        raise ValueError("exceeded, total: want whole numbers with 0 <= exceeded <= total")
    method: Any = "exact" if interval == "clopper-pearson" else "wilson"
    rows = []
    for one, of in zip(k.ravel().tolist(), n.ravel().tolist(), strict=True):
        if of == 0:
            rows.append((math.nan,) * 3)
            continue
        bounds = binomtest(int(one), int(of)).proportion_ci(confidence, method)
        rows.append((one / of, float(bounds.low), float(bounds.high)))
    columns = np.array(rows, dtype=np.float64).reshape(-1, 3).T
    return columns[0].reshape(k.shape), columns[1].reshape(k.shape), columns[2].reshape(k.shape)


def fit_lognormal(im: ArrayLike, exceeded: ArrayLike, groups: ArrayLike | None = None) -> LognormalFragility:
    """The lognormal fragility of largest likelihood.

    Args:
        im: intensity of each case, positive, shape (case,).
        exceeded: whether the case exceeded the limit, shape (case,).
        groups: labels of cases that belong together, shape (case,): the record, where one is used at several scales.
            The covariance then allows for that (fewer independent outcomes than cases); the estimate is the same.

    Raises:
        ValueError: the shapes differ, an intensity is not positive, or the outcomes have no estimate: none or all
            exceed, a single intensity parts them, or weaker cases exceed more often than stronger ones.
    """
    x, outcomes = array_of("im", im), array_of("exceeded", exceeded)
    if x.ndim != 1 or x.shape != outcomes.shape or x.size == 0:
        raise ValueError(f"im, exceeded: shapes {x.shape} and {outcomes.shape}, want one shape (case,), one or more")
    if not (np.all(np.isfinite(x)) and np.all(x > 0.0)):
        raise ValueError("im: want positive finite numbers")
    if not np.all((outcomes == 0.0) | (outcomes == 1.0)):
        raise ValueError("exceeded: want False or True for each case")
    y = outcomes.astype(bool)
    _check_overlap(x, y)
    labels = np.arange(x.size) if groups is None else np.unique(np.asarray(groups), return_inverse=True)[1]
    if labels.shape != x.shape:
        raise ValueError(f"groups: shape {labels.shape}, want {x.shape}")
    # Centred and scaled, so that the two coefficients are of one size whatever the units of the intensity.
    centre, spread = float(np.mean(np.log(x))), float(np.std(np.log(x)))
    z = (np.log(x) - centre) / spread
    coefficients, log_likelihood = _probit(z, y)
    a, b = coefficients
    if b <= 0.0:
        raise ValueError("exceeded: weaker cases exceed more often than stronger ones; no fragility rises with this im")
    inverse = np.linalg.inv(_information(z, y, coefficients))
    if groups is not None:
        inverse = inverse @ _grouped(_scores(z, y, coefficients), labels) @ inverse
    # ln median = centre - spread a/b, ln beta = ln spread - ln b.
    slopes = np.array([[-spread / b, spread * a / b**2], [0.0, -1.0 / b]])
    return LognormalFragility(
        math.exp(centre - spread * a / b), float(spread / b), slopes @ inverse @ slopes.T, log_likelihood
    )


def _check_overlap(x: Array, y: NDArray[np.bool_]) -> None:
    """Raise ValueError unless cases that exceed and cases that do not overlap in intensity."""
    if not y.any():
        raise ValueError(f"exceeded: no case does, up to im={x.max():.6g}; the median is not below that, nothing more")
    if y.all():
        raise ValueError(
            f"exceeded: every case does, from im={x.min():.6g} on; the median is not above that, nothing more"
        )
    stays, goes = x[~y], x[y]
    if stays.max() <= goes.min():
        raise ValueError(
            f"exceeded: no case does up to im={stays.max():.6g}, every one from {goes.min():.6g} on; the median is "
            "between the two, and beta has no estimate but zero"
        )
    if goes.max() <= stays.min():
        raise ValueError(
            f"exceeded: every case does up to im={goes.max():.6g}, none from {stays.min():.6g} on; no fragility rises "
            "with this im"
        )


def _signs(z: Array, y: NDArray[np.bool_], coefficients: Array) -> tuple[Array, Array, Array]:
    """(sign of the outcome, argument of Phi with that sign, phi/Phi there)."""
    from scipy.special import log_ndtr

    sign = np.where(y, 1.0, -1.0)
    u = sign * (coefficients[0] + coefficients[1] * z)
    return sign, u, np.exp(-0.5 * u * u - 0.5 * math.log(2.0 * math.pi) - log_ndtr(u))


def _likelihood(z: Array, y: NDArray[np.bool_], coefficients: Array) -> float:
    from scipy.special import log_ndtr

    return float(np.sum(log_ndtr(_signs(z, y, coefficients)[1])))


def _scores(z: Array, y: NDArray[np.bool_], coefficients: Array) -> Array:
    """Derivative of the log-likelihood of each case by the two coefficients, shape (case, 2)."""
    sign, _, mills = _signs(z, y, coefficients)
    return np.stack([sign * mills, sign * mills * z], axis=1)


def _information(z: Array, y: NDArray[np.bool_], coefficients: Array) -> Array:
    """Minus the second derivative of the log-likelihood, shape (2, 2)."""
    _, u, mills = _signs(z, y, coefficients)
    weight = mills * (u + mills)
    terms = np.stack([np.ones_like(z), z])
    return np.asarray((terms * weight) @ terms.T)


def _probit(z: Array, y: NDArray[np.bool_]) -> tuple[Array, float]:
    """(a, b) of largest likelihood for P = Phi(a + b z), and that; the logarithm is concave, so Newton finds it."""
    from scipy.special import ndtri

    now = np.array([float(ndtri(np.mean(y))), 0.0])
    best = _likelihood(z, y, now)
    for _ in range(MAX_ITERATIONS):
        step = np.linalg.solve(_information(z, y, now), _scores(z, y, now).sum(axis=0))
        while (higher := _likelihood(z, y, now + step)) < best and np.abs(step).max() > 1e-12:
            step = 0.5 * step
        now, best = now + step, max(best, higher)
        if np.abs(step).max() < 1e-10 * (1.0 + np.abs(now).max()):
            return now, best
    raise ValueError(f"exceeded: the fit does not settle in {MAX_ITERATIONS} steps: the outcomes barely overlap in im")


def _grouped(scores: Array, labels: NDArray[Any]) -> Array:
    """Sum over the groups of the squares of their summed scores, shape (2, 2), with the usual n/(n - 1)."""
    count = int(labels.max()) + 1
    if count < 3:
        raise ValueError(f"groups: {count} of them, want three or more")
    sums = np.zeros((count, 2))
    np.add.at(sums, labels, scores)
    return np.asarray(count / (count - 1) * sums.T @ sums)
