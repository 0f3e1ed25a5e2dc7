"""Numbers of units due in each period, and the lines of the list."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime

from service.fleet.condition import UnitSummary
from service.fleet.use import Use
from service.judging.records import Usable
from service.kit.answer import answer
from service.kit.copying import copied
from service.kit.measures import month_of
from service.pages.due.view import OVERDUE, UNKNOWN, month_after, month_begin
from service.sessions.words.conditions import condition_of

MONTHS = 12
"""Months that are counted even where nothing is due, this one included."""


@answer
@dataclass(frozen=True)
class DueCount:
    """Number of units due in one period."""

    when: str
    """`overdue`, a month such as `2026-12`, or `unknown` where no date is known."""
    units: int
    """Number of units."""


@answer
@dataclass(frozen=True)
class DueLine:
    """One unit of the due list."""

    unit: str
    """Serial number."""
    unit_type: str
    """Name of its type."""
    location: str
    """Location of the unit."""
    custodian: str
    """Custodian of the unit."""
    owner: str
    """Owner of the unit."""
    due: datetime | None
    """Due date of its next calibration, UTC; null where that is not known."""
    days: int | None
    """Whole days until then; negative where it is overdue."""
    condition: str
    """Condition by its latest session, in words."""
    usable: bool
    """Whether it may be used now."""
    answer: Use
    """Answer, which distinguishes a reservation and a pending result."""
    use: str
    """The answer in words, with the action."""
    why: str
    """Reason for the date, or for having none."""


def due_counts(dates: Iterable[datetime | None], now: datetime) -> tuple[DueCount, ...]:
    """The number of units in each period: overdue, this month and the next ones, later ones where something is due, no
    date.
    """
    found = Counter(period(due, now) for due in dates)
    months, start = [], month_begin(now)
    for _ in range(MONTHS):
        months.append(f"{start:%Y-%m}")
        start = month_after(start)
    later = sorted(key for key in found if key not in (OVERDUE, UNKNOWN, *months))
    return tuple(DueCount(key, found[key]) for key in (OVERDUE, *months, *later, UNKNOWN))


def period(due: datetime | None, now: datetime) -> str:
    """The period of a due date."""
    if due is None:
        return UNKNOWN
    return OVERDUE if due < now else f"{due:%Y-%m}"


def period_in_words(when: str) -> str:
    """``Overdue``, ``Dec 2026``."""
    words = {OVERDUE: "Overdue", UNKNOWN: "No date"}
    return words.get(when) or month_of(datetime.strptime(when, "%Y-%m"))


def due_lines(units: Sequence[UnitSummary], uses: dict[str, Usable]) -> tuple[DueLine, ...]:
    """The lines of units, in their order; the dates are those of the calendar of due dates."""
    return tuple(_line(unit, uses[unit.serial]) for unit in units)


def _line(unit: UnitSummary, use: Usable) -> DueLine:
    return copied(
        DueLine,
        unit,
        unit=unit.serial,
        due=use.until,
        days=None if use.until is None else (use.until - use.as_of).days,
        condition=condition_of(unit.verdict, is_reference=unit.is_reference).word,
        usable=use.usable,
        answer=use.answer,
        use=use.use,
        why=use.due_reason or ("" if use.until else use.why),
    )
