"""Windows that a fit misses by far, begun again from what the record shows.

A model that lacks an effect bends the states of its windows to what it can do; with the effect there these are no place
to begin from, and some stay in a minimum of their own.

Source   none, own convention
Status   a swing that was lost alone had hidden an effect that leaves nothing once it is found (docs/loop_trials.md)
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from studies.loop.fits.fitting import Fit, fit
from studies.loop.fits.linearising import HUBER, objectives, residuals
from studies.loop.models.model import LoopModel
from studies.loop.observed.windows import Window
from studies.loop.runs.simulation import Simulator

ABOUT = np.linspace(-0.08, 0.08, 17)
"""Speeds over p times the slenderness angle from which a missed swing is tried again, about that of its peak."""

FEW_LOST = 0.1
"""Share of the windows up to which those that are missed are tried from such speeds: beyond, the model is wrong."""


def afresh(simulator: Simulator, model: LoopModel, windows: Sequence[Window]) -> tuple[list[Window], float]:
    """The windows, each from the state that the record shows where the model fits better from there, and chi-square.

    A model that lacks an effect bends the states to what it can do; they are then no place to try the effect from.
    """
    seen = [as_seen(model, w) for w in windows]
    fitted, plain = (objectives(model, residuals(simulator, model, each), each, HUBER) for each in (windows, seen))
    states = [s if b < a else w for w, s, a, b in zip(windows, seen, fitted, plain, strict=True)]
    return states, float(np.minimum(fitted, plain).sum())


def as_seen(model: LoopModel, window: Window) -> Window:
    """The window from the state that the record shows, as the model takes its sensor; as it is where there is none."""
    if window.seen is None:
        return window
    model = model.in_test(window.test)
    theta = model.peak(window.seen.theta)
    if not math.isfinite(theta):
        return window
    return window.moved(theta, window.seen.omega / float(model.reading_slope(theta)))


def with_lost_found(simulator: Simulator, found: Fit) -> Fit:
    """The fit with windows that are missed by far begun again from the states that the record shows.

    Without the effect their states were bent to what the block could do, and some stay in a minimum of their own.  A
    peak of few samples may seem to move so fast that a fit from there ends on the other side of an impact: what is told
    of a peak for certain is that the block stands still there.  A block that all but stops upright in the middle of a
    swing goes on or back by a little speed more or less, which a flat peak does not tell: where few windows are missed
    these begin from the best of several, too.
    """
    lost = np.flatnonzero(found.by_window > HUBER)
    if not lost.size:
        return found
    there = [found.windows[i] for i in lost]
    windows, best = there, objectives(found.model, [found.residuals[i] for i in lost], there, HUBER)
    seen = [as_seen(found.model, w) for w in there]
    begun = [seen, [w.moved(w.theta, 0.0) for w in seen]]
    if lost.size <= max(1.0, FEW_LOST * len(found.windows)):
        begun.append(_from_the_best_speed(simulator, found.model, seen))
    for starts in begun:
        again = fit(simulator, found.model, [], starts, iterations=8)
        now = objectives(again.model, again.residuals, again.windows, HUBER)
        windows = [new if a < b else old for old, new, a, b in zip(windows, again.windows, now, best, strict=True)]
        best = np.minimum(best, now)
    if windows == there:
        return found
    every = list(found.windows)
    for i, window in zip(lost, windows, strict=True):
        every[i] = window
    whole = fit(simulator, found.model, found.parameters, every, iterations=6)
    return whole if whole.chi2 < found.chi2 else found


def _from_the_best_speed(simulator: Simulator, model: LoopModel, windows: Sequence[Window]) -> list[Window]:
    """The windows, each from that of the speeds about its own (`ABOUT`) from which the model fits best."""
    p_alpha = model.declared.p() * model.declared.alpha
    moved = [[w.moved(w.theta, w.omega + float(share) * p_alpha) for w in windows] for share in ABOUT]
    left = np.array([objectives(model, residuals(simulator, model, each), each, HUBER) for each in moved])
    return [moved[k][i] for i, k in enumerate(np.argmin(left, axis=0))]
