"""Flags and what happened to them."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import datetime
from itertools import groupby

from sqlalchemy import ColumnElement, Row, and_, bindparam, case, insert, literal, or_, select, update
from sqlalchemy.orm import aliased

from estimator.message import say
from service.errors import NotFoundError
from service.flags.records import AT_FAULT, Assignee, Concern, Flag, FlagState, Matter, Notice, NoticeKind
from service.flags.tables import DeliveryRow, FlagRow, NoticeRow, WebhookRow
from service.models.records import Scope
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.sessions.tables import SessionRow
from service.stands.tables import StandRow
from service.storage.queries import Queries
from service.units.tables import UnitRow


class Notices(Queries):
    """Notices; a row is written once."""

    def add(
        self,
        unit: int,
        kind: NoticeKind,
        at: datetime,
        who: str,
        text: str,
        *,
        flag: int | None = None,
        session: str | None = None,
    ) -> None:
        """Stores a notice, and puts it into the outbox of every address that is told of its kind."""
        row = NoticeRow(unit_id=unit, flag_id=flag, kind=kind, at=at, who=who, text=text, session_id=session)
        self._session.add(row)
        self._session.flush()
        if kind is not NoticeKind.SEEN:
            self._put_into_outbox(row.id, at)

    def _put_into_outbox(self, notice: int, at: datetime) -> None:
        columns = ("notice_id", "webhook_id", "state", "attempts", "outcome")
        told = select(literal(notice), WebhookRow.id, literal("waiting"), literal(0), literal(""))
        new = insert(DeliveryRow).from_select(columns, told.where(WebhookRow.removed_at.is_(None)))
        deliveries = self._session.scalars(new.returning(DeliveryRow.id)).all()
        WorkQueue(self._store, WorkKind.MESSAGE).ask_once(map(str, sorted(deliveries)), at)


def notice_of(row: NoticeRow, serial: str) -> Notice:
    """The record of a row."""
    return Notice(
        id=row.id,
        unit=serial,
        flag=row.flag_id,
        kind=NoticeKind(row.kind),
        at=row.at,
        who=row.who,
        text=row.text,
        session=row.session_id,
    )


@dataclass(frozen=True)
class FlagQuery:
    """Which flags are wanted."""

    unit: str | None = None
    state: FlagState | None = None
    offset: int = 0
    limit: int = 100
    matter: Matter | None = None
    text: str | None = None
    """Part of the unit's serial number, or of the name of the type or the stand, small and capital letters alike."""
    unresolved: bool = False
    unit_type: str | None = None
    """About a type as a whole."""
    stand: str | None = None
    """About a stand, whether units, single sessions or all of them together tell of it."""
    assignee: Assignee | None = None
    """Who looks after it, by the account or, where the flag names none, by the name; of nobody none is anybody's."""
    after: int | None = None
    """Flags that follow this one in the list."""
    before: int | None = None
    """Flags that come before it; of open ones only."""
    oldest_first: bool = False

    @property
    def is_falling(self) -> bool:
        """Whether rows are read from the largest number on; those before a flag are read backwards."""
        return self.oldest_first == (self.before is not None)


IS_OF_UNIT = FlagRow.scope == Scope.UNIT
"""About the unit itself, not about its type or a stand."""
IS_RESOLVED = case((FlagRow.state == FlagState.RESOLVED, 1), else_=0)
"""A number that orders open flags before those that are resolved."""


def _wanted(wanted: FlagQuery) -> Iterator[ColumnElement[bool]]:
    if wanted.unit is not None:
        yield and_(UnitRow.serial == wanted.unit, IS_OF_UNIT)
    if wanted.unit_type is not None:
        yield and_(FlagRow.scope == Scope.UNIT_TYPE, FlagRow.subject == wanted.unit_type)
    if wanted.stand is not None:
        together = and_(FlagRow.scope == Scope.STAND, FlagRow.subject == wanted.stand)
        yield or_(and_(FlagRow.matter.in_(AT_FAULT), FlagRow.place == wanted.stand), together)
    if wanted.text:
        name = case((IS_OF_UNIT, UnitRow.serial), else_=FlagRow.subject)
        yield name.icontains(wanted.text, autoescape=True)
    if wanted.state is not None:
        yield FlagRow.state == wanted.state
    if wanted.matter is not None:
        yield FlagRow.matter == wanted.matter
    if wanted.assignee is not None:
        yield _is_of(wanted.assignee)
    place = wanted.after or wanted.before
    if place is not None:
        yield _beyond(wanted, place)
    if wanted.unresolved:
        yield FlagRow.state != FlagState.RESOLVED


