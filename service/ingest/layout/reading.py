"""CellKind under a mapping → imu-session/1, in the units of a session, with the place of each cell in the file."""

import re
from collections.abc import Callable, Sequence
from datetime import datetime

import numpy as np

from estimator.errors import FormatError, Problem, problem_at
from estimator.message import joined, say
from estimator.reading.problems import Where, shown
from estimator.screening import JUDGED_BY_PARITY, Screening, declined_by
from estimator.session import IN_SERVICE
from service.ingest.layout.cutting import Cell
from service.ingest.layout.grids import Grid, grid_of, is_nothing, number_of
from service.ingest.layout.mapping import ColumnMapping, Layout
from service.ingest.layout.vocabulary import conversion, target_label

FORMAT = "imu-session/1"
WORDS = ("run", "position")
CLOCK = re.compile(
    r"^(?:\d{1,4}/\d{1,2}/\d{1,4}[ T]+)?(?:(?P<h>\d{1,2}):)?(?P<m>\d{1,2}):(?P<s>\d{1,2}(?:[.,]\d+)?)"
    r"(?: ?(?P<half>[AaPp])\.?[Mm]\.?)?$"
)
"""A time of day, or minutes and seconds; a date with strokes may be before it, in any order."""
NOON = 12
EPOCH = 1e8
"""Seconds beyond which a time counts from 1970: 3 years, for which nothing is left switched on."""
DAY = 86_400.0
"""Seconds in a day."""


def document_of(content: bytes, filename: str, layout: Layout) -> tuple[dict[str, object], Where, Screening]:
    """The session's document, a function from field and row to the cell in the file, and what a log's samples show."""
    declined = declined_by(layout.session.get("screening")) or ()
    if layout.session.get("programme") == IN_SERVICE:
        declined = (*declined, *JUDGED_BY_PARITY, "no-data")
    grid = grid_of(content, filename, layout.table, declined)
    problems = [*_other_columns(grid, layout), *_unit_problems(layout)]
    if problems:
        raise FormatError(problems, filename)
    decimal = str(grid.taken.get("decimal", "."))
    mapped_columns = [(k, column) for k, column in enumerate(layout.columns) if column.meaning]
    rows = [j for j in _kept_rows([grid.columns[k] for k, _ in mapped_columns]) if j not in grid.skipped]
    table = {str(c.meaning): _read([grid.columns[k][j] for j in rows], c, layout, decimal) for k, c in mapped_columns}
    places = {str(c.meaning): k for k, c in mapped_columns}

    def where(field: str, row: int | None) -> str:
        if field not in places or not rows:
            return ""
        heading = layout.columns[places[field]].heading
        if row is None:
            return say("column {heading}", heading=shown(heading))
        return grid.place(places[field], rows[min(row, len(rows)) - 1] + 1)

    return {**layout.session, "format": FORMAT, "table": table}, where, grid.screening


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


def _read(cells: list[Cell], column: ColumnMapping, layout: Layout, decimal: str) -> object:
    """A column of the session: words by their meaning, numbers in its unit, anything else as written."""
    if column.fill_down:
        cells = _filled_down(cells)
    if column.meaning in WORDS:
        return [_word(cell, column) for cell in cells]
    numbers = [None if is_nothing(cell) else number_of(cell, decimal) for cell in cells]
    if column.meaning == "time_s" and all(number is None for number in numbers):
        return seconds_of(cells)
    convert = _in_unit(column, layout)
    if column.meaning == "time_s" and (start := next((n for n in numbers if n is not None), 0.0)) and convert(start):
        numbers = _from_epoch(numbers, convert(start) or 0.0, start)
    return [cell if n is None and not is_nothing(cell) else convert(n) for n, cell in zip(numbers, cells, strict=True)]


def _in_unit(column: ColumnMapping, layout: Layout) -> Callable[[float | None], float | None]:
    target = _target_unit(column.meaning or "", layout)
    times, over, offset = conversion(column.unit, target) or (1.0, 1.0, 0.0)
    if column.meaning and column.meaning.endswith("_se"):
        offset = 0.0
    return lambda number: None if number is None else number * times / over + offset


def _from_epoch(numbers: list[float | None], seconds: float, start: float) -> list[float | None]:
    """Times since 1970, of which the first is at so many seconds, from the first on; others unchanged."""
    if abs(seconds) < EPOCH:
        return numbers
    return [None if number is None else number - start for number in numbers]


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


def _filled_down(cells: list[Cell]) -> list[Cell]:
    filled: list[Cell] = []
    for cell in cells:
        filled.append(filled[-1] if is_nothing(cell) and filled else cell)
    return filled


def seconds_of(cells: Sequence[Cell]) -> list[Cell]:
    """Dates and times of day as seconds since the first; anything else unchanged."""
    seconds = [_seconds(cell) for cell in cells]
    start = next((s for s in seconds if s is not None), 0.0)
    times: list[Cell] = []
    days, last = 0.0, start
    for cell, second in zip(cells, seconds, strict=True):
        if second is None:
            times.append(cell)
            continue
        days += DAY if second < DAY and second + days < last - DAY / 2 else 0.0
        last = second + days
        times.append(last - start)
    return times


def _seconds(cell: Cell) -> float | None:
    """Seconds since midnight, or since 1970 with a date."""
    text = str(cell or "").strip()
    if match := CLOCK.match(text):
        hours = int(match["h"] or 0) % (NOON if match["half"] else 24) + NOON * ((match["half"] or "").lower() == "p")
        return 3600 * hours + 60 * int(match["m"]) + float(match["s"].replace(",", "."))
    for form in ("%d.%m.%Y %H:%M:%S.%f", "%d.%m.%Y %H:%M:%S", "%d.%m.%Y %H:%M"):
        try:
            return (datetime.strptime(text, form) - datetime(1970, 1, 1)).total_seconds()
        except ValueError:
            continue
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        return None
    return (moment.replace(tzinfo=None) - datetime(1970, 1, 1)).total_seconds()
