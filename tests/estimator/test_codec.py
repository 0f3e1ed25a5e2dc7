"""Dataclasses to plain JSON and back."""

import json
from dataclasses import dataclass
from enum import StrEnum
from math import isnan, nan

import numpy as np
import pytest

from estimator.codec import DEGREES, PLAIN, Document, UnreadableError, named
from estimator.session import Array


class Colour(StrEnum):
    RED = "red"


@dataclass(frozen=True)
class Part:
    size: float
    tags: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Whole(
    Document,
    format="whole/1",
    order=("colour", "twice", "matrix", "angle", "pair", "parts", "by_name", "note"),
    keys={"twice": "sums.twice", "matrix": "sums.matrix", "angle": "angle_deg"},
    forms={"angle": DEGREES, "pair": named("name", "size")},
    optional=("note",),
    earlier=lambda old: {"pair": {"name": "none", "size": 0.0}} | old,
):
    colour: Colour
    matrix: Array
    angle: Array
    pair: tuple[str, float]
    parts: tuple[Part, ...]
    by_name: dict[str, float]
    note: str | None = None

    @property
    def twice(self) -> int:
        return 2 * len(self.parts)


WHOLE = Whole(
    Colour.RED,
    np.array([[1.0, np.nan], [np.inf, 2.0]]),
    np.array([np.pi]),
    ("a", nan),
    (Part(1.5, ("x",)), Part(np.float64(2.5))),
    {"b": nan},
)
WRITTEN = {
    "format": "whole/1",
    "colour": "red",
    "sums": {"twice": 4, "matrix": [[1.0, None], [None, 2.0]]},
    "angle_deg": [180.0],
    "pair": {"name": "a", "size": None},
    "parts": [{"size": 1.5, "tags": ["x"]}, {"size": 2.5, "tags": []}],
    "by_name": {"b": None},
}


def test_a_class_says_how_it_is_written() -> None:
    assert json.dumps(WHOLE.to_dict()) == json.dumps(WRITTEN)


def test_what_was_written_is_read() -> None:
    read = Whole.from_dict(WRITTEN)
    np.testing.assert_array_equal(read.matrix, [[1.0, np.nan], [np.nan, 2.0]])
    assert (read.colour, read.parts, read.note) == (Colour.RED, WHOLE.parts, None)
    assert read.angle == pytest.approx([np.pi])
    assert isnan(read.by_name["b"])


def test_what_an_earlier_version_lacks_is_filled_in_and_what_is_unknown_ignored() -> None:
    earlier = {name: value for name, value in WRITTEN.items() if name != "pair"} | {"new": 1}
    assert Whole.from_dict(earlier).pair == ("none", 0.0)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"parts": [{"size": 1.0}, {"size": "much"}]}, r"^parts\[1\]\.size: a number is expected, not 'much'"),
        ({"parts": [{}]}, r"^parts\[0\]\.size: it is missing"),
        ({"by_name": {"b": []}}, r"^by_name\.b: a number is expected"),
        ({"sums": {}}, r"^sums\.matrix: it is missing"),
        ({"sums": {"matrix": [["a"]]}}, r"^sums\.matrix: .* cannot be read"),
        ({"colour": "blue"}, r"^colour: 'blue' cannot be read"),
        ({"parts": 3}, r"^parts: a list is expected"),
        ({"format": "whole/2"}, r"^format: it is 'whole/2', not whole/1"),
    ],
)
def test_what_cannot_be_read_is_named(wrong: dict[str, object], said: str) -> None:
    with pytest.raises(UnreadableError, match=said):
        Whole.from_dict(WRITTEN | wrong)


def test_a_type_that_json_does_not_have_is_refused() -> None:
    with pytest.raises(TypeError, match="object is not kept as JSON"):
        PLAIN.written([object()])
