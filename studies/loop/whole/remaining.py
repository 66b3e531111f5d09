"""What a trial leaves over: in the swings, and in whole records.

Status   where noise is declared; an estimated one is taken from the records themselves, and leaves room for less.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rocking.effects.learned_reading import LearnedReading
from studies.loop.fits.fitting import Fit
from studies.loop.fits.linearising import ROBUST
from studies.loop.observed.spread import furthest_moved
from studies.loop.observed.windows import PEAK_OVER_NOISE, SIDE, Window
from studies.loop.records.preparing import Setup
from studies.loop.swings.learning import MEMORY, WITHIN
from studies.loop.swings.trials import Trial

MISSED_BY_FAR = 3.0
"""Rms of whole records, of all or of one, over their noise that cannot be called explained."""

MISSED_RECORDS = 2
"""So many of them have to be missed so: one may be lost to an impact that hung on the noise of the base."""

CLOSELY = 1.1
"""Rms of whole records over their noise below which laws of loss with a name, and two effects, are not doubted, nor is
one coefficient without a name."""

STRUCTURE = 1.03
"""Rms in the swings over what the noise leaves of it from which structure is left: four of its standard deviations in
ten thousand samples."""

STRUCTURE_OF_ESTIMATED = 1.08
"""The same where the noise is not declared but estimated from the records."""

CHANCE = 2.0
"""Standard deviations of the sum of squares of noise alone, within which nothing is left."""

UNEXPLAINED = 1.05
"""And from which it is too much to speak of an effect alone even where nothing can be learned."""

UNEXPLAINED_OF_ESTIMATED = 1.3
"""The same where the noise is estimated."""


def over_noise(setup: Setup, trial: Trial) -> float:
    """Rms of the swings over what is left of pure noise once each window has fitted its two states.

    Swings that the trial itself takes for less than one are left out, as they would have been from the beginning: with
    the zero of a sensor off, a hop at rest looks like a swing, and hangs on the noise of the base.  Where a block
    slips, some windows begin with a slip that could not be carried over to them as it was: of those trials it is the
    median over the windows, so that structure has to be in half of them to be seen.
    """
    swing = trial.swing
    if slips(trial):
        return math.sqrt(float(np.median([r @ r / max(r.size - 2, 1) for r in swing.residuals])))
    left = [swing.residuals[i] for i in swings_that_count(setup, trial)]
    samples = sum(r.size for r in left)
    free = 2 * len(left) + len(swing.parameters)
    return math.sqrt(sum(float(r @ r) for r in left) / max(samples - free, 0.1 * samples, 1.0))


def by_chance(setup: Setup, trial: Trial) -> bool:
    """Whether the swings are explained down to what noise alone leaves of them: within `CHANCE` standard deviations.

    Where noise is estimated, or a block slips, what is left says less than that (`over_noise`).
    """
    if slips(trial) or not declared_noise(setup):
        return False
    swing, counting = trial.swing, swings_that_count(setup, trial)
    free = 2 * len(counting) + len(swing.parameters)
    samples = sum(swing.residuals[i].size for i in counting)
    variance = 2.0 * (samples - free) + _more_scatter([swing.windows[i] for i in counting])
    return over_noise(setup, trial) ** 2 < 1.0 + CHANCE * math.sqrt(variance) / max(samples - free, 1)


def _more_scatter(windows: Sequence[Window]) -> float:
    """By how much the variance of the sum of squares is more than that of as many samples of white noise.

    What the noise of the base leaves in a swing is one slow curve, near enough: one degree of freedom.
    """
    more = 0.0
    for w in windows:
        own = 1.0 - w.by_base / max(w.data.size, 1)  # share of the sensor's own noise in the variance
        more += 2.0 * (w.by_base**2 + 2.0 * w.by_base * own - w.data.size * (1.0 - own**2))
    return max(more, 0.0)


def _by_the_base(setup: Setup) -> float:
    """What four standard deviations are more for the noise of the base, in the mean square of the swings."""
    samples = sum(w.data.size for w in setup.swings)
    return 4.0 * math.sqrt(_more_scatter(setup.swings)) / max(samples, 1)


def swings_that_count(setup: Setup, trial: Trial) -> list[int]:
    """Indices of the windows that the trial itself does not take for less than a swing."""
    least = {record.test: PEAK_OVER_NOISE * record.noise for record in setup.records}
    return [i for i, w in enumerate(trial.swing.windows) if abs(w.theta) > least[w.test]]


def explains(setup: Setup, trial: Trial, whole: Fit) -> bool:
    """Whether a trial leaves nothing in the swings, nor in whole records of the rotation."""
    return not (setup.by_rotation and missed(setup, whole)) and over_noise(setup, trial) < structure(setup)


PLAY = f"{LearnedReading.name}.play"
"""Of the linkage of a rotation sensor."""

REMEMBERED = frozenset(f"{MEMORY}.{name}" for name in ("first", "recent"))
"""Of a restitution with a memory what depends on which impacts count, but for wear: use is counted from records."""

LEAST_SPEED = f"{MEMORY}.least_speed"
"""Of the impacts that count: 0 where all of them do, also those that no record shows."""


def roughly_begun(setup: Setup, trial: Trial, whole: Fit) -> bool:
    """Whether what swings leave is that of how they begin.

    How the floor gave before a swing began no rotation shows, and it is carried over but roughly, as is how a mass
    within was moving; where in its gap a linkage was is told from the first samples, on a still base; how many impacts
    went before is counted from those that a record shows, where all of them are remembered. Whole records hold the same
    samples and begin from a lean or from rest, of which nothing is unknown: where these are met closely, what is left
    of swings says nothing.
    """
    return begins_roughly(trial) and setup.by_rotation and whole.rms < CLOSELY


def begins_roughly(trial: Trial) -> bool:
    """Whether it is told but roughly how a swing begins."""
    within = any(effect in WITHIN for effect in trial.effects)
    every = remembers(trial) and trial.swing.model.get(LEAST_SPEED) == 0.0
    return trial.costly or within or every or any(p.name == PLAY for part in trial.parts for p in part.parameters)


def remembers(trial: Trial) -> bool:
    """Whether its restitution hangs on which of the impacts before count."""
    return any(p.name in REMEMBERED for p in trial.parameters)


def missed(setup: Setup, whole: Fit) -> bool:
    """Whether whole records cannot be called explained: some are missed by far, and by more than base noise does.

    How well all the others are met is no matter: of twelve clean campaigns no single record was missed by 1.3.
    """
    far, least = whole.by_window > MISSED_BY_FAR, min(MISSED_RECORDS, len(whole.by_window))
    if np.count_nonzero(far) < least:
        return False
    return int(np.count_nonzero(whole.by_window[far] > _moved(setup, whole, far))) >= least


def met(setup: Setup, whole: Fit, within: float) -> bool:
    """Whether whole records are met: all together within that rms over their noise, or each of them.

    Of a record that hangs finely on the base the noise has longer tails than its variance says: one is met as well that
    is missed by no more than what redrawn noise of the base does, now and then, to a block that is the model.
    """
    if whole.rms < within:
        return True
    far = whole.by_window >= within
    return bool(np.all(whole.by_window[far] <= _moved(setup, whole, far)))


def _moved(setup: Setup, whole: Fit, records: NDArray[np.bool_]) -> NDArray[np.float64]:
    """How far redrawn noise of the base moves these records now and then, over their noise [1]; shape (record,)."""
    windows = [w for w, asked in zip(whole.windows, records, strict=True) if asked]
    return furthest_moved(setup.simulator, setup.noisy, len(setup.campaign.tests), whole.model, windows)


def rms_but_for_one(whole: Fit) -> float:
    """Rms of whole records over their noise, but for a single one that is lost: it may hang on the base's noise."""
    if not one_is_lost(whole):
        return whole.rms
    return math.sqrt(float(np.mean(whole.by_window[whole.by_window <= ROBUST] ** 2)))


def one_is_lost(whole: Fit) -> bool:
    """Whether a single record of several is lost."""
    lost = whole.by_window > ROBUST
    return np.count_nonzero(lost) == 1 and lost.size >= MISSED_RECORDS + 1


def slips(trial: Trial) -> bool:
    return any(part.slips for part in trial.parts)


def structure(setup: Setup) -> float:
    """Rms in the swings over their noise from which structure is left."""
    return math.hypot(STRUCTURE if declared_noise(setup) else STRUCTURE_OF_ESTIMATED, math.sqrt(_by_the_base(setup)))


def unexplained(setup: Setup) -> float:
    """And from which it is too much to speak of an effect alone."""
    return math.hypot(
        UNEXPLAINED if declared_noise(setup) else UNEXPLAINED_OF_ESTIMATED, math.sqrt(_by_the_base(setup))
    )


def declared_noise(setup: Setup) -> bool:
    return all(c.noise for record in setup.records for c in record.channels if c is not SIDE)
