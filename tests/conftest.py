"""Settings for all tests."""

from hypothesis import settings

# Compiling on first use takes seconds, which is no fault of the example that happens to come first.
settings.register_profile("default", deadline=None)
settings.load_profile("default")
