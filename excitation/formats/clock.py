"""When a record starts, as headers say it: `Start time:  2/13/12, 21:06:45.0 UTC` and its relatives."""

from __future__ import annotations

import re
from datetime import datetime, timedelta

from excitation.formats.text import TextFile

_TIME = (
    r"(?:start|trigger) time:\s*(\d{1,4})[/-](\d{1,2})[/-](\d{1,4}),?"
    r"\s+(\d{1,2}):\s*(\d{1,2}):\s*(\d{0,2}\.?\d*)\s*(?:UTC|GMT)"
)
OLDEST = 70
"""Two digits below it are years after 2000."""


def start_time(text: TextFile, first: int, last: int) -> str:
    """ISO 8601 in UTC of the first line from `first` to `last` that states it; empty if none does, or in local time.

    Raises RecordFileError if a line states a time that there is not.
    """
    for i in range(first, min(last, len(text.lines))):
        found = re.search(_TIME, text.head(i), re.IGNORECASE)
        if found:
            try:
                return _time(*found.groups()).isoformat()
            except (ValueError, OverflowError):
                text.fail(i, "a date and a time of day")
    return ""


def _time(a: str, b: str, c: str, hour: str, minute: str, second: str) -> datetime:
    year, month, day = (a, b, c) if len(a) == 4 else (c, a, b)
    full = int(year) if len(year) > 2 else int(year) + (1900 if int(year) >= OLDEST else 2000)
    # Seconds are added, since 60.0 is met in headers; ".0" is none.
    whole, _, rest = second.partition(".")
    return datetime(full, int(month), int(day), int(hour), int(minute)) + timedelta(seconds=float(f"0{whole}.{rest}0"))
