"""Sessions that are asked for: what narrows the list, what orders it, and from which session on it is read.

A page of the list begins after a session, not after a number of them: it costs the same however far one reads, and
what is uploaded meanwhile moves nothing (keyset paging).
"""

from collections.abc import Iterator
from typing import Any

from sqlalchemy import ColumnElement, case, literal, select, tuple_

from service.diagnosis.tables import DiagnosisRow
from service.sessions.decision import Verdict
from service.sessions.records import SessionOrder, SessionQuery
from service.sessions.tables import SessionRow
from service.stands.tables import StandRow
from service.types.tables import UnitTypeRow
from service.units.tables import UnitRow

SEVERITY = case({verdict.value: verdict.severity for verdict in Verdict}, value=SessionRow.verdict)
"""A number that orders verdicts from good to bad."""
KEYS: dict[SessionOrder, tuple[Any, ...]] = {
    SessionOrder.MEASURED: (SessionRow.started_at, SessionRow.id),
    SessionOrder.UPLOADED: (SessionRow.uploaded_at, SessionRow.id),
    SessionOrder.VERDICT: (SEVERITY, SessionRow.started_at, SessionRow.id),
    SessionOrder.UNIT: (UnitRow.serial, SessionRow.started_at, SessionRow.id),
}
"""What each order goes by; no two sessions have the same."""
ASCENDING = (SessionOrder.UNIT,)
"""Orders in which the smallest comes first."""


def conditions(wanted: SessionQuery) -> Iterator[ColumnElement[bool]]:
    """What narrows the list."""
    yield from _by_unit(wanted)
    yield from _by_date(wanted)
    yield from _by_verdict(wanted)


def is_falling(wanted: SessionQuery) -> bool:
    """Whether the rows are read with the largest key first; those before a session are read backwards."""
    turns = (wanted.order not in ASCENDING, wanted.backwards, wanted.before is not None)
    return sum(turns) % 2 == 1


def beyond(wanted: SessionQuery, place: tuple[Any, ...]) -> ColumnElement[bool]:
    """Sessions that come after the one with these keys, or before it."""
    keys = KEYS[wanted.order]
    here = tuple_(*(literal(value, key.type) for value, key in zip(place, keys, strict=True)))
    return tuple_(*keys) < here if is_falling(wanted) else tuple_(*keys) > here


def ordered(wanted: SessionQuery) -> list[ColumnElement[Any]]:
    """What the rows are read by."""
    falling = is_falling(wanted)
    return [key.desc() if falling else key.asc() for key in KEYS[wanted.order]]


def _by_unit(wanted: SessionQuery) -> Iterator[ColumnElement[bool]]:
    if wanted.text:
        yield UnitRow.serial.icontains(wanted.text, autoescape=True)
    if wanted.unit is not None:
        yield UnitRow.serial == wanted.unit
    if wanted.unit_type is not None:
        of_type = select(UnitTypeRow.id).where(UnitTypeRow.name == wanted.unit_type)
        yield UnitRow.unit_type_id == of_type.scalar_subquery()
    if wanted.stand is not None:
        yield SessionRow.stand_id == select(StandRow.id).where(StandRow.name == wanted.stand).scalar_subquery()


def _by_date(wanted: SessionQuery) -> Iterator[ColumnElement[bool]]:
    if wanted.since is not None:
        yield SessionRow.started_at >= wanted.since
    if wanted.until is not None:
        yield SessionRow.started_at < wanted.until


def _by_verdict(wanted: SessionQuery) -> Iterator[ColumnElement[bool]]:
    if wanted.state is not None:
        yield SessionRow.state == wanted.state
    if wanted.verdict is not None:
        yield SessionRow.verdict == wanted.verdict
    if wanted.is_reference is not None:
        yield SessionRow.is_reference.is_(wanted.is_reference)
    if wanted.reserved:
        yield DiagnosisRow.reservations.is_not(None)
