"""`imu-mapping/1`: the mapping of a table of custom layout. Checked here, once; every fault is named with its place."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from estimator.errors import FormatError, Problem, problem_at
from estimator.json_object import Json
from estimator.message import joined, say
from estimator.reading.problems import shown

FORMAT = "imu-mapping/1"
PARTS = ("format", "table", "columns", "session")
TABLE = {
    "encoding": str,
    "separator": str,
    "record": str,
    "decimal": str,
    "sheet": str,
    "header_row": int,
    "first_row": int,
}
"""Settings of the parser, as far as stated."""
COLUMN = {"heading": str, "as": str, "unit": str, "words": dict, "fill_down": bool}
ENCODINGS = ("utf-8", "utf-16", "utf-16-le", "utf-16-be", "cp1251", "cp1252", "koi8-r", "cp866")
"""Encodings of tables that are recognised, and can be chosen by hand."""
MOST_ROW = 1_048_576
"""Rows of a spreadsheet."""
LONGEST = 1000
"""Characters of a heading or a word."""
PER_FILE_FIELDS = (
    "unit", "started_at", "powered_on_at", "time_since_power_on_s", "operator", "notes", "stage", "origin",
)  # fmt: skip
"""Fields of a session that differ from file to file; the others are kept for the next one."""


def fingerprint(preview: Mapping[str, Any]) -> str:
    """SHA-256 of the headings of a preview, in lower case and without spaces."""
    headings = ["".join(column["heading"].casefold().split()) for column in preview["columns"]]
    return hashlib.sha256("\n".join(headings).encode()).hexdigest()


@dataclass(frozen=True)
class ColumnMapping:
    """Mapping of one column."""

    heading: str
    meaning: str | None
    """A column of a session, a sensor or a sensor's standard error; None where it is ignored."""
    unit: str = ""
    words: Mapping[str, str] = field(default_factory=dict)
    fill_down: bool = False
    """Whether an empty cell repeats the one above, as in merged cells."""


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


def _column(document: Mapping[str, Any]) -> ColumnMapping:
    words = {str(word): str(meaning) for word, meaning in document.get("words", {}).items()}
    unit, fill = document.get("unit") or "", bool(document.get("fill_down", False))
    return ColumnMapping(document.get("heading", ""), document.get("as") or None, unit, words, fill)


def _wrong_format(document: Mapping[str, Any]) -> list[Problem]:
    problems = [
        problem_at(key, "is not a part of a mapping; it has {parts}", parts=joined(", ", PARTS))
        for key in document
        if key not in PARTS
    ]
    if document.get("format") != FORMAT:
        problems.append(problem_at("format", 'must be "{format}"', format=FORMAT))
    return problems


def _wrong_table(table: Any) -> list[Problem]:
    if not isinstance(table, Mapping):
        return [problem_at("table", "is {table}; must be an object", table=shown(table))]
    problems = [
        problem_at(f"table.{key}", "is unknown; give {table}", table=joined(", ", TABLE))
        for key in table
        if key not in TABLE
    ]
    for key, kind in TABLE.items():
        value = table.get(key)
        if key in table and (not isinstance(value, kind) or isinstance(value, bool)):
            problems.append(
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
            problems.append(problem_at(f"table.{key}", "is {value}; must be a row of the file", value=value))
    if "separator" in table and len(str(table["separator"])) != 1:
        problems.append(Problem("table.separator", "must be one character"))
    if table.get("decimal", ".") not in (".", ","):
        problems.append(Problem("table.decimal", "must be . or ,"))
    return problems


def _wrong_columns(columns: Any) -> list[Problem]:
    if not isinstance(columns, list | tuple):
        return [problem_at("columns", "is {columns}; must be a list", columns=shown(columns))]
    problems, seen = [], set()
    for number, column in enumerate(columns, start=1):
        place = f"columns[{number}]"
        if not isinstance(column, Mapping):
            problems.append(
                problem_at(place, "is {column}; must be an object with heading and as", column=shown(column))
            )
            continue
        problems += _wrong_column(place, column)
        meaning = column.get("as")
        if isinstance(meaning, str) and meaning in seen:
            problems.append(
                problem_at(
                    f"{place}.as", "another column is also read as {meaning}; remove one", meaning=shown(meaning)
                )
            )
        seen.add(meaning if isinstance(meaning, str) and meaning else None)
        seen.discard(None)
    return problems


def _wrong_column(place: str, column: Mapping[str, Any]) -> list[Problem]:
    problems = [
        problem_at(f"{place}.{key}", "is unknown; give {column}", column=joined(", ", COLUMN))
        for key in column
        if key not in COLUMN
    ]
    for key, kind in COLUMN.items():
        value = column.get(key)
        if value is not None and not isinstance(value, kind):
            problems.append(problem_at(f"{place}.{key}", "is {value}; must be of another kind", value=shown(value)))
        elif isinstance(value, str) and len(value) > LONGEST:
            problems.append(problem_at(f"{place}.{key}", "is longer than {longest} characters", longest=LONGEST))
    return problems


def _wrong_session(session: Any) -> list[Problem]:
    if not isinstance(session, Mapping):
        return [problem_at("session", "is {session}; must be an object", session=shown(session))]
    extra_keys = [key for key in ("format", "table") if key in session]
    return [Problem(f"session.{key}", "is not given in a mapping; it follows from the file") for key in extra_keys]


def remembered(document: Mapping[str, Any]) -> Json:
    """The mapping for the next file of this layout."""
    session = {key: value for key, value in document.get("session", {}).items() if key not in PER_FILE_FIELDS}
    return {**document, "session": session}