def _beyond(wanted: FlagQuery, place: int) -> ColumnElement[bool]:
    """Whether a flag lies beyond another one, in the direction of reading."""
    further = FlagRow.id < place if wanted.is_falling else FlagRow.id > place
    if wanted.unresolved:
        return further
    known = aliased(FlagRow)
    state = select(case((known.state == FlagState.RESOLVED, 1), else_=0)).where(known.id == place).scalar_subquery()
    return or_(state < IS_RESOLVED, (state == IS_RESOLVED) & further)


def _is_of(assignee: Assignee) -> ColumnElement[bool]:
    """Whether a flag is somebody's. An account may be renamed, so its login tells; where a flag has none, the name."""
    by_name = and_(FlagRow.assignee == assignee.name, FlagRow.assignee_login == "")
    return or_(FlagRow.assignee_login == assignee.login, by_name) if assignee.login else by_name


class Flags(Queries):
    """Flags by unit and state."""

    def open_of(self, unit: int) -> tuple[Flag, ...]:
        """The flags of a unit that are not resolved, without their lives."""
        found = self._session.execute(_OPEN_OF, {"unit": unit})
        return tuple(_flag(row, serial) for row, serial in found)

    def open_stands_of(self, unit: int) -> tuple[str, ...]:
        """Stands that a unit was ever measured on, and that have an open flag for what sessions found on them."""
        on = select(StandRow.name).join(SessionRow, SessionRow.stand_id == StandRow.id)
        own = (FlagRow.matter == Matter.STAND, FlagRow.scope == Scope.STAND, FlagRow.state != FlagState.RESOLVED)
        query = select(FlagRow.place).where(*own, FlagRow.place.in_(on.where(SessionRow.unit_id == unit)))
        return tuple(self._session.scalars(query.distinct()))

    def open_about(self, *matters: Matter) -> tuple[Flag, ...]:
        """All flags on some matters that are not resolved, without their lives."""
        query = select(FlagRow, UnitRow.serial).join(UnitRow, UnitRow.id == FlagRow.unit_id)
        found = self._session.execute(query.where(FlagRow.matter.in_(matters), FlagRow.state != FlagState.RESOLVED))
        return tuple(_flag(row, serial) for row, serial in found)

    def of_group(self, matter: Matter, place: str) -> tuple[Flag, ...]:
        """All flags on a matter at places that begin so, oldest first, without their lives."""
        query = select(FlagRow, UnitRow.serial).join(UnitRow, UnitRow.id == FlagRow.unit_id)
        own = (FlagRow.matter == matter, FlagRow.place.startswith(place, autoescape=True))
        found = self._session.execute(query.where(*own).order_by(FlagRow.id))
        return tuple(_flag(row, serial) for row, serial in found)

    def unit_of(self, id: int) -> str:
        """Serial number of a flag's unit."""
        query = select(UnitRow.serial).join(FlagRow, FlagRow.unit_id == UnitRow.id).where(FlagRow.id == id)
        serial = self._session.scalar(query)
        if serial is None:
            raise NotFoundError(say("There is no flag {id}.", id=id))
        return serial

    def get(self, id: int) -> Flag:
        """One flag with its life."""
        query = (
            select(FlagRow, UnitRow.serial, NoticeRow)
            .join(UnitRow, UnitRow.id == FlagRow.unit_id)
            .join(NoticeRow, NoticeRow.flag_id == FlagRow.id)
            .where(FlagRow.id == id)
            .order_by(NoticeRow.id)
        )
        found = _with_lives(self._session.execute(query))
        if not found:
            raise NotFoundError(say("There is no flag {id}.", id=id))
        return found[0]

    def page(self, wanted: FlagQuery) -> tuple[Flag, ...]:
        """Flags with their lives, open ones first, newest first unless asked otherwise, in one query."""
        number = FlagRow.id.desc() if wanted.is_falling else FlagRow.id.asc()
        chosen = select(FlagRow.id).order_by(*(() if wanted.unresolved else (IS_RESOLVED,)), number)
        if wanted.unit is not None or wanted.text:
            chosen = chosen.join(UnitRow, UnitRow.id == FlagRow.unit_id)
        ids = chosen.where(*_wanted(wanted)).offset(wanted.offset).limit(wanted.limit).subquery()
        query = (
            select(FlagRow, UnitRow.serial, NoticeRow)
            .join(ids, ids.c.id == FlagRow.id)
            .join(UnitRow, UnitRow.id == FlagRow.unit_id)
            .join(NoticeRow, NoticeRow.flag_id == FlagRow.id)
            .order_by(IS_RESOLVED, number, NoticeRow.id)
        )
        found = _with_lives(self._session.execute(query))
        return found if wanted.before is None else found[::-1]

    def assignee_of(self, id: int) -> Assignee:
        """Who looks after a flag."""
        query = select(FlagRow.assignee, FlagRow.assignee_login).where(FlagRow.id == id)
        return Assignee(*self._session.execute(query).one())

    def assignees(self) -> tuple[Assignee, ...]:
        """Who looks after open flags, by name."""
        query = select(FlagRow.assignee, FlagRow.assignee_login).distinct().order_by(FlagRow.assignee)
        found = self._session.execute(query.where(FlagRow.state != FlagState.RESOLVED, FlagRow.assignee != ""))
        return tuple(Assignee(name, login) for name, login in found)

    def add(self, unit: int, concern: Concern, session: str | None, at: datetime) -> int:
        """Stores a raised flag and returns its number."""
        row = FlagRow(
            unit_id=unit,
            matter=concern.matter,
            place=concern.place,
            state=FlagState.RAISED,
            severity=concern.severity,
            summary=concern.summary,
            proposal="",
            session_id=session,
            scope=concern.scope,
            subject=concern.subject,
            raised_at=at,
            changed_at=at,
        )
        self._session.add(row)
        self._session.flush()
        return row.id

    def put(self, id: int, at: datetime, **changed: str | int | None) -> None:
        """Writes what a notice changed."""
        self._session.execute(update(FlagRow).where(FlagRow.id == id).values(changed_at=at, **changed))
        self._session.expire_all()


