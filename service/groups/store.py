"""Units, types and stands as groups of sessions, and the statistics of sessions for their groups."""

import json
import zlib
from collections.abc import Collection
from datetime import datetime
from typing import Any

from sqlalchemy import (
    ColumnElement,
    Select,
    String,
    and_,
    bindparam,
    cast,
    delete,
    exists,
    func,
    literal,
    or_,
    select,
    tuple_,
    update,
)
from sqlalchemy.orm import aliased

from estimator.groups import GroupDiagnosis, SessionStatistics
from estimator.groups.statistics import FORMAT
from estimator.json_object import Json
from estimator.session import CALIBRATIONS
from service.errors import NotFoundError
from service.groups.records import Group, GroupAnswer, GroupShown, Level, Member, Members
from service.groups.tables import GroupDiagnosisRow, SessionStatisticsRow
from service.groups.words import NO_SESSION
from service.queue.records import WorkKind
from service.queue.tables import WorkRow
from service.sessions.states import RecordState
from service.sessions.states_store import IS_ACCEPTED
from service.sessions.tables import SessionRow
from service.stands.tables import StandRow
from service.storage.json_text import STORED, json_text
from service.storage.queries import Queries
from service.types.store import counts_for_stand, counts_for_type
from service.types.tables import UnitTypeRow
from service.units.tables import UnitRow


def group_document(group: Group, found: GroupDiagnosis | None, members: Members) -> str:
    """The joint diagnosis as JSON, with the sessions that the pool leaves out; of an empty group where ``found`` is
    None.
    """
    document = found or _empty(group)
    left = [{"session": m.session, "reason": m.why} for m in members.without]
    return json_text(STORED.written(document) | STORED.written({"left_out": members.left_out, "not_pooled": left}))


def read_group(text: str) -> GroupShown:
    """Reads the output of `group_document`."""
    return GroupShown.from_dict(json.loads(text))


def _empty(group: Group) -> GroupDiagnosis:
    return GroupDiagnosis(
        group.level.value, group.name, 0, None, None,
        findings=(), terms=(), structures=(), limits=(), gain=None, e_value=1.0, notes=(NO_SESSION,),
    )  # fmt: skip


MOST = 60
"""Most sessions of a group that are pooled, the newest. An effect of one standard error in each reaches 8, at which it
is named, at the 64th: fewer would miss effects worth naming. More would cost minutes, and reach years back.
"""
KEYS = {Level.UNIT: UnitRow.id, Level.TYPE: UnitTypeRow.id, Level.STAND: StandRow.id}
CALLED = {Level.UNIT: UnitRow.serial, Level.TYPE: UnitTypeRow.name, Level.STAND: StandRow.name}
WORDS = {Level.UNIT: "unit", Level.TYPE: "unit type", Level.STAND: "stand"}


