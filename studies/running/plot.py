"""How the figures look: colours that colour-blind readers can tell apart, and captions.

Source   Okabe & Ito (2008), Color Universal Design, for the colours.
"""

from __future__ import annotations

import textwrap

from matplotlib.figure import Figure

COLOURS = {"method1": "#D55E00", "method2": "#0072B2", "dem": "#009E73"}

MODE_COLOURS = {
    "rest": "#DDDDDD",
    "slide": "#F0E442",
    "rotation": "#56B4E9",
    "slide_rotation": "#0072B2",
    "translation_jump": "#CC79A7",
    "rotation_jump": "#D55E00",
}


def new_figure(width: float, height: float) -> Figure:
    """A figure of that size [inch] that needs no display."""
    return Figure(figsize=(width, height), layout="constrained")


def caption(figure: Figure, text: str) -> None:
    """Write what to notice below the panels."""
    characters = int(figure.get_figwidth() * 13.5)
    figure.supxlabel("\n".join(textwrap.wrap(text, characters)), fontsize=9, ha="left", x=0.01)
