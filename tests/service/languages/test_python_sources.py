"""The words of Python sources: templates, and literals found without a mark."""

import pytest

from service.languages.python_sources import MessageId, finished, messages
from service.languages.short import NAMES
from service.languages.sources import modules


def found(source: str) -> list[MessageId]:
    return list(messages(source, headings=True))


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ('a = "The disk is full."', ["The disk is full."]),
        ('a = say("{place} moved by {moved}.", place=one.place, moved=f"{x:.1f} µg")', ["{place} moved by {moved}."]),
        ('a = say_count("{n} row has it", "{n} rows have it", n)', [("{n} row has it", "{n} rows have it")]),
        ('a = say("It turns by {y}" if x else "It turned by {y}", y=y)', ["It turns by {y}", "It turned by {y}"]),
        (
            'a = say("{what} is {how}.", what="The disk", how="rather full")',
            ["{what} is {how}.", "The disk", "rather full"],
        ),
        ('a = counted(3, "row")', [("{n} row", "{n} rows")]),
        ('a = {"key": "Heading"}', ["Heading"]),
    ],
)
def test_messages_of_a_module(source: str, expected: list[MessageId]) -> None:
    assert found(source) == expected


@pytest.mark.parametrize(
    "source",
    [
        '"""What a module is."""',
        'def f():\n    """What it does."""',
        'log.info("request failed at once")',
        'a = "a-key"',
        'a = "/units/{serial}"',
        'a: "Some kind of type" = 1',
        'a = Field(description="What a field is.")',
    ],
)
def test_what_is_said_to_programs_is_no_message(source: str) -> None:
    assert found(source) == []


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ('a = f"{one.place} moved by {moved}."', ["{value} moved by {value}."]),
        ('a = f"{sensor}.bias"', []),
        ('a = say("{place} moved.", place=f"{sensor}.bias")', []),
    ],
)
def test_a_sentence_without_its_parts_is_found(source: str, expected: list[str]) -> None:
    assert list(finished(source)) == expected


def test_every_sentence_keeps_its_parts() -> None:
    """A sentence made by an f-string cannot be translated: sentences are made by `estimator.message.say`."""
    found = {path.name: set(finished(path.read_text("utf-8"))) - NAMES for path in modules()}
    assert {name: texts for name, texts in found.items() if texts} == {}
