"""`imu-mapping/1`: how a table of one's own layout is read. Checked here, once, with every fault by its place."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from estimator.errors import FormatError, Problem
from estimator.message import joined, say
from estimator.reading.keys import COLUMNS, TOP
from estimator.reading.problems import shown

FORMAT = "imu-mapping/1"
"""What ``format`` says."""
PARTS = ("format", "table", "columns", "session")
TABLE = {"encoding": str, "separator": str, "decimal": str, "sheet": str, "header_row": int, "first_row": int}
"""How the file is taken apart, as far as that is said."""
COLUMN = {"heading": str, "as": str, "unit": str, "words": dict, "fill_down": bool}
"""What is said of a column."""
MOST_ROW = 1_048_576
"""Of a spreadsheet."""
LONGEST = 1000
"""Characters of a heading or a word."""
ASKED_ANEW = ("unit", "started_at", "operator", "notes", "stage", "origin")
"""Of the session; everything else is the same next time."""


@dataclass(frozen=True)
class ColumnMapping:
    """How one column is read."""

    heading: str
    meaning: str | None
    """A column of a session, a sensor or a sensor's standard error; None where it is left out."""
    unit: str = ""
    words: Mapping[str, str] = field(default_factory=dict)
    fill_down: bool = False
    """Whether an empty cell says what the one above says, as in merged cells."""


@dataclass(frozen=True)
class Layout:
    """A checked mapping."""

    table: Mapping[str, Any]
    columns: tuple[ColumnMapping, ...]
    session: Mapping[str, Any]
    """imu-session/1 without its format and table."""


def layout_of(document: Mapping[str, Any], filename: str) -> Layout:
    """The mapping; FormatError with every fault."""
    problems = [
        *_wrong_format(document),
        *_wrong_table(document.get("table", {})),
        *_wrong_columns(document.get("columns", [])),
        *_wrong_session(document.get("session", {})),
    ]
    if problems:
        raise FormatError(problems, filename)
    columns = tuple(_column(column) for column in document.get("columns", []))
    return Layout(dict(document.get("table", {})), columns, dict(document.get("session", {})))


def _column(given: Mapping[str, Any]) -> ColumnMapping:
    words = {str(word): str(meaning) for word, meaning in given.get("words", {}).items()}
    unit, fill = given.get("unit") or "", bool(given.get("fill_down", False))
    return ColumnMapping(given.get("heading", ""), given.get("as") or None, unit, words, fill)


def _wrong_format(document: Mapping[str, Any]) -> list[Problem]:
    found = [
        Problem(key, say("is not a part of a mapping; it has {parts}", parts=joined(", ", PARTS)))
        for key in document
        if key not in PARTS
    ]
    if document.get("format") != FORMAT:
        found.append(Problem("format", say('must be "{format}"', format=FORMAT)))
    return found


def _wrong_table(table: Any) -> list[Problem]:
    if not isinstance(table, Mapping):
        return [Problem("table", say("is {table}; must be an object", table=shown(table)))]
    found = [
        Problem(f"table.{key}", say("is unknown; give {table}", table=joined(", ", TABLE)))
        for key in table
        if key not in TABLE
    ]
    for key, kind in TABLE.items():
        value = table.get(key)
        if key in table and (not isinstance(value, kind) or isinstance(value, bool)):
            found.append(
                Problem(
                    f"table.{key}",
                    (
                        say("is {value}; must be a whole number", value=shown(value))
                        if kind is int
                        else say("is {value}; must be text", value=shown(value))
                    ),
                )
            )
        elif isinstance(value, int) and not (0 if key == "header_row" else 1) <= value <= MOST_ROW:
            found.append(Problem(f"table.{key}", say("is {value}; must be a row of the file", value=value)))
    if "separator" in table and len(str(table["separator"])) != 1:
        found.append(Problem("table.separator", "must be one character"))
    if table.get("decimal", ".") not in (".", ","):
        found.append(Problem("table.decimal", "must be . or ,"))
    return found


def _wrong_columns(columns: Any) -> list[Problem]:
    if not isinstance(columns, list | tuple):
        return [Problem("columns", say("is {columns}; must be a list", columns=shown(columns)))]
    found, seen = [], set()
    for number, column in enumerate(columns, start=1):
        place = f"columns[{number}]"
        if not isinstance(column, Mapping):
            found.append(
                Problem(place, say("is {column}; must be an object with heading and as", column=shown(column)))
            )
            continue
        found += _wrong_column(place, column)
        meaning = column.get("as")
        if isinstance(meaning, str) and meaning in seen:
            found.append(
                Problem(
                    f"{place}.as",
                    say("another column is also read as {meaning}; remove one", meaning=shown(meaning)),
                )
            )
        seen.add(meaning if isinstance(meaning, str) and meaning else None)
        seen.discard(None)
    return found


def _wrong_column(place: str, column: Mapping[str, Any]) -> list[Problem]:
    found = [
        Problem(f"{place}.{key}", say("is unknown; give {column}", column=joined(", ", COLUMN)))
        for key in column
        if key not in COLUMN
    ]
    for key, kind in COLUMN.items():
        value = column.get(key)
        if value is not None and not isinstance(value, kind):
            found.append(Problem(f"{place}.{key}", say("is {value}; must be of another kind", value=shown(value))))
        elif isinstance(value, str) and len(value) > LONGEST:
            found.append(Problem(f"{place}.{key}", say("is longer than {longest} characters", longest=LONGEST)))
    return found


def _wrong_session(session: Any) -> list[Problem]:
    if not isinstance(session, Mapping):
        return [Problem("session", say("is {session}; must be an object", session=shown(session)))]
    held = [key for key in ("format", "table") if key in session]
    return [Problem(f"session.{key}", "is not given in a mapping; it follows from the file") for key in held]


def meanings(sensors: list[str]) -> tuple[str, ...]:
    """Everything that a column can be read as."""
    return (*sensors, *COLUMNS, *(f"{name}_se" for name in sensors))


def remembered(document: Mapping[str, Any]) -> dict[str, Any]:
    """What holds for the next file of the layout too."""
    session = {key: value for key, value in document.get("session", {}).items() if key not in ASKED_ANEW}
    return {**document, "session": session}


KEYS = TOP
"""Of the session."""
