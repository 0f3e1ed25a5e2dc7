"""Sentences with their parts."""

import json
import pickle
from copy import deepcopy
from typing import Any

import pytest

from estimator.message import (
    Message,
    as_document,
    capitalised,
    changed,
    joined,
    say,
    say_count,
    uncapitalised,
    with_messages,
    without_stop,
)

MOVED = say("{sensor} moved by {size}.", sensor="A3", size=say("{value} of {limit}", value=12, limit="50 µg"))


def parts_of(text: str) -> Any:
    """All that a text is made of."""
    if not isinstance(text, Message):
        return text
    return text.template, text.many, text.number, {name: parts_of(part) for name, part in text.parts.items()}


def test_a_message_is_its_english_text() -> None:
    assert MOVED == "A3 moved by 12 of 50 µg."
    assert json.dumps(MOVED) == '"A3 moved by 12 of 50 \\u00b5g."'


@pytest.mark.parametrize(("number", "expected"), [(1, "1 row has it"), (0, "0 rows have it"), (3, "3 rows have it")])
def test_a_number_decides_between_one_and_many(number: int, expected: str) -> None:
    assert say_count("{n} row has it", "{n} rows have it", number) == expected


def test_a_part_is_never_read_as_a_template() -> None:
    assert say("{a} and {b}", a="{b}", b="\\1 {a}") == "{b} and \\1 {a}"


@pytest.mark.parametrize("copied", [deepcopy, lambda one: pickle.loads(pickle.dumps(one)), str])
def test_a_copy_has_its_parts(copied: object) -> None:
    assert callable(copied)
    assert parts_of(copied(MOVED)) == parts_of(MOVED)


def test_the_sentence_of_an_error_has_its_parts() -> None:
    assert parts_of(str(ValueError(MOVED))) == parts_of(MOVED)


@pytest.mark.parametrize("message", [MOVED, say("Plain."), say_count("{n} row", "{n} rows", 3), joined("; ", (MOVED,))])
def test_a_message_written_and_read_is_the_same(message: Message) -> None:
    document = json.loads(json.dumps({"kept": [as_document(message)]}))
    assert parts_of(with_messages(document)["kept"][0]) == parts_of(message)


@pytest.mark.parametrize("document", ["A plain text.", {"message": 3}, {"message": "text", "from": "somebody"}, [1.5]])
def test_what_is_no_message_is_read_as_it_stands(document: object) -> None:
    assert with_messages(document) == document


@pytest.mark.parametrize(
    ("joint", "parts", "expected"),
    [
        ("; ", ("a", "b", "c"), "a; b; c"),
        (" and ", ("a", "b", "c"), "a and b and c"),
        (" or ", ("a",), "a"),
        (", ", (), ""),
    ],
)
def test_texts_in_a_row(joint: str, parts: tuple[str, ...], expected: str) -> None:
    assert joined(joint, parts) == expected


def test_texts_added_to_a_message_are_parts() -> None:
    added = "(" + MOVED + ")"
    assert added == f"({MOVED})"
    assert parts_of(MOVED) in parts_of(added)[3].values() or parts_of(added) == parts_of(
        joined("", (joined("", ("(", MOVED)), ")"))
    )


@pytest.mark.parametrize(
    ("change", "text", "expected"),
    [
        (capitalised, say("it moved"), "It moved"),
        (capitalised, say("{what} moved", what=say("the zero")), "The zero moved"),
        (capitalised, "plain", "Plain"),
        (uncapitalised, say("It moved"), "it moved"),
        (without_stop, MOVED, "A3 moved by 12 of 50 µg"),
        (without_stop, say("{why}", why=say("It moved.")), "It moved"),
        (without_stop, "plain.", "plain"),
        (lambda text: changed(text, str.upper), say("it {x}", x="moved"), "IT MOVED"),
    ],
)
def test_a_changed_message_still_has_its_parts(change: object, text: str, expected: str) -> None:
    assert callable(change)
    found = change(text)
    assert found == expected
    assert isinstance(found, Message) is isinstance(text, Message)
