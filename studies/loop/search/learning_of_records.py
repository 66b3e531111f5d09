"""What no swing shows and no effect explains: one form without a name, learned of whole records.

In a single swing a mass that moves inside, or a little more loss in each impact, may be less than the sensor's noise;
in a whole record what it does adds up.  Forms of few coefficients are fitted to whole records, as far as these are
predictable, from all their starts or those that a score ranks first.  The best ones have to answer what effects that
are scanned there have to.

Status   a planted mass inside that leaves nothing in the swings is found (slow test); curves are left out but for
         those near upright, since whole records are few for their many coefficients
"""

from __future__ import annotations

from collections.abc import Sequence

from studies.loop.fits.fitting import Fit, fit, fit_records
from studies.loop.models.candidates import Candidate
from studies.loop.observed.windows import Window
from studies.loop.records.preparing import Setup
from studies.loop.search.rounds import Tell
from studies.loop.swings.learning import MANY, inner, memories, profiles, unnamed
from studies.loop.swings.trials import Trial, bic
from studies.loop.swings.trying import best_by_score
from studies.loop.whole.settling import predictable
from studies.loop.whole.whole_records import confirmed, ranked

STEPS = 8
"""Of a fit from each start."""

SIZED = 4
"""Of one of its size alone, before that, where a score ranked the starts."""

UPRIGHT = "near upright"
"""What names of such curves say."""

MOST = 3
"""Forms that are fitted to the end: those that explain most after these."""


def unseen(setup: Setup, plain: Trial, whole: Fit, tell: Tell) -> Trial | None:
    """The calibrated block with the form without a name that explains whole records best; None if none does.

    whole: its fit on whole records without one.
    """
    windows = predictable(whole.windows)
    if not windows:
        return None
    tell("learning of whole records what no swing shows")
    without = fit_records(setup.simulator, whole.model, plain.every, windows, iterations=STEPS)
    begun = []
    for candidate in forms(setup, plain):
        tell(candidate.name)
        first = _begun(setup, plain, without, windows, candidate)
        if first is not None:
            begun.append((first, candidate))
    begun.sort(key=lambda pair: bic(pair[0]))
    found = [
        rival
        for first, candidate in begun[:MOST]
        if (rival := confirmed(setup, plain, whole, without, first, candidate)) is not None
    ]
    return ranked(setup, found)[0].trial if found else None


def forms(setup: Setup, plain: Trial) -> tuple[Candidate, ...]:
    """Those that are tried: single coefficients, memories of impacts, what swings, yields or creeps inside, and curves
    near upright: what acts there alone acts for a short while of each swing."""
    declared, released = plain.swing.model.declared, any(test.kind == "free" for test in setup.simulator.tests)
    windows = plain.swing.windows
    curves = (c for c in profiles(declared, windows) if UPRIGHT in c.name and len(c.parameters) <= MANY + 1)
    # What takes another form of what went before says little more where no swing shows either, or is quickly asked.
    going_on = (c for c in inner(declared, released) if not c.after or c.scored)
    return (*unnamed(declared), *memories(declared, windows), *going_on, *curves)


def _begun(
    setup: Setup, plain: Trial, without: Fit, windows: Sequence[Window], candidate: Candidate
) -> Fit | None:  # fmt: skip
    """The best of a few steps from all starts of a form, or from those that a score ranks first; None if none leads
    anywhere."""
    parameters = (*plain.calibrated_with(candidate), *plain.parameters, *candidate.parameters)
    absent = candidate.absent(plain.swing.model.declared)
    every = candidate.starts or (absent,)
    starts = best_by_score(setup.simulator, without, candidate) if candidate.scored else every
    best: Fit | None = None
    for start in starts:
        try:
            model, there = without.model.changed({**candidate.fixed, **start}), windows
            if candidate.scored:
                # What no swing shows is small: its size comes first, from nothing.
                scouts = tuple(p for p in candidate.parameters if p.name in candidate.scouts)
                model = model.changed({p.name: absent[p.name] for p in scouts})
                sized = fit(setup.simulator, model, scouts, windows, whole=True, iterations=SIZED, central=True)
                model, there = sized.model, sized.windows
            found = fit(setup.simulator, model, parameters, there, whole=True, iterations=STEPS, central=True)
        except ValueError:
            continue  # numbers that do not go together
        if best is None or found.chi2 < best.chi2:
            best = found
    return best
