"""The picture of a file's records: acceleration, velocity, displacement and response spectrum, a colour a component."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from excitation.formats.text import write_whole
from excitation.record import Record
from excitation.spectra import response_spectrum

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")
"""Distinct for most kinds of colour vision (Okabe & Ito 2008)."""


def figure(records: Sequence[Record]) -> Any:
    """A matplotlib Figure of the records of one file."""
    from matplotlib.figure import Figure

    drawing = Figure(figsize=(11.0, 8.0), layout="constrained")
    axes = drawing.subplot_mosaic([["a", "s"], ["v", "s"], ["d", "s"]], width_ratios=[1.6, 1.0])
    for k, record in enumerate(records):
        style: dict[str, Any] = {
            "color": COLOURS[k % len(COLOURS)],
            "linewidth": 0.8,
            "label": record.component or f"component {k + 1}",
        }
        axes["a"].plot(record.times, record.acceleration, **style)
        axes["v"].plot(record.times, record.velocity, **style)
        axes["d"].plot(record.times, record.displacement, **style)
        spectrum = response_spectrum(record)
        axes["s"].loglog(spectrum.periods, spectrum.pseudo_acceleration, **style)
    labels = {"a": "acceleration [m/s²]", "v": "velocity [m/s]", "d": "displacement [m]"}
    for name, label in labels.items():
        axes[name].set(ylabel=label, xlabel="time [s]" if name == "d" else "")
        axes[name].margins(x=0.0)
        axes[name].grid(alpha=0.3)
    axes["s"].set(xlabel="period [s]", ylabel="pseudo-acceleration, 5 % damping [m/s²]")
    axes["s"].grid(alpha=0.3, which="both")
    axes["s"].legend()
    drawing.align_ylabels([axes[name] for name in labels])
    drawing.suptitle(f"{records[0].source}\n{records[0].event}".strip(), fontsize=10)
    return drawing


def save(records: Sequence[Record], path: Path) -> None:
    """Draw the records into a PNG file."""
    drawing = figure(records)
    write_whole(path, lambda target: drawing.savefig(target, format="png", dpi=120))
