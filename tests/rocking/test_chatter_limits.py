"""Where a batch may count the impacts of a chatter instead of following them, and where it must not."""

from typing import Any

import numpy as np
import pytest

from excitation import RampedSinusoid
from rocking import Block, Method1, Outcome, solve, solve_batch
from rocking.batch import OUTCOMES


# A rest speed so low that a hundred flights and more are shorter than the 1e-12 s that count as going on: the run that
# is followed ends as stalled, and so must the one whose impacts could be counted.  With e = 0.5 there are fewer.
@pytest.mark.parametrize("form", ["nonlinear", "linear"])
@pytest.mark.parametrize(("e", "outcome"), [(0.5, Outcome.AT_REST), (0.9, Outcome.FAILED)])
def test_a_chatter_that_stalls_when_followed_is_not_counted_to_a_rest(form: Any, e: float, outcome: Outcome) -> None:
    system = Method1(Block(0.2, 0.8), form=form, restitution=e, rest_speed=1e-30)
    motion = RampedSinusoid(2.0, 1.0, 1e-9)
    run = solve(system, motion, theta=0.1, t_end=60.0, solver="taylor", save_at=())
    assert run.outcome is outcome
    assert ("without time going on" in run.reason) == (outcome is Outcome.FAILED)
    batch = solve_batch([system] * 2, [motion] * 2, theta=0.1, t_end=60.0, solver="taylor")
    assert [OUTCOMES[i] for i in batch.outcome] == [outcome.value] * 2
    np.testing.assert_array_equal(batch.impacts, run.impact_times.size)


@pytest.mark.parametrize("solver", ["numba", "scipy"])
def test_solvers_that_step_end_it_where_taylor_does(solver: str) -> None:
    """By the same impact, and not by the largest number of events that is allowed."""
    system = Method1(Block(0.2, 0.8), restitution=0.9, rest_speed=1e-30)
    motion = RampedSinusoid(2.0, 1.0, 1e-9)
    one, other = (
        solve(system, motion, theta=0.1, t_end=60.0, solver=name, save_at=(), max_events=2000)
        for name in ("taylor", solver)
    )
    assert one.outcome is other.outcome is Outcome.FAILED
    assert "more than 100 events without time going on" in other.reason
    assert other.impact_times.size == one.impact_times.size
    assert other.impact_times[-1] == pytest.approx(one.impact_times[-1], abs=1e-7)


def test_with_the_usual_rest_speed_it_comes_to_rest() -> None:
    system = Method1(Block(0.2, 0.8), restitution=0.5)
    batch = solve_batch(system, [RampedSinusoid(2.0, 1.0, 1e-9)], theta=0.1, t_end=60.0, solver="taylor")
    assert [OUTCOMES[i] for i in batch.outcome] == ["at rest"]
