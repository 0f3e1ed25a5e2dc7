"""Flow: the joint diagnosis of the sessions of a unit, a unit type or a stand, made again when one of them changed.

It rests on the accepted sessions: a digest of them tells whether a stored answer still holds. So a session that is
withdrawn, questioned or superseded leaves the pool, and comes back when it is accepted.
"""

from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from hashlib import sha256

from estimator.calibration.calibrate import averaged
from estimator.errors import SessionError
from estimator.groups import SessionStatistics, diagnose_statistics
from estimator.moments import written
from estimator.session import CalibrationSession
from service.diagnosis.store import Diagnoses
from service.groups.changes import add_statistics, tell_own
from service.groups.records import Group, GroupAnswer, Level, Member, Members
from service.groups.store import Groups, Statistics, group_document, read_group
from service.groups.words import FAILED, summary_of_group
from service.ingest import read_upload
from service.ingest.checked import dated
from service.kit.failure import with_last_try
from service.kit.lock_order import outside_writing
from service.kit.log import log
from service.models.records import SCOPES
from service.outlook.changes import END_OF_TIME
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.flagging.lasting import flag_lasting
from service.settings import VERSION
from service.storage import Files, Storage
from service.storage.files import LOST
from service.storage.queries import Store
from service.units.store import Services

RULE = b"4"
"""Version of the rules of joint diagnoses: those made by an earlier one are made again."""


def members_of(store: Store, group: Group) -> Members:
    """The sessions that a group's answer rests on: of a unit those since its last service."""
    since = Services(store).began(group.key, END_OF_TIME) if group.level is Level.UNIT else None
    return Groups(store).members(group, since)


def digest(members: Members) -> str:
    """The digest of sessions, 64 hexadecimal digits."""
    lines = (f"{m.session} {m.has_statistics}" for m in members.sessions)
    return sha256(RULE + "\n".join((*lines, str(members.left_out))).encode()).hexdigest()


def current(store: Store, group: Group) -> GroupAnswer | None:
    """The stored answer of a group, if it rests on the current records; one that this version failed at holds too."""
    known = Groups(store).get(group)
    if known is None or known.is_of_another(VERSION):
        return None
    return known if rests_on_now(store, group, known) else None


def rests_on_now(store: Store, group: Group, answer: GroupAnswer) -> bool:
    """Whether an answer rests on the current records; one that was requested again may."""
    return answer.rests_on == digest(members_of(store, group))


def refresh_group(storage: Storage, group: Group, now: datetime) -> GroupAnswer:
    """The answer of a group for its sessions of now, made and stored where it is not there.

    Statistics that are missing, as of sessions older than they are, are made first. What changes meanwhile has asked
    for the group again.
    """
    with storage.database.reading() as store:
        asked, missing = WorkQueue(store, WorkKind.GROUP).tickets(group.place), members_of(store, group).without
    for member in missing:
        with storage.database.writing() as store:
            is_tried = not Diagnoses(store).has_failed(member.session)
            wanted = is_tried and Statistics(store).begin(member.session, VERSION)
            if is_tried and not wanted and not member.why:
                WorkQueue(store, WorkKind.GROUP).reset_attempts(group.place)  # that session was, and is given up now
        if wanted:
            add_statistics(storage, member.session, member.sha256, member.filename)
    with storage.database.reading() as store:
        members, answer = members_of(store, group), current(store, group)
        records = Statistics(store).of([m.session for m in members.pooled])
    is_new = answer is None
    answer = answer or _answered(storage.files, group, members, records, now)
    with storage.database.writing() as store:
        if is_new:
            Groups(store).put(group, answer)
            tell_own(store, SCOPES[group.level.value], group.name)
        _flag(store, group, members, answer, now)
        WorkQueue(store, WorkKind.GROUP).settle_each(asked)
    return answer


def _flag(store: Store, group: Group, members: Members, answer: GroupAnswer, now: datetime) -> None:
    """A failed answer says nothing of what the sessions show."""
    if answer.document is not None:
        found = read_group(answer.document).findings
        flag_lasting(store, group, found, members.pooled[-1] if members.pooled else None, now)


def give_up(storage: Storage, group: Group, now: datetime) -> None:
    """Stores of a group that the program failed at its answer; this version does not try again with these sessions."""
    with storage.database.writing() as store:
        asked = WorkQueue(store, WorkKind.GROUP).tickets(group.place)
        summary = with_last_try(FAILED, WorkQueue(store, WorkKind.GROUP).failed(group.place))
        answer = GroupAnswer(digest(members_of(store, group)), 0, summary, "", None, VERSION, now)
        Groups(store).put(group, answer)
        WorkQueue(store, WorkKind.GROUP).settle_each(asked)


@outside_writing
def _answered(
    files: Files, group: Group, members: Members, records: dict[str, SessionStatistics], now: datetime
) -> GroupAnswer:
    pooled = _pooled(group, members, records)
    made = GroupAnswer(digest(members), len(pooled), summary_of_group(0, ()), "", None, VERSION, now)
    if not pooled:
        return replace(made, document=group_document(group, None, members))
    try:
        statistics = [_named(records[m.session], m) for m in pooled]
        found = diagnose_statistics(statistics, group.level.value, _sessions(files, pooled))
    except SessionError as fault:
        log.error("group failed", level=group.level.value, name=group.name, exc_info=fault)
        return replace(made, summary=FAILED)
    summary = summary_of_group(found.sessions, found.findings, unexplained=found.unexplained)
    return replace(made, summary=summary, document=group_document(group, found, members))


def _pooled(group: Group, members: Members, records: dict[str, SessionStatistics]) -> list[Member]:
    """Oldest first; the last one is the group's own, since it says whose the group is."""
    found = [m for m in members.pooled if m.session in records]
    while found and group.level is Level.STAND and found[-1].stand != group.name:
        found.pop()
    return found


def _named(record: SessionStatistics, member: Member) -> SessionStatistics:
    """The statistics under the service's names and times: a file may state neither its type nor a date."""
    stand, at = member.stand or "", written(member.started_at)
    return replace(record, unit=member.unit, unit_type=member.unit_type, stand=stand, started_at=at)


def _sessions(files: Files, members: Sequence[Member]) -> list[CalibrationSession]:
    """The sessions themselves, raw logs as their averaged positions, since all of them are held at once; none where one
    is lost: then no measurement is proposed and no term learned."""
    try:
        return [_averaged(files, member) for member in members]
    except (*LOST, SessionError):
        return []


def _averaged(files: Files, member: Member) -> CalibrationSession:
    session = averaged(read_upload(files.content(member.sha256), member.filename))
    return dated(replace(session, unit_type=member.unit_type), member.started_at)
