"""Flags and their notices."""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from itertools import groupby

from sqlalchemy import (
    ColumnElement,
    Row,
    ScalarSelect,
    and_,
    bindparam,
    case,
    exists,
    insert,
    literal,
    or_,
    select,
    update,
)
from sqlalchemy.orm import aliased

from service.errors import NotFoundError
from service.flags.records import AT_FAULT, Assignee, Concern, Flag, FlagState, Matter, Notice, NoticeKind
from service.flags.tables import DeliveryRow, FlagRow, NoticeRow, WebhookRow
from service.kit.copying import copied
from service.kit.listing import ListQuery
from service.models.records import Scope
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.sessions.tables import SessionRow
from service.stands.tables import StandRow
from service.storage.listing import Key, Listing
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
        """Stores a notice, and puts it into the outbox of every address that is notified of its kind; no address is
        notified of a retired unit."""
        row = NoticeRow(unit_id=unit, flag_id=flag, kind=kind, at=at, who=who, text=text, session_id=session)
        self._session.add(row)
        self._session.flush()
        if kind is not NoticeKind.SEEN:
            self._put_into_outbox(row.id, at)

    def _put_into_outbox(self, notice: int, at: datetime) -> None:
        columns = ("notice_id", "webhook_id", "state", "attempts", "outcome")
        notified = select(literal(notice), WebhookRow.id, literal("waiting"), literal(0), literal(""))
        retired = exists().where(
            NoticeRow.id == notice, UnitRow.id == NoticeRow.unit_id, UnitRow.retired_at.is_not(None)
        )
        new = insert(DeliveryRow).from_select(columns, notified.where(WebhookRow.removed_at.is_(None), ~retired))
        deliveries = self._session.scalars(new.returning(DeliveryRow.id)).all()
        WorkQueue(self._store, WorkKind.MESSAGE).enqueue_once(map(str, sorted(deliveries)), at)


def notice_of(row: NoticeRow, serial: str) -> Notice:
    """The record of a row."""
    return copied(Notice, row, unit=serial, flag=row.flag_id, session=row.session_id)


@dataclass(frozen=True)
class FlagQuery(ListQuery):
    """Filter of flags, newest first, and the number after or before which the list goes on."""

    unit: str | None = None
    state: FlagState | None = None
    matter: Matter | None = None
    text: str | None = None
    """Part of the unit's serial number, or of the name of the type or the stand, small and capital letters alike."""
    unresolved: bool = False
    unit_type: str | None = None
    """Name of the type that the flags are about as a whole."""
    stand: str | None = None
    """About a stand, whether units, single sessions or all of them together tell of it."""
    worst_first: bool = False
    """Whether the gravest come first, not the newest."""
    assignee: Assignee | None = None
    """Assignee, by the account or, where the flag names none, by the name; the one without a name stands for unassigned
    flags.
    """


IS_OF_UNIT = FlagRow.scope == Scope.UNIT
"""Condition of flags about the unit itself, not about its type or a stand."""
IS_OF_RETIRED = exists().where(UnitRow.id == FlagRow.unit_id, UnitRow.retired_at.is_not(None))
IS_RESOLVED = case((FlagRow.state == FlagState.RESOLVED, 1), else_=0)
"""A number that orders open flags before those that are resolved."""


def _is_resolved(number: int) -> ScalarSelect[int]:
    known = aliased(FlagRow)
    return select(case((known.state == FlagState.RESOLVED, 1), else_=0)).where(known.id == number).scalar_subquery()


def _is_on(serial: str) -> ColumnElement[bool]:
    unit = select(UnitRow.id).where(UnitRow.serial == serial).scalar_subquery()
    return and_(FlagRow.unit_id == unit, IS_OF_UNIT)


def _is_about(stand: str) -> ColumnElement[bool]:
    together = and_(FlagRow.scope == Scope.STAND, FlagRow.subject == stand)
    return or_(and_(FlagRow.matter.in_(AT_FAULT), FlagRow.place == stand), together)


def _has(text: str) -> ColumnElement[bool]:
    serial = select(UnitRow.serial).where(UnitRow.id == FlagRow.unit_id).scalar_subquery()
    return case((IS_OF_UNIT, serial), else_=FlagRow.subject).icontains(text, autoescape=True)


def _is_of(assignee: Assignee) -> ColumnElement[bool]:
    """Whether a flag is somebody's. An account may be renamed, so its login decides; without one, the name."""
    by_name = and_(FlagRow.assignee == assignee.name, FlagRow.assignee_login == "")
    return or_(FlagRow.assignee_login == assignee.login, by_name) if assignee.login else by_name


NEWEST = (Key(FlagRow.id, is_falling=True, known=int),)
OPEN_FIRST = (Key(IS_RESOLVED, stays=True, known=_is_resolved), *NEWEST)
WORST = (
    Key(case({matter.value: rank for rank, matter in enumerate(Matter)}, value=FlagRow.matter)),
    Key(FlagRow.severity, is_falling=True),
    Key(FlagRow.id, is_falling=True),
)
"""The gravest matter first, as `Matter` lists them."""


def _keys(wanted: FlagQuery) -> tuple[Key, ...]:
    if wanted.worst_first:
        return WORST
    return NEWEST if wanted.unresolved else OPEN_FIRST


