"""Names that strangers give: ids that become file names, and paths of records that must not lead astray."""

from __future__ import annotations

import re
import unicodedata
from pathlib import Path, PurePosixPath

from studies.campaigns.errors import CampaignError, shown

LONGEST_ID = 200
"""Bytes of an id in UTF-8: `<id>.csv` has to be a file name, of which file systems allow 255 bytes."""

LONGEST_TEXT = 1000
"""Characters of a title or the name of a motion."""


def printable(text: str) -> bool:
    """Whether the text has no control, format or surrogate character and no line break."""
    return not any(unicodedata.category(c) in ("Cc", "Cf", "Cs", "Zl", "Zp") for c in text)


def checked_id(id: str, where: str) -> str:
    """The id of a test, which results use as a file name.

    Raises:
        CampaignError: it is empty, overlong, nothing but dots, or holds a slash, a control character or outer blanks.
    """
    fits = bool(id) and id == id.strip() and printable(id) and not set(id) & set("/\\") and bool(id.strip("."))
    if not fits or len(id.encode("utf-8")) > LONGEST_ID:
        raise CampaignError(
            f"{where}: id={shown(id)}, want a name that can be a file's: 1 to {LONGEST_ID} bytes, no slash, no control "
            "character, no outer blanks, not only dots"
        )
    return id


def record_path(folder: Path, data: str, where: str) -> Path:
    """The file of a record, in the campaign's folder or in a folder beside it.

    Args:
        folder: of campaign.toml.
        data: the path as declared, relative to it.
        where: what an error names first.

    Raises:
        CampaignError: the path is absolute, goes up more than once or elsewhere than at its start, leads out through
            a symbolic link, or is no path at all.
    """
    parts = PurePosixPath(data).parts
    odd = not data.strip() or not printable(data) or "\\" in data or re.match(r"[A-Za-z]:", data) or len(data) > 1000
    if odd or data.startswith(("/", "~")) or ".." in parts[1:] or parts in (("..",), ()):
        raise CampaignError(
            f"{where}: data={shown(data)}, want a relative path with forward slashes, in the campaign's folder or "
            "(one '..') in one beside it"
        )
    path = folder / data
    try:
        inside = path.resolve().is_relative_to(folder.resolve().parent)
    except (OSError, RuntimeError):
        inside = False
    if not inside:
        raise CampaignError(f"{where}: data={shown(data)} leads out through a link, want a file beside the campaign")
    return path
