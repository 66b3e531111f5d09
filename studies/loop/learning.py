"""What no candidate explains: the residual learned as a term, one coefficient after the other.

Each coefficient of `rocking.effects.learned_term`, and a drift of restitution from test to test, is a parameter whose
default is nothing, fitted with the same machinery as the effects.  The greedy search stops when the next one does not
lower the residual by `LEAST_GAIN`.

Status   memory and further freedoms are outside of the span: then little is learned, and the term goes.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from studies.campaigns import DeclaredBlock
from studies.loop.candidates import Candidate
from studies.loop.fitting import Parameter
from studies.loop.model import DRIFT
from studies.loop.simulation import Simulator
from studies.loop.tracing import Trial, pays, search

LEAST_GAIN = 0.03
"""Share by which the rms of the swings has to fall for one more coefficient."""

MOST_TERMS = 4

HOPELESS = 2
"""Coefficients after which half of what is to be reached has to be."""

LEARNED = "learned_term"


def terms(block: DeclaredBlock) -> tuple[Candidate, ...]:
    """Every coefficient as a candidate, with sizes that a usual campaign would show."""
    p2, alpha = block.p() ** 2, block.alpha
    omega = 0.5 * block.p() * alpha
    torque = 0.02 * p2 * alpha
    sizes = {
        "bias": torque,
        "side": torque,
        "spring": torque / alpha,
        "cubic": torque / alpha**3,
        "friction": torque,
        "damping": torque / omega,
        "side_damping": torque / omega,
        "drag": torque / omega**2,
        "cubic_damping": torque / omega**3,
        "base": 0.01 * p2 / 9.81,
        "restitution_side": 0.01,
        "restitution_speed": 0.01 / omega,
        "restitution_square": 0.01 / omega**2,
        "structural": torque / alpha,
    }
    found = [_term(f"{LEARNED}.{name}", size) for name, size in sizes.items()]
    return (*found, _term(DRIFT, 0.002))


def _term(full: str, size: float) -> Candidate:
    parameter = Parameter(full, size, -50.0 * size, 50.0 * size)
    name = full if full == DRIFT else f"learned[{full.partition('.')[2]}]"
    return Candidate(name, LEARNED, (parameter,), ({full: size}, {full: -size}), {})


def learn(simulator: Simulator, onto: Trial, tell: Callable[[str], None], rival: Trial | None = None) -> Trial:
    """The trial with the coefficients that pay; itself if none does.

    rival: what has to be reached; the search ends early where it plainly is not.
    """
    current = onto
    pool = terms(onto.swing.model.declared)
    for count in range(MOST_TERMS):
        gained = onto.swing.chi2 - current.swing.chi2
        if rival is not None and count >= HOPELESS and gained < 0.5 * (onto.swing.chi2 - rival.swing.chi2):
            break
        open_to_it = [c for c in pool if c.name not in current.names]
        tried = search(simulator, current, open_to_it, tell, repeated=True)
        best = tried.best
        if best is None or not pays(current.swing, best.swing):
            break
        if best.swing.rms > (1.0 - LEAST_GAIN) * current.swing.rms or not np.isfinite(best.swing.rms):
            break
        current = best
    return current
