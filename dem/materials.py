"""Contact parameters, one set for all contacts or one for each pair of materials.

Source  Winkler, Meguro & Yamazaki (1995): kn = ks = 1.98e7 N/m, one damping for both directions
Status  missing pairs and bad numbers are refused (tests)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dem import checks
from dem.shapes import FloatArray


@dataclass(frozen=True)
class Contact:
    """Springs, dashpots and friction of one contact.

    mu: friction coefficient, 0 to math.inf
    damping: dashpot c, normal and shear [N s/m]; or instead damping_ratio = c/(2 sqrt(kn m)), m the mass of the body on
        a wall or the floor and m1 m2/(m1 + m2) of two bodies
    kn, ks: normal and shear stiffness [N/m]

    Raises ValueError unless exactly one damping is given and all lie in their ranges.
    """

    mu: float
    damping: float | None = None
    damping_ratio: float | None = None
    kn: float = 1.98e7
    ks: float = 1.98e7

    def __post_init__(self) -> None:
        checks.positive("kn", self.kn, "N/m")
        checks.positive("ks", self.ks, "N/m")
        checks.friction("mu", self.mu)
        if (self.damping is None) == (self.damping_ratio is None):
            raise ValueError(f"damping={self.damping}, damping_ratio={self.damping_ratio}: want exactly one of the two")
        checks.not_negative("damping", self.damping or 0.0, "N s/m")
        checks.not_negative("damping_ratio", self.damping_ratio or 0.0, "(share of critical)")


_NEVER = Contact(0.0, damping=0.0)  # of two materials that cannot meet

Contacts = Contact | Mapping[tuple[str, str], Contact]


@dataclass(frozen=True, eq=False)
class ContactTable:
    """Contact parameters by pair of material numbers, each of shape (material, material); c: given dashpot [N s/m],
    ratio: given share of critical damping.  All are 0 for two materials that cannot meet."""

    names: tuple[str, ...]
    kn: FloatArray
    ks: FloatArray
    c: FloatArray
    ratio: FloatArray
    mu: FloatArray

    def dashpot(self, i: int, j: int, mass: float) -> float:
        """c of a pair of materials [N s/m], mass: reduced mass of the bodies [kg]."""
        return float(self.c[i, j] + self.ratio[i, j] * 2.0 * math.sqrt(self.kn[i, j] * mass))


def contact_table(contacts: Contacts, movable: Sequence[str], fixed: Sequence[str]) -> ContactTable:
    """Table for the materials of these bodies and of what is fixed to the table.

    Raises ValueError where `contacts` says nothing of a pair that can meet, says it twice differently, or is neither a
    Contact nor a mapping of pairs of names to Contacts.
    """
    _check(contacts)
    names = tuple(dict.fromkeys((*movable, *fixed)))
    several = {name for name in movable if movable.count(name) > 1}
    own = set(movable)

    def can_meet(first: str, second: str) -> bool:
        if first == second:
            return first in several or (first in own and first in fixed)
        return first in own or second in own

    rows = [
        [_between(contacts, first, second) if can_meet(first, second) else _NEVER for second in names]
        for first in names
    ]

    def table(of: Callable[[Contact], float]) -> FloatArray:
        # Nothing of two that cannot meet: no step is to be as small as their springs would want it.
        some = [[0.0 if contact is _NEVER else of(contact) for contact in row] for row in rows]
        return np.array(some, dtype=np.float64)

    return ContactTable(
        names,
        table(lambda contact: contact.kn),
        table(lambda contact: contact.ks),
        table(lambda contact: contact.damping or 0.0),
        table(lambda contact: contact.damping_ratio or 0.0),
        table(lambda contact: contact.mu),
    )


def _check(contacts: object) -> None:
    if isinstance(contacts, Contact):
        return
    wanted = "a Contact, or a mapping of pairs of materials to Contacts"
    if not isinstance(contacts, Mapping):
        raise ValueError(f"contact={contacts!r}: want {wanted}")
    for pair, contact in contacts.items():
        if not (isinstance(pair, tuple) and len(pair) == 2 and all(isinstance(name, str) for name in pair)):
            raise ValueError(f"contact of {pair!r}: want the names of two materials")
        checks.kind(f"contact of {pair!r}", contact, Contact, "a Contact")


def _between(contacts: Contacts, first: str, second: str) -> Contact:
    if isinstance(contacts, Contact):
        return contacts
    found = {contacts[pair] for pair in ((first, second), (second, first)) if pair in contacts}
    if len(found) != 1:
        raise ValueError(
            f"contacts say {'nothing' if not found else 'two things'} of {first!r} on {second!r}: want one Contact"
        )
    return found.pop()
