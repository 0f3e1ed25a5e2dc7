"""A class name means one thing in the whole program."""

import re
from collections import Counter

from tests.project.source import PACKAGES, modules

SEEN_FROM_OUTSIDE = {"Diagnosis", "Finding", "Flag", "Receipt", "Reservation", "Usable"}
"""The client's answers: the same records, as a program reads them over HTTP."""
OF_THE_API = {"Readiness", "Setting", "Signature"}
"""Names in the API's description, which programs may use, that the numerics use for something else."""
KINDS = {"Kind"}
"""Names used twice: a change through time, and background work."""


def test_no_name_is_given_to_two_classes() -> None:
    texts = (module.path.read_text("utf-8") for module in modules(*PACKAGES))
    names = Counter(name for text in texts for name in re.findall(r"^class (\w+)", text, re.MULTILINE))
    assert {name for name, count in names.items() if count > 1} <= SEEN_FROM_OUTSIDE | OF_THE_API | KINDS
