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
from service.ingest.layout.kinds import is_sensor
from service.ingest.layout.mapping import ColumnMapping, Layout
from service.ingest.layout.pivoting import side_by_side
from service.ingest.layout.vocabulary import conversion, target_label

FORMAT = "imu-session/1"
WORDS = ("run", "position")
CLOCK = re.compile(
    r"^(?:\d{1,4}/\d{1,2}/\d{1,4}[ T]+)?(?:(?P<h>\d{1,2}):)?(?P<m>\d{1,2}):(?P<s>\d{1,2}(?:[.,]\d+)?)"
    r"(?: ?(?P<half>[AaPp])\.?[Mm]\.?)?$"
)
"""A time of day, or minutes and seconds; a date with strokes may be before it, in any order."""
BEFORE_ZONE = re.compile(r" (?=[+\-]\d\d:?\d\d$)")
READERS_OF_TIMES: tuple[Callable[[str], datetime], ...] = (
    lambda text: datetime.fromisoformat(BEFORE_ZONE.sub("", text)),
    *(
        lambda text, form=form: datetime.strptime(text, form)
        for form in ("%d.%m.%Y %H:%M:%S.%f", "%d.%m.%Y %H:%M:%S", "%d.%m.%Y %H:%M", "%d-%b-%Y %H:%M:%S.%f")
    ),
)
"""Readers of dates with times, the quickest first."""
NOON = 12
EPOCH = 1e8
"""Seconds beyond which a time counts from 1970: 3 years, for which nothing is left switched on."""
DAY = 86_400.0
"""Seconds in a day."""


class Before:
    """The rows before those that are read, as far as these depend on them."""

    def __init__(self) -> None:
        self.filled: dict[str, Cell] = {}
        """Last cell of the columns that are filled down."""
        self.start: float | None = None
        """The first time."""
        self.days, self.last = 0.0, 0.0
        """Seconds of the days that have passed at midnights, and of the last time of day."""


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


def seconds_of(cells: Sequence[Cell], before: Before | None = None) -> list[Cell]:
    """Dates and times of day as seconds since the first; anything else unchanged."""
    before, times = before or Before(), list[Cell]()
    for cell in cells:
        second = _seconds(cell)
        if second is None:
            times.append(cell)
            continue
        before.start = second if before.start is None else before.start
        before.days += DAY if second < DAY and second + before.days < before.last - DAY / 2 else 0.0
        before.last = second + before.days
        times.append(before.last - before.start)
    return times


def _seconds(cell: Cell) -> float | None:
    """Seconds since midnight, or since 1970 with a date."""
    text = str(cell or "").strip()
    if match := CLOCK.match(text):
        hours = int(match["h"] or 0) % (NOON if match["half"] else 24) + NOON * ((match["half"] or "").lower() == "p")
        return 3600 * hours + 60 * int(match["m"]) + float(match["s"].replace(",", "."))
    moment = moment_of(text)
    return None if moment is None else (moment.replace(tzinfo=None) - datetime(1970, 1, 1)).total_seconds()


def moment_of(text: str) -> datetime | None:
    """The date and time in a text; None where there is no date."""
    for read_moment in READERS_OF_TIMES:
        try:
            return read_moment(text)
        except ValueError:
            continue
    return None
