"""A curve as a small drawing in HTML, as notebooks show it beside the repr of a trajectory.

Source  none, own convention
Status  the extremes are kept however many samples there are; words are escaped
"""

from __future__ import annotations

import html
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

WIDTH, HEIGHT = 480.0, 90.0  # of the drawing [px]
MOST = 600  # stretches of samples that are told apart


def html_of(t: NDArray[np.float64], values: NDArray[np.float64], words: str) -> str:
    """The curve over the times t, each of shape (time,), with the words below."""
    t, values = _thinned(t, values)
    span = float(t[-1] - t[0]) or 1.0
    largest = float(np.max(np.abs(values), initial=0.0)) or 1.0
    x = (t - t[0]) / span * WIDTH
    y = 0.5 * HEIGHT * (1.0 - 0.95 * values / largest)
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH:.0f}" height="{HEIGHT:.0f}">'
        f'<line x1="0" y1="{HEIGHT / 2:.1f}" x2="{WIDTH:.1f}" y2="{HEIGHT / 2:.1f}" stroke="#b5b5b5"/>'
        f'<polyline points="{points}" fill="none" stroke="#1f5f99"/></svg><div>{html.escape(words)}</div>'
    )


def _thinned(t: NDArray[np.float64], values: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The lowest and the highest sample of each stretch, where there are too many to draw."""
    if t.size <= 2 * MOST:
        return t, values
    edges = np.linspace(0, t.size, MOST + 1).astype(int)
    kept = {0, t.size - 1}
    for a, b in pairwise(edges.tolist()):
        kept |= {int(a + np.argmin(values[a:b])), int(a + np.argmax(values[a:b]))}
    at = np.array(sorted(kept))
    return t[at], values[at]
