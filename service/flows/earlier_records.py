"""Step: what was kept of a unit's earlier sessions, as evidence in the diagnosis of a later one."""

from collections.abc import Mapping
from dataclasses import replace

from estimator.groups import SessionStatistics, statistics_of
from estimator.moments import written
from estimator.session import CALIBRATIONS, CalibrationSession
from service.records.group import Group, Level
from service.records.session import StoredSession
from service.storage.store import Store


def kept_before(store: Store, session: StoredSession) -> dict[str, SessionStatistics]:
    """Of the accepted sessions of the unit's epoch that were measured before one, oldest first, by their identifier."""
    if session.programme not in CALIBRATIONS:
        return {}
    unit = store.units.key(session.unit)
    since, _ = store.services.around(unit, session.started_at)
    members = store.groups.members(Group(Level.UNIT, unit, session.unit), since).pooled
    earlier = {m.session: m.started_at for m in members if m.started_at < session.started_at}
    found = store.statistics.of(earlier)
    return {id: replace(found[id], started_at=written(at)) for id, at in earlier.items() if id in found}


def as_evidence(
    session: CalibrationSession, kept: Mapping[str, SessionStatistics], history: Mapping[str, CalibrationSession]
) -> list[SessionStatistics]:
    """Those of the same sensors, oldest first; of a session of the history that has none yet they are made here."""
    if session.programme not in CALIBRATIONS or not history:
        return []
    names = tuple(sensor.name for sensor in session.sensors)
    made = {id: kept.get(id) or statistics_of(earlier) for id, earlier in history.items()}
    older = {id: record for id, record in kept.items() if id not in made and record.sensors == names}
    return [replace(record, unit=session.unit) for record in (*older.values(), *made.values())]