class Groups(Queries):
    """Groups and their answers."""

    def find(self, level: Level, name: str) -> Group:
        """A unit by its serial number, a unit type or stand by its name."""
        key = self._session.scalar(select(KEYS[level]).where(CALLED[level] == name))
        if key is None:
            raise NotFoundError("There is no {level} {name}.", level=WORDS[level], name=repr(name))
        return Group(level, key, name)

    def at(self, place: str) -> Group:
        """A group as the queue of work calls it."""
        level, key = place.split()
        name = self._session.scalars(select(CALLED[Level(level)]).where(KEYS[Level(level)] == int(key))).one()
        return Group(Level(level), int(key), name)

    def every(self) -> tuple[Group, ...]:
        """All units, then all unit types, then all stands."""
        return tuple(
            Group(level, key, name)
            for level, number in KEYS.items()
            for key, name in self._session.execute(select(number, CALLED[level]).order_by(number))
        )

    def of_unit(self, serial: str) -> tuple[Group, ...]:
        """The groups that a unit's sessions are in, whatever their state."""
        rows = self._session.execute(_OF_UNIT, {"serial": serial}).all()
        unit, of_type, called = rows[0][:3]
        on = (Group(Level.STAND, key, name) for *_, key, name in rows if key is not None)
        return (Group(Level.UNIT, unit, serial), Group(Level.TYPE, of_type, called), *on)

    def members(self, group: Group, since: datetime | None) -> Members:
        """The newest accepted sessions of a group that calibrate a block, not before a time.

        To those of a stand come older ones of the same units elsewhere: they tell a stand's effect from a unit's.
        """
        belongs = _belongs(group)
        if since is not None:
            belongs = and_(belongs, SessionRow.started_at >= since)
        found = self._newest(belongs)
        count = self._session.scalar(select(func.count()).select_from(SessionRow).where(belongs, *_COUNTS)) or 0
        elsewhere: tuple[Member, ...] = ()
        if group.level is Level.STAND and found:
            units = UnitRow.serial.in_({m.unit for m in found})
            not_here = or_(SessionRow.stand_id.is_(None), SessionRow.stand_id != group.key)
            elsewhere = self._newest(and_(units, not_here, SessionRow.started_at < found[0].started_at))
        members = sorted((*found, *elsewhere), key=lambda m: (m.started_at, m.session))
        return Members(tuple(members), count - len(found))

    def _newest(self, condition: ColumnElement[bool]) -> tuple[Member, ...]:
        query = _members().where(condition, *_COUNTS)
        newest = query.order_by(SessionRow.started_at.desc(), SessionRow.id.desc()).limit(MOST)
        return tuple(Member(*row) for row in self._session.execute(newest))

    def get(self, group: Group) -> GroupAnswer | None:
        """The stored answer of a group; None where there is none."""
        row = self._session.get(GroupDiagnosisRow, (group.level.value, group.key))
        return None if row is None else _answer(row)

    def known(self, level: Level, name: str) -> tuple[Group, GroupAnswer | None, bool, str]:
        """A group by its name, its stored answer, whether it is requested again since, and the reason why that failed;
        in one query.
        """
        row, number = GroupDiagnosisRow, KEYS[level]
        work = (WorkRow.kind == WorkKind.GROUP, WorkRow.key == literal(f"{level} ") + cast(number, String))
        again, failed = select(WorkRow.id).where(*work).exists(), select(func.max(WorkRow.failed)).where(*work)
        stored = and_(row.level == level.value, row.group_id == number)
        query = select(number, row, again, failed.scalar_subquery()).select_from(number.class_).outerjoin(row, stored)
        found = self._session.execute(query.where(CALLED[level] == name)).one_or_none()
        if found is None:
            raise NotFoundError("There is no {level} {name}.", level=WORDS[level], name=repr(name))
        return Group(level, found[0], name), None if found[1] is None else _answer(found[1]), found[2], found[3] or ""

    def put(self, group: Group, answer: GroupAnswer) -> None:
        """Stores the answer of a group in place of the earlier one."""
        conditions = (GroupDiagnosisRow.level == group.level, GroupDiagnosisRow.group_id == group.key)
        self._session.execute(delete(GroupDiagnosisRow).where(*conditions))
        document = None if answer.document is None else zlib.compress(answer.document.encode())
        values = {**vars(answer), "document": document}
        self.insert_once(GroupDiagnosisRow, level=group.level, group_id=group.key, **values)
        self._session.expire_all()

    def put_own(self, group: Group, sentence: str) -> None:
        """Stores a group's own findings, in a line."""
        row = GroupDiagnosisRow
        known = update(row).where(row.level == group.level, row.group_id == group.key)
        self._session.execute(known.values(own=sentence))
        self._session.expire_all()


_OF_UNIT = (
    select(UnitRow.id, UnitTypeRow.id, UnitTypeRow.name, StandRow.id, StandRow.name)
    .join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
    .outerjoin(SessionRow, SessionRow.unit_id == UnitRow.id)
    .outerjoin(StandRow, StandRow.id == SessionRow.stand_id)
    .where(UnitRow.serial == bindparam("serial"))
    .distinct()
    .order_by(StandRow.id)
)
_Earlier = aliased(SessionRow)
_IS_COPY = exists().where(
    _Earlier.readings_digest == SessionRow.readings_digest,
    _Earlier.unit_id != SessionRow.unit_id,
    _Earlier.state == RecordState.ACCEPTED,
    tuple_(_Earlier.uploaded_at, _Earlier.id) < tuple_(SessionRow.uploaded_at, SessionRow.id),
)
"""Whether the same readings are stored already, of another unit that was accepted all the same: they count once."""
_COUNTS = (IS_ACCEPTED, SessionRow.programme.in_(CALIBRATIONS), ~_IS_COPY)


