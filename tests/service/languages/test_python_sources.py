"""The words of Python sources, found without a mark."""

import pytest

from service.languages.python_sources import messages


def found(source: str) -> list[str | tuple[str, str]]:
    return [one.id for one in messages(source, "x.py", headings=True)]


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ('a = "The disk is full."', ["The disk is full."]),
        ('a = f"{one.place} moved by {moved}."', ["{place} moved by {moved}."]),
        ("""a = f"{n} flag{'' if n == 1 else 's'} are open" """, [("{n} flag are open", "{n} flags are open")]),
        (
            """a = f"{n} row{'' if n == 1 else 's'} {'has' if n == 1 else 'have'} it" """,
            [("{n} row has it", "{n} rows have it")],
        ),
        ("""a = f"It {'turns' if x else 'turned'} by {y}" """, ["It turns by {y}", "It turned by {y}"]),
        ('a = "Fit by {day:%d}."', ["Fit by {day}."]),
        ('a = counted(3, "row")', [("{n} row", "{n} rows")]),
        ('a = {"key": "Heading"}', ["Heading"]),
    ],
)
def test_messages_of_a_module(source: str, expected: list[str | tuple[str, str]]) -> None:
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
