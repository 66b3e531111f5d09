"""Fits at once give what fits in turn give."""

import threading
from dataclasses import replace
from functools import partial

import numba
import pytest
import released

from studies.loop.models.candidates import candidates
from studies.loop.runs import at_once as module
from studies.loop.runs.at_once import at_once
from studies.loop.runs.simulation import Simulator
from studies.loop.swings.tracing import search

needs_two = pytest.mark.skipif(numba.get_num_threads() < 2, reason="needs two cores")


@needs_two
def test_two_tasks_are_done_at_once(monkeypatch):
    monkeypatch.setattr(module, "AT_ONCE", 2)
    begun = [threading.Event(), threading.Event()]

    def task(k):
        begun[k].set()
        return begun[1 - k].wait(10.0)

    assert at_once([partial(task, 0), partial(task, 1)]) == [True, True]


@needs_two
def test_a_round_at_once_is_that_in_turn_to_the_last_digit(monkeypatch):
    """Effects that bear on motion, impact, form, sensor and friction, on swings of a block with a drag."""
    simulator, plain = released.decays(replace(released.IDEAL, quadratic=0.3))
    names = ("viscous_damping", "quadratic_drag", "rounded_edges", "rotation_gain", "tether", "sliding")
    pool = [c for c in candidates(released.DECLARED) if c.effect in names and c.in_swings]
    found = []
    for count in (1, 2):
        monkeypatch.setattr(module, "AT_ONCE", count)
        again = Simulator(simulator.tests)  # which has no base of an effect yet
        tried = search(again, plain, pool)
        found.append({t.names: (t.swing.values, t.swing.chi2, t.swing.converged) for t in tried.trials} | tried.skipped)
    assert found[0] == found[1] and len(found[0]) == len(pool) > 8
