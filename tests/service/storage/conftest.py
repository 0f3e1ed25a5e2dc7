"""Facts of the databases themselves: each on both engines."""

from tests.databases import all_on_both_engines as pytest_generate_tests  # noqa: F401 - the hook
