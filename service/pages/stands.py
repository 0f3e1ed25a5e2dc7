"""The pages of stands: may each be used today, what its units show of it, and what was measured on it."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from service.pages.accepted_causes import AcceptedCause, accepted_causes
from service.pages.flags import FlagCard, flag_cards
from service.pages.fleet import FleetRow, flags_in_words, fleet_row
from service.pages.group import GroupSection
from service.pages.session_lines import SessionLine, session_lines
from service.records.paper import StandCertificate
from service.records.stand import StandCondition, StandEvidence, StandUse
from service.views.stand_report import MOST, StandLine, StandReport
from service.words.names import day_of
from service.words.stand_use import WORDS, StandWord, certificate_in_words, condition_in_words, held, stand_word
from service.words.stands import kind_of_shift, scatter_of, size_of_shift


@dataclass(frozen=True)
class StandRow:
    """One stand in the list."""

    use: StandUse
    word: StandWord
    condition: str
    certificate: str
    """Until when sessions are traceable, as a cell of a table."""
    flags: str


@dataclass(frozen=True)
class StandsPage:
    """Everything the list of stands shows."""

    rows: tuple[StandRow, ...]
    """What needs a hand first, then by name."""


@dataclass(frozen=True)
class ShiftRow:
    """What the units say of one quantity of the stand: a shift, or that there is none."""

    what: str
    size: str
    when: str
    units: str
    word: str
    tone: str


@dataclass(frozen=True)
class StandPage:
    """Everything the page of one stand shows; of what is listed, one more would be on a page of its own."""

    use: StandUse
    word: StandWord
    reasons: tuple[str, ...]
    certificates: tuple[tuple[str, str, str, str], ...]
    """Number, issued by, issued on, valid until; the latest first."""
    flags: tuple[FlagCard, ...]
    shifts: tuple[ShiftRow, ...]
    seating: tuple[tuple[str, str], ...]
    """Quantity, and its scatter from one mounting to the next."""
    unreadable: tuple[str, ...]
    """Sessions that tell nothing of the stand, because what is stored of them cannot be used."""
    units: tuple[FleetRow, ...]
    sessions: tuple[SessionLine, ...]
    causes: tuple[AcceptedCause, ...]
    group: GroupSection | None
    more: tuple[str, ...]
    """Of ``flags``, ``units`` and ``sessions``, those of which not all are listed."""


def stands_page(stands: Sequence[StandLine], now: datetime) -> StandsPage:
    """The list of stands."""
    rows = [_row(stand, now) for stand in stands]
    return StandsPage(tuple(sorted(rows, key=lambda row: (WORDS.index(row.word), row.use.stand))))


def stand_page(report: StandReport, now: datetime, group: GroupSection | None = None) -> StandPage:
    """The page of one stand."""
    line, condition = report.line, report.line.condition
    certificate = certificate_in_words(line.certificates, now.date())
    listed = {"flags": report.flags, "units": report.units, "sessions": report.sessions}
    return StandPage(
        use=line.use,
        word=_word(line, now),
        reasons=(certificate, condition_in_words(condition)),
        certificates=tuple(map(_certificate, reversed(line.certificates))),
        flags=flag_cards(report.flags[:MOST]),
        shifts=() if condition is None else _shifts(condition),
        seating=() if condition is None else _seating(condition),
        unreadable=() if condition is None else condition.unreadable,
        units=tuple(fleet_row(unit, now) for unit in report.units[:MOST]),
        sessions=session_lines(report.sessions[:MOST]),
        causes=accepted_causes(report.models),
        group=group,
        more=tuple(name for name, found in listed.items() if len(found) > MOST),
    )


def _row(line: StandLine, now: datetime) -> StandRow:
    latest = held(line.certificates, now.date())
    until = "none on record" if latest is None else f"until {day_of(latest.valid_until)}"
    return StandRow(line.use, _word(line, now), condition_in_words(line.condition), until, flags_in_words(line.flags))


def _word(line: StandLine, now: datetime) -> StandWord:
    return stand_word(line.condition, line.certificates, line.flags, now.date())


def _certificate(own: StandCertificate) -> tuple[str, str, str, str]:
    return own.number, own.issued_by, day_of(own.issued_on), day_of(own.valid_until)


def _shifts(condition: StandCondition) -> tuple[ShiftRow, ...]:
    """Shifts, newest first; then the most evident of every quantity that has none."""
    shifted = {(shift.kind, shift.quantity) for shift in condition.shifts}
    steady = [one for one in condition.evidence if (one.kind, one.quantity) not in shifted]
    return (*(_shift(one) for one in reversed(condition.shifts)), *(_steady(one) for one in steady))


def _shift(one: StandEvidence) -> ShiftRow:
    lasts = one.until is None
    when = f"since {day_of(one.since)}" if one.until is None else f"{day_of(one.since)} to before {day_of(one.until)}"
    word, tone = ("shifted", "conditional-fail") if lasts else ("back where it was", "conditional-pass")
    return _shift_row(one, when, word, tone)


def _steady(one: StandEvidence) -> ShiftRow:
    return _shift_row(one, f"most evident since {day_of(one.since)}", "steady: no more than chance", "pass")


def _shift_row(one: StandEvidence, when: str, word: str, tone: str) -> ShiftRow:
    units = f"{one.agreeing} of {one.units}"
    return ShiftRow(kind_of_shift(one.kind, one.quantity), size_of_shift(one), when, units, word, tone)


def _seating(condition: StandCondition) -> tuple[tuple[str, str], ...]:
    return tuple((kind_of_shift(own.kind, own.quantity), scatter_of(own)) for own in condition.seating)
