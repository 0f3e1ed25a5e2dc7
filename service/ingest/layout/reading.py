"""CellKind under a mapping → imu-session/1, in the units of a session, with the place of each cell in the file."""

from collections.abc import Sequence

import numpy as np

from estimator.errors import FormatError, Problem, problem_at
from estimator.message import joined, say
from estimator.reading.problems import Where, shown
from estimator.screening import JUDGED_BY_PARITY, Screening, declined_by
from estimator.session import IN_SERVICE
from service.ingest.layout.cutting import Cell
from service.ingest.layout.grids import Grid, grid_of, is_nothing, number_of
from service.ingest.layout.kinds import is_sensor
from service.ingest.layout.mapping import ColumnMapping, Layout
from service.ingest.layout.pivoting import side_by_side
from service.ingest.layout.times import Before, seconds_of
from service.ingest.layout.vocabulary import conversion, target_label

FORMAT = "imu-session/1"
WORDS = ("run", "position")
EPOCH = 1e8
"""Seconds beyond which a time counts from 1970: 3 years, for which nothing is left switched on."""


def document_of(
    content: bytes, filename: str, layout: Layout, *, part: bool = False
) -> tuple[dict[str, object], Where, Screening]:
    """The session's document, a function from field and row to the cell in the file, and what a log's samples show.
    ``part``: rows that are yet to be measured are left out."""
    declined = declined_by(layout.session.get("screening")) or ()
    if layout.session.get("programme") == IN_SERVICE:
        declined = (*declined, *JUDGED_BY_PARITY, "no-data")
    grid = side_by_side(grid_of(content, filename, layout.table, declined))
    require_own(grid, layout, filename)
    decimal = str(grid.taken.get("decimal", "."))
    mapped_columns = [(k, column) for k, column in enumerate(layout.columns) if column.meaning]
    is_partly = part and layout.session.get("sample_rate_hz") is None
    filled = [k for k, column in mapped_columns if not is_partly or is_sensor(str(column.meaning))]
    rows = [j for j in _kept_rows([grid.columns[k] for k in filled]) if j not in grid.skipped]
    before = Before()
    table = {
        str(c.meaning): read([grid.columns[k][j] for j in rows], c, layout, decimal, before) for k, c in mapped_columns
    }
    places = {str(c.meaning): k for k, c in mapped_columns}

    def where(field: str, row: int | None) -> str:
        if field not in places or not rows:
            return ""
        heading = layout.columns[places[field]].heading
        if row is None:
            return say("column {heading}", heading=shown(heading))
        return grid.place(places[field], rows[min(row, len(rows)) - 1] + 1)

    return {**layout.session, "format": FORMAT, "table": table}, where, grid.screening


def require_own(grid: Grid, layout: Layout, filename: str) -> None:
    """Raises for a mapping of another table, or with units of another quantity."""
    problems = [*_other_columns(grid, layout), *_unit_problems(layout)]
    if problems:
        raise FormatError(problems, filename)


def _kept_rows(columns: Sequence[Sequence[Cell]]) -> list[int]:
    """Rows with a value in any mapped column: an empty line between two runs is none."""
    rows = max(map(len, columns), default=0)
    return [j for j in range(rows) if any(not is_nothing(cells[j]) for cells in columns)]


def _other_columns(grid: Grid, layout: Layout) -> list[Problem]:
    """A mapping applies only to the headings it names."""
    expected = [column.heading for column in layout.columns]
    if list(grid.headings) == expected:
        return []
    missing = [heading for heading in expected if heading not in grid.headings]
    detail = say("; {names} is not among them", names=joined(", ", map(shown, missing[:5]))) if missing else ""
    return [
        problem_at("columns", "are not those of the file{detail}; make a new mapping from its preview", detail=detail)
    ]


def _unit_problems(layout: Layout) -> list[Problem]:
    """Units that cannot be converted to those of the session."""
    return [
        problem_at(
            column.meaning or "",
            "is in {unit}, which cannot be converted to {target_unit}; choose the unit of column {heading}",
            unit=shown(column.unit),
            target_unit=wanted,
            heading=shown(column.heading),
        )
        for column in layout.columns
        if column.meaning
        and conversion(column.unit, wanted := _target_unit(column.meaning, layout) or column.unit) is None
    ]


def _target_unit(meaning: str, layout: Layout) -> str:
    """Unit of a column of the session; of readings the sensor's, empty where it is not stated yet."""
    sensors = layout.session.get("sensors")
    for sensor in sensors if isinstance(sensors, list | tuple) else ():
        if isinstance(sensor, dict) and meaning in (sensor.get("name"), f"{sensor.get('name')}_se"):
            return str(sensor.get("reading_unit") or "")
    return target_label(meaning)


def read(cells: list[Cell], column: ColumnMapping, layout: Layout, decimal: str, before: Before) -> list[Cell]:
    """A column of the session: words by their meaning, numbers in its unit, anything else as written."""
    if column.fill_down:
        cells = _filled_down(cells, before, column.heading)
    if column.meaning in WORDS:
        return [_word(cell, column) for cell in cells]
    numbers = [None if is_nothing(cell) else number_of(cell, decimal) for cell in cells]
    if column.meaning == "time_s" and all(number is None for number in numbers):
        return seconds_of(cells, before)
    start = start_of_time(next((n for n in numbers if n is not None), None), column, layout, before)
    times, over, offset = in_unit(column, layout)
    return [
        (cell if not is_nothing(cell) else None) if n is None else (n - start) * times / over + offset
        for n, cell in zip(numbers, cells, strict=True)
    ]


def in_unit(column: ColumnMapping, layout: Layout) -> tuple[float, float, float]:
    """(times, over, offset) from the unit of a column to that of the session."""
    times, over, offset = conversion(column.unit, _target_unit(column.meaning or "", layout)) or (1.0, 1.0, 0.0)
    return times, over, 0.0 if column.meaning and column.meaning.endswith("_se") else offset


def start_of_time(first: float | None, column: ColumnMapping, layout: Layout, before: Before) -> float:
    """The first time of a column since 1970, in its unit, from which the session counts; 0 of any other column."""
    if column.meaning != "time_s":
        return 0.0
    before.start = first if before.start is None else before.start
    times, over, _ = in_unit(column, layout)
    return before.start if before.start is not None and abs(before.start * times / over) >= EPOCH else 0.0


def _word(cell: Cell, column: ColumnMapping) -> Cell:
    text = word_text(cell)
    if not text:
        return None
    return column.words.get(text) or (cell if column.meaning == "position" else text)


def word_text(cell: Cell) -> str:
    """``1`` for 1.0."""
    if isinstance(cell, float) and cell == np.floor(cell):
        return f"{cell:.0f}"
    return "" if cell is None else str(cell).strip()


def _filled_down(cells: list[Cell], before: Before, heading: str) -> list[Cell]:
    filled: list[Cell] = []
    for cell in cells:
        above = filled[-1] if filled else before.filled.get(heading)
        filled.append(cell if above is None or not is_nothing(cell) else above)
    before.filled[heading] = filled[-1] if filled else None
    return filled
