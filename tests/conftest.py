"""Settings for all tests."""

from hypothesis import settings

# Compiling on first use takes seconds, which is no fault of the example that happens to come first.  By default a
# property is tried on the same examples every time, so that the same code gets the same answer;
# `pytest --hypothesis-profile=search` draws new ones, and many.
settings.register_profile("default", deadline=None, derandomize=True)
settings.register_profile("search", deadline=None, max_examples=2000)
settings.load_profile("default")
