"""What a run of the Taylor solver writes down at its very end: samples that rounding leaves behind the last step."""

from types import SimpleNamespace

import numpy as np

from rocking.hybrid import REST, ROTATION
from rocking.solvers.recording import REACHED_END
from rocking.solvers.taylor import table as row
from rocking.solvers.taylor.log import write_end


def test_samples_left_at_the_end_are_those_of_the_last_state_of_this_run() -> None:
    """In the first lane; what stands in the others belongs to other runs."""
    t = np.full((row.ALL_ROWS, 4), 7.0)
    t[[row.STATUS, row.MODE, row.SAVED, row.S, row.X, row.V], 0] = REACHED_END, ROTATION, 1, -1.0, 0.2, 0.3
    log = SimpleNamespace(save_at=np.zeros(3), y=np.zeros((3, 2)), mode=np.full(3, REST), s=np.zeros(3))
    write_end.py_func(t, log)
    assert log.y.tolist() == [[0.0, 0.0], [-0.2, -0.3], [-0.2, -0.3]]
    assert log.mode.tolist() == [REST, ROTATION, ROTATION] and log.s.tolist() == [0.0, -1.0, -1.0]
    assert t[row.SAVED, 0] == 3


def test_a_run_that_stopped_early_has_no_samples_behind_its_stop() -> None:
    t = np.full((row.ALL_ROWS, 4), 7.0)
    t[[row.STATUS, row.SAVED], 0] = REACHED_END + 1, 1
    log = SimpleNamespace(save_at=np.zeros(3), y=np.zeros((3, 2)), mode=np.full(3, REST), s=np.zeros(3))
    write_end.py_func(t, log)
    assert not log.y.any() and t[row.SAVED, 0] == 1
