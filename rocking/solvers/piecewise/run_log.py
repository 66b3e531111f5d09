"""Where a compiled run is written down: samples that were asked for, and events."""

from __future__ import annotations

from typing import Any, NamedTuple

import numba
import numpy as np


class Log(NamedTuple):
    """Samples and events of one run; a batch has none."""

    save_at: Any
    y: Any
    mode: Any
    s: Any
    event_t: Any
    event_code: Any
    event_s: Any
    event_y: Any


@numba.njit(error_model="numpy")
def new_log(save_at, room):
    """An empty log with room for so many events."""
    n = save_at.size
    return Log(
        save_at, np.empty((n, 2)), np.empty(n, np.int64), np.empty(n),
        np.empty(room), np.empty((room, 3), np.int64), np.empty(room), np.empty((room, 2, 2)),
    )  # fmt: skip
