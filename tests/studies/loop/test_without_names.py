"""A campaign that one coefficient without a name explains, closed from end to end."""

import pytest

from rocking.effects import load
from studies.loop import closing
from studies.loop.search import searching

from .found import _found

SIDE = 0.025
"""What restitution is more on one side than in the middle, and less on the other."""


@pytest.mark.slow
def test_what_one_coefficient_explains_is_unexplained_and_neither_revised_nor_learned_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Restitution of 0.945 and 0.895 by side: four releases and a shaken record, of the package's own solver."""
    for later in ("revised", "learn", "_compared"):
        monkeypatch.setattr(closing, later, None)
    monkeypatch.setattr(searching, "_going_back", None)
    wanted = ("viscous_damping", "quadratic_drag", "sliding", "compliant_base")
    found = _found((load("learned_term")(restitution_side=SIDE),), wanted)
    assert (found.verdict, found.chosen.names) == ("unexplained", ("learned[restitution_side]",))
    value, low, high = found.intervals["learned_term.restitution_side"]
    assert low < SIDE < high and abs(value - SIDE) < 0.1 * SIDE
    assert found.rivals == () and found.indistinguishable == ()
    # It is said why a floor that gives was not tried.
    assert found.rounds[0].skipped["compliant_base"] == searching.ONE_TERM
    assert found.errors["after"].fit < 0.2 * found.errors["before"].fit
