"""What the base sensor's noise leaves in single swings, once the state at the start of each has been fitted.

The state follows most of what the base does within a swing. Behind a quiet sensor of the response the rest is more than
the noise of that sensor, and no effect; a swing near the balance owns it all. So a swing is weighed by both.

Source   none, own convention: one variance for a swing, for what is a few slow curves in it
Status   true models leave of clean swings what is told here (tests)
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from studies.loop.fits.linearising import free_states, linearised, read_of
from studies.loop.models.model import LoopModel
from studies.loop.observed.windows import Window
from studies.loop.runs.simulation import Simulator

DRAWS = 8
"""The mean over these and hundreds of swings is good to a few per cent."""


def with_left_by_base(
    simulator: Simulator, noisy: Simulator, count: int, model: LoopModel, windows: Sequence[Window]
) -> list[Window]:
    """The windows, weighed by what redrawn noise of the base leaves in each on average besides its own noise.

    Args:
        simulator: of the tests as recorded.
        noisy: of `studies.loop.observed.spread.redrawn`.
        count: number of tests of the campaign.
        model: under which the responses are computed.
        windows: of single swings.
    """
    recorded = read_of(simulator, model, windows)
    states = zip(linearised(simulator, model, [], windows, read=recorded).by_state, windows, strict=True)
    followed = [np.linalg.qr(by_state[:, free_states(w)])[0] for by_state, w in states]
    squares = np.zeros(len(windows))
    for k in range(DRAWS):
        moved = read_of(noisy, model, [replace(w, test=k * count + w.test) for w in windows])
        for i, (w, read, own, Q) in enumerate(zip(windows, moved, recorded, followed, strict=True)):
            # Accelerometers of a block on the other side are not compared, and shift nothing.
            shift = np.nan_to_num((read - own) * w.weights, nan=0.0)
            squares[i] += float(shift @ shift - (Q.T @ shift) @ (Q.T @ shift))
    return [_weighed(w, s / DRAWS) for w, s in zip(windows, squares.tolist(), strict=True)]


def _weighed(window: Window, squares: float) -> Window:
    """A window in which the base leaves so much over the noise [1]; as it is where that cannot be told."""
    if not (math.isfinite(squares) and window.data.size):
        return window
    more = 1.0 + squares / window.data.size
    sd = window.noise if window.sd is None else window.sd
    return replace(window, sd=math.sqrt(more) * sd, by_base=squares / more)
