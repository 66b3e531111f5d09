"""What is said of a campaign that cannot be used: one sentence with the file, line or test, and what was wanted."""

from __future__ import annotations

from typing import Any

LONGEST = 60
"""Characters of a stranger's text that an error repeats."""


class CampaignError(ValueError):
    """A measured campaign is not what the format promises; the message is one sentence."""


def shown(value: Any) -> str:
    """`value` as an error shows it: quoted, without control characters, cut to `LONGEST` characters."""
    if isinstance(value, list | dict):
        return "a list" if isinstance(value, list) else "a table"
    try:
        text = ascii(value) if isinstance(value, str) and not value.isprintable() else repr(value)
    except ValueError:  # Python prints no integer of more than 4300 digits
        return "a number of thousands of digits"
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."
