"""A scene as a small drawing in HTML, as notebooks show it.

Source  none, own convention
Status  outlines to scale; names are escaped
"""

from __future__ import annotations

import html
from collections.abc import Iterable

import numpy as np

from dem.shapes import FloatArray

Outline = tuple[FloatArray, str]
"""Corners [m], shape (corner, 2), and name of a thing."""

WIDTH, HEIGHT = 480.0, 260.0  # largest size of the drawing [px]
MARGIN = 6.0  # around it [px]


def html_of(bodies: Iterable[Outline], walls: Iterable[Outline], floor: bool, words: str) -> str:
    """A scene as an SVG with words below, floor at z = 0."""
    solid = [(vertices, "#e8d5b0", name) for vertices, name in bodies]
    fixed = [(vertices, "#b5b5b5", name) for vertices, name in walls]
    corners = np.concatenate([vertices for vertices, _, _ in fixed + solid])
    low, high = corners.min(axis=0), corners.max(axis=0)
    scale = float(min(WIDTH / max(high[0] - low[0], 1e-9), HEIGHT / max(high[1] - low[1], 1e-9)))
    width, height = (high - low) * scale + 2.0 * MARGIN
    shapes = "".join(_polygon(vertices, low, high, scale, *rest) for vertices, *rest in fixed + solid)
    line = ""
    if floor:
        z = MARGIN + (high[1] - 0.0) * scale
        line = f'<line x1="0" y1="{z:.1f}" x2="{width:.1f}" y2="{z:.1f}" stroke="#3a3a3a"/>'
    size = f'width="{width:.0f}" height="{height:.0f}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{shapes}{line}</svg><div>{html.escape(words)}</div>'


def _polygon(vertices: FloatArray, low: FloatArray, high: FloatArray, scale: float, colour: str, name: str) -> str:
    x = MARGIN + (vertices[:, 0] - low[0]) * scale
    y = MARGIN + (high[1] - vertices[:, 1]) * scale
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    return f'<polygon points="{points}" fill="{colour}" stroke="#3a3a3a"><title>{html.escape(name)}</title></polygon>'
