"""K-NET and KiK-net: seventeen lines of header, then counts in rows of eight.

Source   NIED, K-NET ASCII format: `Scale Factor` turns counts into gal; `Dir.` is N-S, E-W or U-D for K-NET and 1 to 6
         for KiK-net (1-3 borehole, 4-6 surface: N-S, E-W, U-D); `Record Time` is Japan time (UTC + 9 h) and lags the
         first sample by the 15 s of the trigger's delay.
Status   counts are scaled and nothing else: the offset of the sensor stays in, as in the file.
"""

from __future__ import annotations

from datetime import datetime, timedelta

import numpy as np

from excitation.formats.text import TextFile, decimals
from excitation.record import Record
from excitation.units import factor

NAME = "knet"
TITLE = "K-NET and KiK-net"
KEYS = (
    "Origin Time", "Lat.", "Long.", "Depth. (km)", "Mag.", "Station Code", "Station Lat.", "Station Long.",
    "Station Height(m)", "Record Time", "Sampling Freq(Hz)", "Duration Time(s)", "Dir.", "Scale Factor",
    "Max. Acc. (gal)", "Last Correction", "Memo.",
)  # fmt: skip
RECORD_TIME, RATE, DURATION, DIRECTION, SCALE, PEAK = 9, 10, 11, 12, 13, 14
KIKNET = {"1": "N-S", "2": "E-W", "3": "U-D", "4": "N-S", "5": "E-W", "6": "U-D"}
AZIMUTH = {"N-S": 0.0, "E-W": 90.0, "U-D": None}
DELAY = timedelta(seconds=15)
JAPAN = timedelta(hours=9)


def recognises(text: TextFile) -> bool:
    """Whether the first lines are those of the header."""
    return text.lines[0].startswith("Origin Time") and any(x.startswith("Station Code") for x in text.lines[:17])


def _header(text: TextFile) -> list[str]:
    values = []
    for i, key in enumerate(KEYS):
        line = text.line(i, f"the header line {key!r}")
        if not line.startswith(key):
            text.fail(i, f"the header line {key!r}")
        values.append(line[len(key) :].strip())
    return values


def _start(text: TextFile, value: str) -> str:
    try:
        japan = datetime.strptime(value, "%Y/%m/%d %H:%M:%S")
    except ValueError:
        text.fail(RECORD_TIME, "Record Time as yyyy/mm/dd hh:mm:ss")
    try:
        return (japan - JAPAN - DELAY).isoformat()
    except OverflowError:
        text.fail(RECORD_TIME, "Record Time in a year after 1")


def _direction(text: TextFile, value: str) -> tuple[str, str]:
    """(component, where the sensor is)."""
    if value in KIKNET:
        return KIKNET[value], "borehole" if value in "123" else "surface"
    if value not in AZIMUTH:
        text.fail(DIRECTION, "Dir. N-S, E-W, U-D or 1 to 6")
    return value, "surface"


def parse(text: TextFile) -> list[Record]:
    """The one record of the file."""
    header = _header(text)
    wanted = "Sampling Freq(Hz) such as 100Hz"
    rate = text.positive(RATE, text.match(RATE, r"\)\s*([\d.]+)\s*Hz\s*$", wanted).group(1), wanted)
    length = text.positive(DURATION, header[DURATION], "Duration Time(s) above zero")
    wanted = "Scale Factor such as 7845(gal)/8223790"
    numerator, denominator = text.match(SCALE, r"([\d.]+)\(gal\)/([\d.]+)\s*$", wanted).groups()
    scale = text.positive(SCALE, numerator, wanted) / text.positive(SCALE, denominator, wanted)
    component, place = _direction(text, header[DIRECTION])
    counts = text.counted(len(KEYS), len(text.lines), round(rate * length), DURATION)
    if counts.size < 2:
        text.fail(DURATION, "Duration Time(s) of two samples or more")
    peak = text.number(PEAK, header[PEAK], "Max. Acc. (gal) as a number")
    # The header's largest acceleration is that about the mean, one unit of counts besides its own rounding.
    largest = scale * float(np.max(np.abs(counts - np.mean(counts))))
    text.check_peak(PEAK, peak, largest, decimals(header[PEAK]) + scale)
    keys = {key: value for key, value in zip(KEYS, header, strict=True) if value}
    return [
        Record(
            1.0 / rate, factor("gal", "acceleration") * scale * counts, component=component,
            azimuth_deg=AZIMUTH[component], vertical=component == "U-D", station=header[5],
            event=" ".join(v for v in (header[0], f"M {header[4]}" if header[4] else "") if v),
            start_time=_start(text, header[RECORD_TIME]), source=text.name, format=NAME, file_units="gal",
            sha256=text.sha256, metadata=keys | {"sensor at": place},
        )
    ]  # fmt: skip