def _answer(row: GroupDiagnosisRow) -> GroupAnswer:
    document = None if row.document is None else zlib.decompress(row.document).decode()
    made = (row.estimator_version, row.created_at)
    return GroupAnswer(row.rests_on, row.sessions, row.summary, row.own, document, *made)


def _belongs(group: Group) -> ColumnElement[bool]:
    match group.level:
        case Level.UNIT:
            return SessionRow.unit_id == group.key
        case Level.TYPE:
            units = select(UnitRow.id).where(UnitRow.unit_type_id == group.key, counts_for_type(group.key))
            return SessionRow.unit_id.in_(units)
        case Level.STAND:
            return and_(SessionRow.stand_id == group.key, counts_for_stand(group.key))


def _members() -> Select[str, datetime, str, str, str, str, str, bool, str]:
    has = and_(SessionStatisticsRow.format == FORMAT, SessionStatisticsRow.document.is_not(None))
    return (
        select(
            SessionRow.id, SessionRow.started_at, SessionRow.sha256, SessionRow.filename,
            UnitRow.serial, UnitTypeRow.name, StandRow.name,
            func.coalesce(has, False), func.coalesce(SessionStatisticsRow.why, ""),
        )
        .join(UnitRow, UnitRow.id == SessionRow.unit_id)
        .join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
        .outerjoin(StandRow, StandRow.id == SessionRow.stand_id)
        .outerjoin(SessionStatisticsRow, SessionStatisticsRow.session_id == SessionRow.id)
    )  # fmt: skip


MOST_ATTEMPTS = 3
"""Tries at which the program may fail at one session's, or its process die: two could be a machine in need."""
GIVEN_UP = "A fault of the program, not of the session. The next version tries again."


class Statistics(Queries):
    """Statistics by session."""

    def begin(self, session: str, version: str) -> bool:
        """Whether they are to be made by a version of the program; then this counts as a try."""
        self.insert_once(SessionStatisticsRow, session_id=session, **_begun(version))
        query = select(SessionStatisticsRow).where(SessionStatisticsRow.session_id == session)
        row = self._session.scalars(query.with_for_update()).one()
        if row.format != FORMAT or (row.document is None and row.estimator_version != version):
            self._put(session, **_begun(version))
            row = self._session.scalars(query).one()
        if row.document is not None or row.why:
            return False
        if row.attempts >= MOST_ATTEMPTS:
            self._put(session, why=GIVEN_UP)
            return False
        self._put(session, attempts=row.attempts + 1)
        return True

    def keep(self, session: str, record: SessionStatistics) -> None:
        """Stores the statistics of a session."""
        self._put(session, document=zlib.compress(json_text(STORED.written(record)).encode()), attempts=0)

    def fail(self, session: str, why: str) -> None:
        """Stores why there are none: this version does not try again."""
        self._put(session, why=why)

    def release(self, session: str) -> None:
        """Releases the statistics of a session: nothing was tried, and the next who wants them tries."""
        self._session.execute(delete(SessionStatisticsRow).where(SessionStatisticsRow.session_id == session))
        self._session.expire_all()

    def of(self, sessions: Collection[str]) -> dict[str, SessionStatistics]:
        """The stored statistics of sessions, by identifier."""
        query = select(SessionStatisticsRow.session_id, SessionStatisticsRow.document).where(
            SessionStatisticsRow.session_id.in_(tuple(sessions)),
            SessionStatisticsRow.format == FORMAT,
            SessionStatisticsRow.document.is_not(None),
        )
        kept = {id: packed for id, packed in self._session.execute(query) if packed is not None}
        return {id: SessionStatistics.from_dict(json.loads(zlib.decompress(packed))) for id, packed in kept.items()}

    def _put(self, session: str, **values: Any) -> None:
        query = update(SessionStatisticsRow).where(SessionStatisticsRow.session_id == session)
        self._session.execute(query.values(**values))
        self._session.expire_all()


def _begun(version: str) -> Json:
    return {"format": FORMAT, "document": None, "why": "", "attempts": 0, "estimator_version": version}