_OPEN_OF = (
    select(FlagRow, UnitRow.serial)
    .join(UnitRow, UnitRow.id == FlagRow.unit_id)
    .where(FlagRow.unit_id == bindparam("unit"), IS_OF_UNIT, FlagRow.state != FlagState.RESOLVED)
)


def _with_lives(rows: Iterable[Row[FlagRow, str, NoticeRow]]) -> tuple[Flag, ...]:
    return tuple(_grouped(list(own)) for _, own in groupby(rows, key=lambda row: row[0].id))


def _grouped(rows: list[Row[FlagRow, str, NoticeRow]]) -> Flag:
    flag, serial, _ = rows[0]
    return _flag(flag, serial, tuple(notice_of(notice, serial) for _, _, notice in rows))


def _flag(row: FlagRow, serial: str, changes: tuple[Notice, ...] = ()) -> Flag:
    return Flag(
        id=row.id,
        unit=serial,
        matter=Matter(row.matter),
        place=row.place,
        state=FlagState(row.state),
        severity=row.severity,
        summary=row.summary,
        proposal=row.proposal,
        session=row.session_id,
        raised_at=row.raised_at,
        changed_at=row.changed_at,
        assignee=row.assignee,
        scope=Scope(row.scope),
        subject=row.subject,
        changes=changes,
    )
