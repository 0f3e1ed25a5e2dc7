"""The register as a table: read from CSV, with every fault by its row and column.

Separators are counted before the table is cut, and it is cut row by row: what it may hold is known from its bytes.
"""

import csv
import io
import re
from collections.abc import Mapping, Sequence
from itertools import islice

from estimator.errors import Problem, problem_at
from estimator.message import joined, say, say_count
from service.errors import RefusedError
from service.ingest.names import plain_name
from service.kit.printable import printable
from service.kit.text import fault_of_text, with_plain_ends
from service.units.records import NewEntry

COLUMNS = ("serial", "unit_type", "owner", "location", "custodian", "note")
"""Possible columns of a table; the first is required."""
LEFT = ("retired_on",)
"""Columns of an export that an import leaves as they are."""
MOST_ROWS = 2_000
MOST_COLUMNS = 50
"""So many that a table may have others beside those of the register, which are named in its refusal."""
MOST_CELLS = MOST_ROWS * MOST_COLUMNS
MOST_PROBLEMS = 500
"""Problems that a refusal names; nobody mends more before trying again."""
LONGEST = {"note": 2000}
SHORT = 200
"""Characters of any other field."""
SEPARATORS = ",;\t"
QUOTED = re.compile(r"(^|;)'(?=[=+\-@])")
"""How an export writes what a spreadsheet would take for a formula."""


def read_register(content: bytes, filename: str) -> tuple[NewEntry, ...]:
    """The units of a table; RefusedError with every problem where it cannot be used."""
    headings, rows = _table(content, filename)
    problems = [*_of_columns(headings), *_of_rows(headings, rows)]
    if not rows:
        problems = [Problem("file", "has no rows below its headings")]
    if problems:
        raise _refused(filename, problems)
    stated = [dict(zip(headings, row, strict=False)) for row in rows]
    return tuple(NewEntry(**{name: _cell(row[name]) for name in COLUMNS if name in row}) for row in stated)


def _table(content: bytes, filename: str) -> tuple[list[str], list[list[str]]]:
    """Headings and rows."""
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as fault:
        raise _refused(filename, [Problem("file", "is not UTF-8 text; save it as CSV UTF-8")]) from fault
    separator = max(SEPARATORS, key=text.partition("\n")[0].count)
    if text.count(separator) > MOST_CELLS:
        raise _refused(filename, [problem_at("file", "has more than {most} cells; split it", most=MOST_CELLS)])
    lines = (row for row in csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True) if any(row))
    try:
        headings, rows = [name.strip().lower() for name in next(lines, [])], list(islice(lines, MOST_ROWS + 1))
    except csv.Error as fault:
        raise _refused(filename, [problem_at("file", "cannot be read as a table: {fault}", fault=fault)]) from fault
    if len(headings) > MOST_COLUMNS:
        detail = problem_at("file", "has more than {most} columns; keep those of the register", most=MOST_COLUMNS)
        raise _refused(filename, [detail])
    if len(set(headings)) < len(headings):
        raise _refused(filename, [Problem("file", "has two columns of one name; keep one of them")])
    if len(rows) > MOST_ROWS:
        raise _refused(filename, [problem_at("file", "has more than {most} rows; split it", most=MOST_ROWS)])
    return headings, rows


def _of_columns(headings: Sequence[str]) -> list[Problem]:
    found = [problem_at(name, "is no column of the register; it has {columns}", columns=joined(", ", COLUMNS))
             for name in headings if name not in (*COLUMNS, *LEFT)]  # fmt: skip
    if "serial" not in headings:
        found.append(Problem("serial", "is missing: one column names the units"))
    return found


def _of_rows(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> list[Problem]:
    found, seen = [], dict[str, int]()
    for number, cells in enumerate(rows, 1):
        row = dict(zip(headings, cells, strict=False))
        if len(cells) > len(headings):
            found.append(Problem("file", "has more cells in this row than headings", number))
        found += _of_row(row, number)
        serial = _cell(row.get("serial", ""))
        if serial in seen and serial:
            found.append(
                problem_at("serial", "{serial} stands in row {row} too", number, serial=serial, row=seen[serial])
            )
        seen.setdefault(serial, number)
    return found


def _of_row(row: Mapping[str, str], number: int) -> list[Problem]:
    found = []
    for name in COLUMNS:
        text, longest = row.get(name, ""), LONGEST.get(name, SHORT)
        if len(_cell(text)) > longest:
            found.append(problem_at(name, "is longer than {longest} characters", number, longest=longest))
        if fault := fault_of_text(with_plain_ends(text)):
            found.append(Problem(name, fault, number))
    return found


def _cell(value: str) -> str:
    return QUOTED.sub(r"\1", plain_name(value))


def _refused(filename: str, problems: Sequence[Problem]) -> RefusedError:
    count = "one problem" if len(problems) == 1 else say("{number} problems", number=len(problems))
    detail = say("{name} cannot be used: {count}. Nothing was stored.", name=printable(filename), count=count)
    return RefusedError(detail, named(problems))


def named(problems: Sequence[Problem]) -> tuple[Problem, ...]:
    """The first problems, and how many more there are."""
    more = len(problems) - MOST_PROBLEMS
    rest = (Problem("file", say_count("{n} more problem", "{n} more problems", more)),) if more > 0 else ()
    return (*problems[:MOST_PROBLEMS], *rest)
