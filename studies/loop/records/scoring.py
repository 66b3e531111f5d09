"""Errors of a model on whole tests, as a campaign's own channel has them.

The error of a test is the rms of predicted less measured rotation over its samples; without a rotation channel, of the
accelerometers on the block.  Missing samples and those after a fall are left out.  Models run on the base record as it
is, as in a prediction: a true model is moved by the noise in it likewise, and so is what it is held against.

Status   held-out tests start from the lean that their own first samples show.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from studies.loop.fits.fitting import fit
from studies.loop.models.model import LoopModel
from studies.loop.observed.observing import jobs_of, observe
from studies.loop.observed.windows import Window, scored_window
from studies.loop.records.preparing import Setup


@dataclass(frozen=True)
class Errors:
    """Median over tests of the rms error [rad, or m/s^2], for the tests fitted and those held out."""

    fit: float
    holdout: float
    by_test: dict[str, float] = field(default_factory=dict)


def errors(setup: Setup, model: LoopModel, fitted: Sequence[Window]) -> Errors:
    """Errors of a model on whole tests; `fitted` are the windows of the fit tests with their fitted leans."""
    windows = [scored_window(setup.records, w) for w in (*fitted, *leaning(setup, model, setup.whole_held))]
    read = observe(setup.recorded, [model], jobs_of(windows, 0), windows)
    each = [math.sqrt(float(np.mean((x - w.data) ** 2))) for x, w in zip(read, windows, strict=True)]
    names = [setup.campaign.tests[w.test].id for w in windows]
    n = len(fitted)
    return Errors(median(each[:n]), median(each[n:]), dict(zip(names, each, strict=True)))


def median(values: Sequence[float]) -> float:
    """Their median, NaN if there is none."""
    return float(np.median(values)) if values else math.nan


def leaning(setup: Setup, model: LoopModel, windows: Sequence[Window]) -> list[Window]:
    """Whole windows with leans at release as the model sees them, by what was recorded before the first impact.

    A rotation sensor says the lean itself, as the model takes that sensor; accelerometers say it through the model.
    """
    if setup.by_rotation:
        return [_as_read(model, w) if w.theta_sd > 0.0 else w for w in windows]
    out = list(windows)
    free = [k for k, w in enumerate(windows) if w.theta_sd > 0.0]
    parts = [replace(windows[k].until(_first_impact(setup, windows[k])), sd=None) for k in free]
    long_enough = [i for i, part in enumerate(parts) if part.times.size >= 8]
    found = fit(setup.simulator, model, [], [parts[i] for i in long_enough], iterations=5).windows
    for i, part in zip(long_enough, found, strict=True):
        out[free[i]] = windows[free[i]].moved(part.theta, part.omega)
    return out


def _as_read(model: LoopModel, window: Window) -> Window:
    """The window from the rotation that its reading at the start stands for; as it is where it stands for none."""
    theta = model.in_test(window.test).peak(window.theta_prior) if window.lean_read else window.theta_prior
    return window.moved(theta, window.omega) if math.isfinite(theta) else window


def _first_impact(setup: Setup, window: Window) -> float:
    record = next(r for r in setup.records if r.test == window.test)
    return record.found.impacts[0].time if record.found.impacts else float(record.time[-1])
