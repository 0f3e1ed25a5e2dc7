"""Every fault of one session file, collected so that all are reported at once."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from estimator.errors import FormatError, Problem, ScheduleError
from estimator.message import say, say_count


@dataclass(frozen=True)
class Extent:
    """The most that a file may hold. As they stand: what fits into a text of the largest size (`source`)."""

    rows: int = 10**7
    columns: int = 10**4
    """The readings and standard errors of `sensors.MOST` sensors, and others five times as many."""
    cells: int = 10**8
    """Rows × columns."""
    nesting: int = 32
    """Lists and objects of JSON within each other; a session has four."""


ROWS_SHOWN = 5
"""Faulty rows of one column that are named one by one; the others are counted. A fault of every row is one."""
PROBLEMS_SHOWN = 500
"""Faults that are named in all; nobody mends more before trying again."""
Where = Callable[[str, int | None], str]
"""Field and row → where that stands in the file, such as ``cell C7 of the sheet readings``; empty where unknown."""
LONGEST_TEXT = 60
"""Characters of a value that a message quotes."""


class Problems:
    """Collects the faults of one file.

    A reader that records a fault returns a stand-in value and goes on; no session is built while there are faults.
    """

    def __init__(
        self,
        source: str | None,
        most: Extent | None = None,
        where: Where | None = None,
        rows_before: int | None = None,
    ) -> None:
        self.source = None if source is None else printable(source)
        self.most = most or Extent()
        """Limits on the size of the file; more is a fault."""
        self.lines_before_table: int | None = None
        """Set for CSV: row r of the table is line r + this of the file."""
        self._where = where
        self._rows_before = rows_before
        self._found: list[Problem] = []
        self._unsaid = 0
        self._only_schedule = True

    def add(self, field: str, message: str, row: int | None = None, /, **parts: object) -> None:
        """Record one fault, a sentence or the template of one with its ``parts``; ``row`` counts from 1."""
        self._only_schedule = False
        self._record(field, say(message, **parts) if parts else message, row)

    def add_to_schedule(self, field: str, message: str, /, **parts: object) -> None:
        """Record that the rows, though well formed, cannot support the programme."""
        self._record(field, say(message, **parts) if parts else message, None)

    def add_rows(
        self, field: str, rows: Iterable[int], message: Callable[[int], str], *, count: int | None = None
    ) -> None:
        """Record the same kind of fault in several rows of ``count``; they count from 0 here, as for the message."""
        faulty = list(rows)
        if count is not None and self._rows_before is None and len(faulty) == count > ROWS_SHOWN:
            self.add(field, say("all {of} rows have this fault; the first {message}", of=count, message=message(0)))
            return
        for index in faulty[:ROWS_SHOWN]:
            self.add(field, message(index), index + 1)
        if more := len(faulty[ROWS_SHOWN:]):
            last = faulty[-1] + 1 + (self._rows_before or 0)
            said = say_count(
                "{n} more row has this fault, up to row {faulty}",
                "{n} more rows have this fault, up to row {faulty}",
                more,
                faulty=last,
            )
            checked = say("{fault}; no later row was checked", fault=said)
            self.add(field, said if self._rows_before is None else checked)

    def fail(self, field: str, message: str, /, **parts: object) -> FormatError:
        """The error to raise when nothing more can be read; holds what was found before, too."""
        self.add(field, message, **parts)
        return FormatError(self._all(), self.source)

    def raise_if_any(self) -> None:
        """Raise what was found, if anything was."""
        if self._found:
            raise (ScheduleError if self._only_schedule else FormatError)(self._all(), self.source)

    def _record(self, field: str, message: str, row: int | None) -> None:
        if len(self._found) >= PROBLEMS_SHOWN:
            self._unsaid += 1
            return
        row = row and row + (self._rows_before or 0)
        if row is not None and self.lines_before_table is not None:
            message = say("{message} (line {row} of the file)", message=message, row=row + self.lines_before_table)
        if self._where is not None and (place := self._where(field, row)):
            message = say("{message} ({place})", message=message, place=place)
        self._found.append(Problem(printable(field), printable(message), row))

    def _all(self) -> list[Problem]:
        unsaid = self._unsaid
        more = [Problem("file", say_count("{n} more problem", "{n} more problems", unsaid))] if unsaid else []
        return self._found + more


def printable(text: str) -> str:
    """The text with anything that cannot be shown or stored written as an escape, and cut when very long."""
    text = text if len(text) <= 1000 else text[:1000] + "…"
    return text if text.isprintable() else "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def shown(value: object) -> str:
    """A value as people would write it in a message; never long, whatever the value."""
    match value:
        case None:
            return "null"
        case bool():
            return str(value).lower()
        case str():
            return f"'{cut(value)}'"
        case int() if value.bit_length() > 100:
            return say("an integer of {value} bits", value=value.bit_length())
        case int() | float():
            return f"{value:.10g}" if isinstance(value, float) else str(value)
        case list() | tuple():
            return say("a list of {value}", value=len(value))
        case dict():
            return "an object"
        case _:
            return f"a {type(value).__name__}"


def cut(text: str) -> str:
    """The text, or its beginning when it is long."""
    return text if len(text) <= LONGEST_TEXT else text[:LONGEST_TEXT] + "…"
