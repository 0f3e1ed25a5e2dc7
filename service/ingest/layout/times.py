"""Dates and times of day in cells → seconds."""

import re
from collections.abc import Callable, Sequence
from datetime import datetime

from service.ingest.layout.cutting import Cell

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
