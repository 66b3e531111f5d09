"""Settings for all tests."""

import time

import pytest
from hypothesis import settings

# Compiling on first use takes seconds, which is no fault of the example that happens to come first.  By default a
# property is tried on the same examples every time, so that the same code gets the same answer;
# `pytest --hypothesis-profile=search` draws new ones, and many.
settings.register_profile("default", deadline=None, derandomize=True)
settings.register_profile("search", deadline=None, max_examples=2000)
settings.load_profile("default")

BEGAN = time.monotonic()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--begin-within", type=float, metavar="SECONDS", help="skip, each by name, the tests that would begin later"
    )


def pytest_runtest_setup(item: pytest.Item) -> None:
    within = item.config.getoption("--begin-within")
    if within is not None and time.monotonic() - BEGAN > within:
        pytest.skip(f"{item.nodeid}: not begun within {within:g} s")
