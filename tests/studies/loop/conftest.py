"""What the tests of this folder share: its packages and modules can be imported by name, and fits are done in turn."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(autouse=True)
def in_turn(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """One fit after the other, since stand-ins for fits note in which order they are asked; slow tests have no such."""
    if not request.node.get_closest_marker("slow"):
        from studies.loop.runs import at_once

        monkeypatch.setattr(at_once, "AT_ONCE", 1)
