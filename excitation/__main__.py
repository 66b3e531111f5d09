"""What a record file holds: `python -m excitation FILE [--plot PNG]`.

One line of facts for each component; with `--plot` acceleration, velocity, displacement and response spectrum as PNG.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from excitation import _early
from excitation.formats import formats, read
from excitation.formats.text import one_line
from excitation.intensities import intensity
from excitation.record import Record
from excitation.units import STANDARD_GRAVITY

OFFSET = "offset removed [m/s^2]"


def facts(record: Record) -> str:
    """One line: what it is, how long, how strong."""
    made = intensity(record)
    direction = record.component or "?"
    if record.azimuth_deg is not None and direction != f"{record.azimuth_deg:g}":
        direction += f" ({record.azimuth_deg:g} deg)"
    elif record.vertical and direction.lower() not in ("up", "vertical"):
        direction += " (vertical)"
    place = ", ".join(text for text in (record.event, record.station, record.start_time) if text)
    offset = record.metadata.get(OFFSET)
    parts = (
        f"{record.source} [{record.format}, {record.file_units}]",
        direction,
        f"{record.acceleration.size} samples at {record.time_step:g} s = {record.duration:g} s",
        f"PGA {made.pga:.4g} m/s^2 ({made.pga / STANDARD_GRAVITY:.3g} g)",
        f"PGV {made.pgv:.3g} m/s",
        f"PGD {made.pgd:.3g} m",
        f"Arias {made.arias:.3g} m/s",
        f"CAV {made.cav:.3g} m/s",
        f"D5-95 {made.significant_duration:.3g} s",
        f"after an offset of {offset} m/s^2 was taken out" if offset else "",
        place,
    )
    # Names are the file's: nothing of them may drive a terminal.
    return one_line("  ".join(part for part in parts if part))


def without_offset(record: Record) -> Record:
    """The record less its mean, where that is more than a hundredth of what is left.

    Raw records hold the zero of the sensor, whose integrals say nothing.  What was taken out stands in the metadata.
    """
    mean = float(np.mean(record.acceleration))
    rest = record.acceleration - mean
    if abs(mean) <= 0.01 * float(np.max(np.abs(rest))):
        return record
    centred = record.with_samples(rest, note="mean removed")
    return replace(centred, metadata=dict(centred.metadata) | {OFFSET: f"{mean:.4g}"})


def _parser() -> argparse.ArgumentParser:
    known = "; ".join(f"{name}: {title}" for name, title in formats().items())
    parser = argparse.ArgumentParser(prog="python -m excitation", description=__doc__.splitlines()[0], epilog=known)
    parser.add_argument("file", type=Path, help="a record in any of the formats below")
    parser.add_argument("--format", choices=sorted(formats()), help="found by what the file holds if not given")
    parser.add_argument("--units", help="unit of acceleration, for a file that states none")
    parser.add_argument("--time-units", help="unit of time, for columns that state none")
    parser.add_argument(
        "--plot", nargs="?", const=Path(), type=Path, metavar="PNG", help="draw it; FILE.png here if no name is given"
    )
    return parser


def main(arguments: list[str] | None = None) -> int:
    """Print the facts, draw the picture; 0, or 2 and a sentence on stderr if the file cannot be read, 130 on Ctrl-C."""
    _early.loaded()
    try:
        return _shown(arguments)
    except KeyboardInterrupt:
        print("interrupted: nothing was written", file=sys.stderr)
        return 130


def _shown(arguments: list[str] | None) -> int:
    options = _parser().parse_args(arguments)
    try:
        found = read(options.file, format=options.format, units=options.units, time_units=options.time_units)
    except OSError as error:
        print(f"{options.file}: want a file that can be read ({error.strerror})", file=sys.stderr)
        return 2
    except ValueError as error:
        print(error, file=sys.stderr)
        return 2
    records = [without_offset(record) for record in found]
    for record in records:
        print(facts(record))
    if options.plot is not None:
        from excitation.plot import save

        picture = Path(f"{options.file.name}.png") if options.plot == Path() else options.plot
        try:
            save(records, picture)
        except OSError as error:
            print(f"--plot {picture}: want a file that can be written ({error.strerror})", file=sys.stderr)
            return 2
        print(picture)
    return 0


if __name__ == "__main__":
    sys.exit(main())
