"""Stubs of trials, of fits on whole records and of rivals, for decisions of the loop without any fit."""

import math
from types import SimpleNamespace

import numpy as np

from studies.loop.whole.rivals import Rival


def whole(*rms):
    """A fit on whole records of 50 samples each, missed by so many deviations."""
    windows = tuple(SimpleNamespace(theta_sd=0.0) for _ in rms)
    residuals = tuple(np.full(50, value) for value in rms)
    values = np.array(rms)
    return SimpleNamespace(
        model=None,
        by_window=values,
        residuals=residuals,
        windows=windows,
        samples=50 * len(rms),
        rms=math.sqrt(np.mean(values**2)),
    )


def trial(name, chi2, over, *, costly=False, slips=False):
    """A trial whose swings leave `over` times the noise."""
    part = SimpleNamespace(costly=costly, slips=slips, in_swings=True, effect=name, parameters=())
    swing = SimpleNamespace(chi2=chi2, over=over, by_window=np.full(3, over), parameters=(), samples=1000)
    parts = (part,) if name else ()
    return SimpleNamespace(names=(name,) if name else (), effects=(name,), parts=parts, swing=swing, costly=costly)


PLAIN = trial("", 1000.0, 0.99)
FLOOR = trial("floor", 900.0, 0.97, costly=True)
TILT = trial("tilt", 980.0, 0.99)


def rival(made, criterion, found):
    return Rival(made, found, criterion, math.nan, math.nan)
