"""The shape of the table: which columns it has, that they are equally long, and that none is unknown by mistake."""

import re
from collections import Counter
from collections.abc import Mapping
from itertools import islice

import numpy as np

from estimator.message import say
from estimator.reading.columns import Column, Columns
from estimator.reading.fields import Fields
from estimator.reading.keys import COLUMNS, UNKNOWN_LOOKED_AT, meant_key
from estimator.reading.problems import Problems, shown
from estimator.wording import counted

SENSOR_LIKE = re.compile(r"(a|g|w|acc|accel|gyr|gyro)?[ _]?([xyz]|\d{1,3})", re.IGNORECASE)
"""Names that people give to sensors: a1, gx, acc_3."""


def read_columns(document: Fields) -> Columns | None:
    """The columns that hold one value a row; records the others. None when there is no table to speak of."""
    problems = document.problems
    table = document.values.get("table")
    if not isinstance(table, Mapping):
        problem = "missing" if table is None else say("is {table}", table=shown(table))
        document.add("table", "{problem}; give the columns of readings, each with one value per row", problem=problem)
        return None
    check_extent(0, len(table), problems)
    given = {str(name): cells for name, cells in table.items() if cells is not None}
    lists = {name: cells for name, cells in given.items() if _is_column(cells)}
    for name in (name for name in given if name not in lists):
        problems.add(name, "is {value}; must be a list with one value per row", value=shown(given[name]))
    rows = _row_count(lists, problems)
    if rows == 0:
        return None
    good = {name: cells for name, cells in lists.items() if len(cells) == rows}
    return Columns(good, rows, frozenset(given) - frozenset(good), problems)


def check_extent(rows: int, columns: int, problems: Problems) -> None:
    """Raises FormatError where a table of this size is too large."""
    most, advice = problems.most, "can be read: average or split it"
    if rows > most.rows:
        raise problems.fail(
            "table", "has {rows} rows; at most {limit} {advice}", rows=rows, limit=most.rows, advice=advice
        )
    if columns > most.columns:
        raise problems.fail(
            "table", "has {columns} columns; at most {limit} can be read", columns=columns, limit=most.columns
        )
    if rows * columns > most.cells:
        raise problems.fail(
            "table",
            "has {rows} rows × {columns} columns; at most {cells} cells {advice}",
            rows=rows,
            columns=columns,
            cells=most.cells,
            advice=advice,
        )


def check_unknown(columns: Columns, names: list[str]) -> None:
    """Record columns that look like a known column or like the readings of a sensor that is not declared."""
    known = {*COLUMNS, *names, *(f"{name}_se" for name in names)}
    patterns = {_pattern(name) for name in names}
    unknown = (name for name in columns.values if name not in known)
    for name in islice(unknown, UNKNOWN_LOOKED_AT):
        if _pattern(name.removesuffix("_se")) in patterns or SENSOR_LIKE.fullmatch(name) or name.endswith("_se"):
            columns.problems.add(name, "belongs to no declared sensor; declare it in sensors or remove the column")
        elif meant := meant_key(name, COLUMNS):
            columns.problems.add(name, "is not a column of the table; {suggestion}", suggestion=meant)


def _row_count(lists: Mapping[str, Column], problems: Problems) -> int:
    """The number of rows that most columns have; 0 when there are none."""
    lengths = Counter(map(len, lists.values()))
    longest = max(lengths, default=0)
    check_extent(longest, len(lists), problems)
    rows = max(lengths, key=lambda length: (lengths[length], length), default=0)
    if rows == 0:
        problems.add("table", "has no rows; give one row per reading")
        return 0
    for name, cells in lists.items():
        if len(cells) != rows:
            held = counted(len(cells), "value")
            problems.add(
                name, "has {values} where the other columns have {rows}; give one per row", values=held, rows=rows
            )
    return rows


def _is_column(cells: object) -> bool:
    return isinstance(cells, list | tuple) or (isinstance(cells, np.ndarray) and cells.ndim == 1)


def _pattern(name: str) -> str:
    """A name with its digits masked and its case forgotten: A1, a2 and A03 look alike."""
    return re.sub(r"\d+", "#", name.strip().casefold())
