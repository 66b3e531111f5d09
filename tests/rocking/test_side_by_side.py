"""Tasks side by side in threads, and code that is compiled once whichever of them asks for it."""

import sys
import threading
import time
from functools import partial

import numpy as np
import pytest

from excitation.binding import bound
from rocking.altered import AlteredMotion
from rocking.solvers.numba.once import once
from rocking.solvers.threads import over_runs, side_by_side


class _StillMotion:
    """A base at rest."""

    parameters = np.zeros(1)
    breakpoints = ()
    max_step = np.inf

    @staticmethod
    def kernel(xp, t, par):
        return 0.0 * t, 0.0 * t


def test_tasks_are_done_at_the_same_time_and_answers_come_in_their_order():
    """Each of two tasks waits until the other one has begun."""
    begun = [threading.Event(), threading.Event()]

    def task(k):
        begun[k].set()
        assert begun[1 - k].wait(10.0)
        return k

    assert side_by_side([partial(task, 0), partial(task, 1)], 2, 2) == [0, 1]


@pytest.mark.parametrize(("workers", "threads"), [(1, 4), (4, 1)])
def test_with_one_thread_tasks_are_done_on_this_one(workers, threads):
    here = threading.get_ident()
    assert side_by_side([threading.get_ident] * 3, workers, threads) == [here] * 3


def test_tasks_within_a_task_stay_on_its_thread():
    def outer():
        return threading.get_ident(), side_by_side([threading.get_ident] * 3, 2, 2)

    for own, inner in side_by_side([outer, outer], 2, 2):
        assert inner == [own] * 3


@pytest.mark.parametrize(("threads", "share"), [(2, 1), (8, 4)])
def test_loops_over_runs_share_the_cores(threads, share):
    """A loop that would take eight threads by itself."""

    def task():
        used, together = set(), threading.Barrier(share)

        def work(counter, end):
            together.wait(10.0)
            used.add(threading.get_ident())

        over_runs(work, 64 if share > 1 else 1, 8)
        return len(used)

    assert side_by_side([task, task], 2, threads) == [share, share]


def test_the_first_failure_is_raised_and_ends_the_others():
    """Runs of a millisecond each, far more than there is time for."""
    done, failing = [], threading.Event()

    def fails():
        failing.wait(10.0)
        raise ValueError("no such block")

    def goes_on():
        def work(counter, end):
            done.append(end)
            failing.set()
            time.sleep(0.001)

        for _ in range(20_000):
            over_runs(work, 1, 1)

    with pytest.raises(ValueError, match="no such block"):
        side_by_side([fails, goes_on, goes_on], 2, 2)
    assert len(done) < 10_000


def test_threads_take_turns_as_before_afterwards():
    before = sys.getswitchinterval()
    inside = side_by_side([sys.getswitchinterval] * 2, 2, 2)
    assert max(inside) < 0.1 * before
    with pytest.raises(ZeroDivisionError):
        side_by_side([lambda: 1 // 0] * 2, 2, 2)
    assert sys.getswitchinterval() == before


def test_what_is_compiled_once_is_the_same_for_all_threads():
    calls = []

    @once
    def made(name):
        time.sleep(0.05)  # long enough for the others to ask
        calls.append(name)
        return object()

    assert len(set(side_by_side([partial(made, "flow")] * 8, 8, 8))) == 1
    assert calls == ["flow"]
    assert made("guards") is not made("flow")


def _template(xp, t, par):
    return _inner(xp, t, par)


_inner = None


@pytest.mark.parametrize(
    "make",
    [
        pytest.param(lambda split: bound(_template, _inner=_template, _split=split), id="bound"),
        pytest.param(lambda split: _altered(split).kernel, id="altered motion"),
    ],
)
def test_kernels_made_of_others_are_the_same_for_all_threads(make):
    """Runs of one kernel go into one call, and compiled code is kept by it: so many kernels as there are splits."""
    splits = range(2000)
    of_each = side_by_side([lambda: [make(split) for split in splits]] * 4, 4, 4)
    for kernels in zip(*of_each, strict=True):
        assert len({id(kernel) for kernel in kernels}) == 1


def _altered(split):
    below = _StillMotion()
    below.parameters = np.zeros(split)
    return AlteredMotion(below, [0.0])
