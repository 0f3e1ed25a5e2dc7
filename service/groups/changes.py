"""Stores the statistics of sessions for their groups, and reads them as evidence in later diagnoses."""

from collections.abc import Mapping
from dataclasses import replace
from datetime import datetime

from estimator.errors import SessionError
from estimator.groups import GroupFinding, SessionStatistics, statistics_of
from estimator.groups.fixed import EMPIRICAL
from estimator.moments import written
from estimator.session import CALIBRATIONS, CalibrationSession
from service.groups.records import Group, Level
from service.groups.store import Groups, Statistics, read_group
from service.groups.words import holds, own_of_group
from service.ingest import read_upload
from service.models.records import SCOPES, Scope
from service.models.rules import in_force
from service.models.store import Models
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.sessions.records import StoredSession
from service.sessions.store import Sessions
from service.settings import VERSION
from service.storage import Storage
from service.storage.files import LOST
from service.storage.queries import Store
from service.units.store import Services, Units

LEVELS = {scope: Level(level) for level, scope in SCOPES.items()}
"""Level of the group whose findings can become part of a model, by the scope of the model."""


def tell_own(store: Store, scope: Scope, subject: str) -> None:
    """Stores the group's own findings from its stored answer, after that or the model in force changed."""
    group = Groups(store).find(LEVELS[scope], subject)
    answer = Groups(store).get(group)
    if answer is None or answer.document is None:
        return
    shown = read_group(answer.document)
    known = {r.cause for r in in_force(Models(store).of_subject(scope, subject))}
    unexplained = EMPIRICAL not in known and any(text.endswith(f"({group.name})") for text in shown.structures)
    Groups(store).put_own(group, own_of_group(group, unknown(store, group, shown.findings), unexplained=unexplained))


def unknown(store: Store, group: Group, findings: tuple[GroupFinding, ...]) -> tuple[GroupFinding, ...]:
    """The findings that no model in force holds."""
    accepted = in_force(Models(store).of_subject(SCOPES[group.level.value], group.name))
    return tuple(f for f in findings if not any(holds(revision, f) for revision in accepted))


def keep_statistics(storage: Storage, session: str, now: datetime) -> None:
    """Makes the statistics of a session that calibrates a block, where they are still to be made, and asks for the
    answers of its groups, who try again where the program failed."""
    with storage.database.writing() as store:
        stored = Sessions(store).get(session)
        if stored.programme not in CALIBRATIONS or not Statistics(store).begin(session, VERSION):
            return
    try:
        add_statistics(storage, session, stored.sha256, stored.filename)
    finally:
        with storage.database.writing() as store:
            groups = Groups(store).of_unit(stored.unit)
            WorkQueue(store, WorkKind.GROUP).enqueue_each((group.place for group in groups), now)


def add_statistics(storage: Storage, session: str, sha256: str, filename: str) -> None:
    """The numerical part, with no transaction open. A lost file is tried again when somebody asks."""
    try:
        record = statistics_of(read_upload(storage.files.content(sha256), filename))
    except LOST:
        with storage.database.writing() as store:
            Statistics(store).release(session)
    except SessionError as fault:
        with storage.database.writing() as store:
            Statistics(store).fail(session, str(fault))
    else:
        with storage.database.writing() as store:
            Statistics(store).keep(session, record)


def kept_before(store: Store, session: StoredSession) -> dict[str, SessionStatistics]:
    """Statistics of the accepted sessions of the unit's epoch that were measured before one, oldest first, by
    identifier.
    """
    if session.programme not in CALIBRATIONS:
        return {}
    unit = Units(store).key(session.unit)
    since = Services(store).began(unit, session.started_at)
    members = Groups(store).members(Group(Level.UNIT, unit, session.unit), since).pooled
    earlier = {m.session: m.started_at for m in members if m.started_at < session.started_at}
    found = Statistics(store).of(earlier)
    return {id: replace(found[id], started_at=written(at)) for id, at in earlier.items() if id in found}


def as_evidence(
    session: CalibrationSession, kept: Mapping[str, SessionStatistics], history: Mapping[str, CalibrationSession]
) -> list[SessionStatistics]:
    """Statistics of sessions with the same sensors, oldest first; made here for a session of the history that has none
    yet.
    """
    if session.programme not in CALIBRATIONS or not history:
        return []
    names = tuple(sensor.name for sensor in session.sensors)
    made = {id: kept.get(id) or statistics_of(earlier) for id, earlier in history.items()}
    older = {id: record for id, record in kept.items() if id not in made and record.sensors == names}
    return [replace(record, unit=session.unit) for record in (*older.values(), *made.values())]
