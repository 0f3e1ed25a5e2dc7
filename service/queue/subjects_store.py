"""Work that is about the demonstration fleet alone."""

from collections.abc import Collection

from sqlalchemy import select
from sqlalchemy.orm import Session

from service.queue.records import WorkKind
from service.sessions.tables import SessionRow
from service.units.tables import UnitRow

_GROUPS = {"unit": UnitRow.id, "type": UnitRow.unit_type_id, "stand": SessionRow.stand_id}
"""Columns that the numbers of groups stand in, by the first word of `Group.place`."""


def of_demonstration(session: Session, kind: WorkKind, keys: Collection[str]) -> frozenset[str]:
    """Keys of the pieces of work that concern units of the demonstration alone."""
    if not has_demonstration(session):
        return frozenset()
    if kind is WorkKind.DIAGNOSIS:
        query = select(SessionRow.id).join(UnitRow, UnitRow.id == SessionRow.unit_id).where(SessionRow.id.in_(keys))
        return frozenset(session.scalars(query.where(UnitRow.is_demonstration)))
    if kind in (WorkKind.OUTLOOK, WorkKind.DERIVATION):
        query = select(UnitRow.serial).where(UnitRow.serial.in_(keys))
        return frozenset(session.scalars(query.where(UnitRow.is_demonstration)))
    if kind in (WorkKind.GROUP, WorkKind.SUMMARY):
        return frozenset(key for key in keys if _has_no_other(session, key))
    return frozenset()


ASKED = "has_demonstration"
"""Name under which a transaction keeps whether any unit is of the demonstration."""


def has_demonstration(session: Session) -> bool:
    """Whether any unit is of the demonstration."""
    if ASKED not in session.info:
        session.info[ASKED] = session.scalar(select(UnitRow.id).where(UnitRow.is_demonstration).limit(1)) is not None
    return bool(session.info[ASKED])


def _has_no_other(session: Session, place: str) -> bool:
    level, number = place.split()
    query = select(SessionRow.id).join(UnitRow, UnitRow.id == SessionRow.unit_id)
    own = query.where(_GROUPS[level] == int(number), ~UnitRow.is_demonstration)
    return session.scalar(own.limit(1)) is None