FLAGS: Listing[FlagQuery] = Listing(
    name=FlagRow.id,
    keys=_keys,
    conditions={
        "unit": _is_on,
        "unit_type": lambda name: and_(FlagRow.scope == Scope.UNIT_TYPE, FlagRow.subject == name),
        "stand": _is_about,
        "text": _has,
        "state": lambda state: FlagRow.state == state,
        "matter": lambda matter: FlagRow.matter == matter,
        "assignee": _is_of,
        "unresolved": lambda _: FlagRow.state != FlagState.RESOLVED,
    },
)


class Flags(Queries):
    """Flags by unit and state."""

    def open_of(self, unit: int) -> tuple[Flag, ...]:
        """The flags of a unit that are not resolved, without their lives."""
        found = self._session.execute(_OPEN_OF, {"unit": unit})
        return tuple(_flag(row, serial) for row, serial in found)

    def open_stands_of(self, unit: int) -> tuple[str, ...]:
        """Stands on which a unit was ever measured and that have an open flag from sessions on them."""
        on = select(StandRow.name).join(SessionRow, SessionRow.stand_id == StandRow.id)
        conditions = (FlagRow.matter == Matter.STAND, FlagRow.scope == Scope.STAND, FlagRow.state != FlagState.RESOLVED)
        query = select(FlagRow.place).where(*conditions, FlagRow.place.in_(on.where(SessionRow.unit_id == unit)))
        return tuple(self._session.scalars(query.distinct()))

    def open_about(self, *matters: Matter) -> tuple[Flag, ...]:
        """All flags on some matters that are not resolved, without their lives."""
        query = select(FlagRow, UnitRow.serial).join(UnitRow, UnitRow.id == FlagRow.unit_id)
        found = self._session.execute(query.where(FlagRow.matter.in_(matters), FlagRow.state != FlagState.RESOLVED))
        return tuple(_flag(row, serial) for row, serial in found)

    def of_group(self, matter: Matter, place: str) -> tuple[Flag, ...]:
        """All flags on a matter at places that begin so, oldest first, without their lives."""
        query = select(FlagRow, UnitRow.serial).join(UnitRow, UnitRow.id == FlagRow.unit_id)
        conditions = (FlagRow.matter == matter, FlagRow.place.startswith(place, autoescape=True))
        found = self._session.execute(query.where(*conditions).order_by(FlagRow.id))
        return tuple(_flag(row, serial) for row, serial in found)

    def unit_of(self, id: int) -> str:
        """Serial number of a flag's unit."""
        query = select(UnitRow.serial).join(FlagRow, FlagRow.unit_id == UnitRow.id).where(FlagRow.id == id)
        serial = self._session.scalar(query)
        if serial is None:
            raise NotFoundError("There is no flag {id}.", id=id)
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
            raise NotFoundError("There is no flag {id}.", id=id)
        return found[0]

    def page(self, wanted: FlagQuery) -> tuple[Flag, ...]:
        """Flags with their lives, open ones first, newest first unless asked otherwise, in one query; those of retired
        units only where their unit is asked for."""
        listed = select(FlagRow.id) if wanted.unit else select(FlagRow.id).where(~(IS_OF_UNIT & IS_OF_RETIRED))
        page = FLAGS.page(self._session, listed, wanted)
        ids = page.cut(listed).subquery()
        query = (
            select(FlagRow, UnitRow.serial, NoticeRow)
            .join(ids, ids.c.id == FlagRow.id)
            .join(UnitRow, UnitRow.id == FlagRow.unit_id)
            .join(NoticeRow, NoticeRow.flag_id == FlagRow.id)
        )
        rows = self._session.execute(page.ordered(query).order_by(NoticeRow.id))
        return page.forward(_with_lives(rows))

    def assignee_of(self, id: int) -> Assignee:
        """The person assigned to a flag."""
        query = select(FlagRow.assignee, FlagRow.assignee_login).where(FlagRow.id == id)
        return Assignee(*self._session.execute(query).one())

    def assignees(self) -> tuple[Assignee, ...]:
        """The persons assigned to open flags, by name."""
        query = select(FlagRow.assignee, FlagRow.assignee_login).distinct().order_by(FlagRow.assignee)
        found = self._session.execute(query.where(FlagRow.state != FlagState.RESOLVED, FlagRow.assignee != ""))
        return tuple(Assignee(name, login) for name, login in found)

    def add(self, unit: int, concern: Concern, session: str | None, at: datetime) -> int:
        """Stores a raised flag and returns its number."""
        raised = {"state": FlagState.RAISED, "proposal": "", "raised_at": at, "changed_at": at}
        kept = ("matter", "place", "severity", "summary", "scope", "subject")
        row = FlagRow(unit_id=unit, session_id=session, **{name: getattr(concern, name) for name in kept}, **raised)
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
    return tuple(_grouped(list(lives)) for _, lives in groupby(rows, key=lambda row: row[0].id))


def _grouped(rows: list[Row[FlagRow, str, NoticeRow]]) -> Flag:
    flag, serial, _ = rows[0]
    return _flag(flag, serial, tuple(notice_of(notice, serial) for _, _, notice in rows))


def _flag(row: FlagRow, serial: str, changes: tuple[Notice, ...] = ()) -> Flag:
    return copied(Flag, row, unit=serial, session=row.session_id, changes=changes)
