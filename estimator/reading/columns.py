"""One column of the table, or one vector: values as written → checked array.

A good column costs one pass in C; only a faulty one is looked at cell by cell, to name its rows.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import NoneType

import numpy as np
from numpy.typing import NDArray

from estimator.message import joined, say
from estimator.reading.bounds import COMPONENT, WITHIN
from estimator.reading.fields import NUMBERS, Fields, number_in
from estimator.reading.interval import Interval
from estimator.reading.problems import Problems, shown
from estimator.session import Array

Column = Sequence[object] | Array
"""Cells as written: numbers, texts, None; or all numbers as an array."""
Mask = NDArray[np.bool_]
NO_NUMBER = frozenset(
    ("nan", "-nan", "inf", "-inf", "+inf", "infinity", "na", "n/a", "null", "none", "-", "--", "#n/a")
)
"""Texts that sources write where there is no reading."""


@dataclass(frozen=True)
class Columns:
    """The usable columns of a table: all have ``rows`` values. A stand-in is returned for any that is not usable."""

    values: Mapping[str, Column]
    rows: int
    unusable: frozenset[str]
    """Columns that are there but whose fault is already recorded."""
    problems: Problems

    def has(self, name: str) -> bool:
        """Whether the column is there and states anything."""
        column = self.values.get(name, ())
        return len(column) > 0 and (isinstance(column, np.ndarray) or any(cell is not None for cell in column))

    def report_missing(self, name: str) -> None:
        """Record a column that is not there."""
        if name not in self.unusable:
            self.problems.add(name, "the column is missing; the table needs it, with one value per row")

    def numbers(self, name: str, within: Interval, *, holes: bool = False) -> Array:
        """(R,) numbers in the column's unit; NaN where a cell is empty, a fault unless ``holes`` are allowed."""
        cells = self.values[name]
        array = as_floats(cells)
        if array is None:
            return self._faulty(name, cells, within, holes)
        good = within.held_by(array)
        if holes and not good.all():
            good |= empty(cells)
        if not good.all():
            return self._faulty(name, cells, within, holes)
        return array

    def samples(self, name: str, within: Interval) -> Array:
        """(R,) readings of a raw log in their unit; NaN where a cell states none, or no number that one could be."""
        cells = self.values[name]
        array = as_floats(cells)
        if array is None:
            plain = [None if isinstance(cell, str) and cell.strip().casefold() in NO_NUMBER else cell for cell in cells]
            array = as_floats(plain)
        if array is None:
            return self._faulty(name, plain, within, holes=True)
        good = within.held_by(array)
        return array if good.all() else np.where(good, array, np.nan)

    def words(self, name: str, allowed: tuple[str, ...]) -> NDArray[np.int64]:
        """(R,) index into the allowed words."""
        cells = self.values[name]
        index = {word: k for k, word in enumerate(allowed)}
        try:
            return np.array([index[cell] for cell in cells], dtype=np.int64)  # type: ignore[index]
        except (KeyError, TypeError):
            bad = [j for j, cell in enumerate(cells) if not (isinstance(cell, str) and cell in index)]
            message = say("give {columns}", columns=joined(" or ", allowed))
            self.problems.add_rows(
                name,
                bad,
                lambda j: say("{cells}; {message}", cells=_described(cells[j]), message=message),
                count=self.rows,
            )
            return np.zeros(self.rows, dtype=np.int64)

    def labels(self, name: str) -> NDArray[np.int64]:
        """(R,) labels: whole numbers as they are, texts by first appearance, −1 for an empty cell."""
        if (numbered := _numbered(self.values[name])) is not None:
            return numbered
        cells = [_label(cell) for cell in self.values[name]]
        bad = [j for j, cell in enumerate(cells) if isinstance(cell, _Bad)]
        message = "must be a whole number from 0, a name, or -1 or empty where the row belongs to no position"
        self.problems.add_rows(
            name,
            bad,
            lambda j: say("{j}; {message}", j=_described(self.values[name][j]), message=message),
            count=self.rows,
        )
        if bad:
            return np.arange(self.rows)
        if not any(isinstance(cell, str) for cell in cells):
            return np.array(cells, dtype=np.int64)
        order = {cell: k for k, cell in enumerate(dict.fromkeys(str(c) for c in cells if c != -1))}
        return np.array([order.get(str(cell), -1) for cell in cells], dtype=np.int64)

    def _faulty(self, name: str, cells: Column, within: Interval, holes: bool) -> Array:
        faults = {j: fault for j, cell in enumerate(cells) if (fault := _cell_fault(cell, within, holes))}
        self.problems.add_rows(name, faults, faults.__getitem__, count=self.rows)
        return np.full(self.rows, np.nan)


class _Bad:
    """A cell that is no label."""


def vector(fields: Fields, key: str, advice: str, within: Interval = COMPONENT) -> Array:
    """(3,) vector under a key, dimensionless unless ``within`` has a unit; NaN stands in for a bad one."""
    value = fields.values.get(key)
    stand_in = np.full(3, np.nan)
    if value is None:
        fields.add(key, "missing; {advice}", advice=advice)
        return stand_in
    components = value.tolist() if isinstance(value, np.ndarray) else value
    if not isinstance(components, list | tuple) or len(components) != 3:
        fields.add(key, "is {components}; {advice}", components=shown(components), advice=advice)
        return stand_in
    read = [number_in(component, within) for component in components]
    for number, (_, fault) in enumerate(read, start=1):
        if fault:
            fields.add(f"{key}[{number}]", fault)
    return np.array([np.nan if component is None else component for component, _ in read])


def as_floats(cells: Column) -> Array | None:
    """(R,) the cells as floats, in the column's unit, NaN for empty ones; None when any cell is not a number."""
    if isinstance(cells, np.ndarray):
        return cells.astype(np.float64) if cells.dtype.kind in "fiu" else None
    kinds = set(map(type, cells))
    if bool in kinds or not all(issubclass(kind, (*NUMBERS, NoneType)) for kind in kinds):
        return None
    try:
        return np.array(cells, dtype=np.float64)
    except (OverflowError, ValueError, TypeError):
        return None


def empty(cells: Column) -> Mask:
    """(R,) cells that state nothing: null, or NaN in an array, which has no null."""
    if isinstance(cells, np.ndarray):
        return np.isnan(cells)
    return np.array([cell is None for cell in cells], dtype=bool)


def _cell_fault(cell: object, within: Interval, holes: bool) -> str:
    if cell is None:
        return "" if holes else "is missing; every row of this column needs a value"
    return number_in(cell, within)[1]


def _described(cell: object) -> str:
    return "is missing" if cell is None else say("is {cell}", cell=shown(cell))


def _numbered(cells: Column) -> NDArray[np.int64] | None:
    """(R,) whole-number labels in one pass; None when any cell is something else."""
    array = as_floats(cells)
    if array is None:
        return None
    array[empty(cells)] = -1
    if not (WITHIN["position"].held_by(array) & (array == np.floor(array))).all():
        return None
    return array.astype(np.int64)


def _label(cell: object) -> int | str | _Bad:
    if cell is None or cell == "":
        return -1
    if isinstance(cell, str):
        try:
            number = float(cell)
        except ValueError:
            return cell
        return _label(number) if math.isfinite(number) else cell
    label, _ = number_in(cell, WITHIN["position"])
    return _Bad() if label is None or label % 1 else int(label)
