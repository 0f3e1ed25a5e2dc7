"""A record is made of what stands under the names of its fields elsewhere."""

from dataclasses import dataclass
from types import SimpleNamespace

import pytest

from service.kit.copying import copied
from service.sessions.decision import Verdict


@dataclass(frozen=True)
class Line:
    """A verdict with its place."""

    kind: str
    verdict: Verdict
    row: str


def test_fields_of_the_same_names_are_taken_and_others_given() -> None:
    row = SimpleNamespace(kind="bias", verdict="fail", row=17, more="left")
    line = copied(Line, row, row="A3")
    assert (line, line.verdict) == (Line("bias", Verdict.FAIL, "A3"), Verdict.FAIL)


def test_a_field_that_is_nowhere_is_a_fault() -> None:
    with pytest.raises(AttributeError, match="verdict"):
        copied(Line, SimpleNamespace(kind="bias"), row="A3")
