"""The register as a table: read from CSV, with every fault by its row and column."""

from collections.abc import Sequence
from typing import Any

from estimator.errors import Problem, problem_at
from estimator.message import joined, say
from service.errors import RefusedError
from service.ingest.names import plain_name
from service.kit.libraries import pl
from service.kit.printable import printable
from service.units.records import NewEntry

COLUMNS = ("serial", "unit_type", "owner", "location", "custodian", "note")
"""Possible columns of a table; the first is required."""
LEFT = ("retired_on",)
"""Columns of an export that an import leaves as they are."""
MOST_ROWS = 2_000
"""Most rows of a table; more would hold up everybody who writes."""
LONGEST = {"note": 2000}
SHORT = 200
"""Characters of any other field."""
SEPARATORS = ",;\t"
QUOTED = ("'=", "'+", "'-", "'@")
"""Beginnings by which an export protects text that a spreadsheet would take for a formula."""


def read_register(content: bytes, filename: str) -> tuple[NewEntry, ...]:
    """The units of a table; RefusedError with every problem where it cannot be used."""
    rows = _rows(content, filename)
    problems = [*_of_columns(rows[0] if rows else {}), *_of_rows(rows)]
    if not rows:
        problems = [Problem("file", "has no rows below its headings")]
    if problems:
        raise _refused(filename, problems)
    return tuple(NewEntry(**{name: _cell(row[name]) for name in COLUMNS if name in row}) for row in rows)


def _rows(content: bytes, filename: str) -> list[dict[str, Any]]:
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as fault:
        raise _refused(filename, [Problem("file", "is not UTF-8 text; save it as CSV UTF-8")]) from fault
    head = text.partition("\n")[0]
    separator = max(SEPARATORS, key=head.count)
    try:
        table = pl.read_csv(text.encode(), separator=separator, infer_schema=False)
        table = table.rename(lambda name: name.strip().lower())
    except pl.exceptions.DuplicateError as fault:
        raise _refused(filename, [Problem("file", "has two columns of one name; keep one of them")]) from fault
    except pl.exceptions.PolarsError as fault:
        detail = say("cannot be read as a table: {fault}", fault=printable(str(fault).partition("\n")[0]))
        raise _refused(filename, [Problem("file", detail)]) from fault
    if table.height > MOST_ROWS:
        raise _refused(filename, [problem_at("file", "has more than {most} rows; split it", most=MOST_ROWS)])
    return table.to_dicts()


def _of_columns(first: dict[str, Any]) -> list[Problem]:
    found = [problem_at(name, "is no column of the register; it has {columns}", columns=joined(", ", COLUMNS))
             for name in first if name not in (*COLUMNS, *LEFT)]  # fmt: skip
    if first and "serial" not in first:
        found.append(Problem("serial", "is missing: one column names the units"))
    return found


def _of_rows(rows: Sequence[dict[str, Any]]) -> list[Problem]:
    found, seen = [], dict[str, int]()
    for number, row in enumerate(rows, 1):
        for name in COLUMNS:
            longest = LONGEST.get(name, SHORT)
            if len(_cell(row.get(name))) > longest:
                found.append(problem_at(name, "is longer than {longest} characters", number, longest=longest))
            if "\x00" in _cell(row.get(name)):
                found.append(Problem(name, "contains a character that cannot be stored", number))
        serial = _cell(row.get("serial"))
        if serial in seen and serial:
            found.append(
                problem_at("serial", "{serial} stands in row {row} too", number, serial=serial, row=seen[serial])
            )
        seen.setdefault(serial, number)
    return found


def _cell(value: object) -> str:
    text = plain_name(str(value or ""))
    return text[1:] if text.startswith(QUOTED) else text


def _refused(filename: str, problems: Sequence[Problem]) -> RefusedError:
    count = "one problem" if len(problems) == 1 else say("{number} problems", number=len(problems))
    detail = say("{name} cannot be used: {count}. Nothing was stored.", name=printable(filename), count=count)
    return RefusedError(detail, tuple(problems))
