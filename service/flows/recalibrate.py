"""Flow: a unit's stored sessions, computed again under the model that is in force now; nothing is overwritten."""

from collections import Counter
from dataclasses import dataclass
from datetime import datetime

from estimator.errors import SessionError
from estimator.results import Calibration
from estimator.session import IN_SERVICE, RATE_TABLE, ROTATION_ALIGNMENT, CalibrationSession, comparable
from service.flows.flagging.verdict import flag_verdict
from service.flows.refresh_outlook import refresh_outlook
from service.ingest import read_upload
from service.judging.in_service import Compared, compared, judge_recording, reference_in_force
from service.judging.judge import judge
from service.judging.model_in_force import calibrated, model_of
from service.judging.parameter_values import parameter_values
from service.records.decision import Judged
from service.records.model import Model
from service.records.session import StoredSession
from service.storage import Storage
from service.storage.store import Store

WITHOUT_MODEL = (ROTATION_ALIGNMENT, RATE_TABLE)
"""Programmes that no accepted cause changes."""
RECOMPUTED, UNCHANGED, LEFT = "recomputed", "unchanged", "left"


@dataclass(frozen=True)
class Recalibrated:
    """What became of a unit's stored sessions under the model in force."""

    unit: str
    sessions: int
    recomputed: int
    unchanged: int
    """Computed under this model before."""
    left: int
    """Sessions that cannot be calibrated under it; they keep what they have."""
    revision: int
    """The latest revision that any of them rests on."""


@dataclass(frozen=True)
class Recomputed:
    """A stored session with its calibration under another model."""

    stored: StoredSession
    session: CalibrationSession
    model: Model
    calibration: Calibration
    recording: Compared | None
    """A recording in service beside its unit's reference as it is now; None for every other programme."""


def recalibrate(
    storage: Storage, serial: str, now: datetime, *, coverage_factor: float = 2.0, who: str = "engineer"
) -> Recalibrated:
    """Computes and judges every session of a unit under its model; references first, because others hang on them."""
    with storage.database.reading() as store:
        store.units.key(serial)
        stored = store.sessions.of_unit(serial)
    outcome: Counter[str] = Counter()
    revision = 0
    for session in sorted(stored, key=lambda s: (not s.is_reference, s.started_at, s.id)):
        done, used = _recalibrate(storage, session, now, coverage_factor, who)
        outcome[done] += 1
        revision = max(revision, used)
    if outcome[RECOMPUTED]:
        with storage.database.writing() as store:
            refresh_outlook(store, serial)
            _settle_flags(store, serial, now)
    return Recalibrated(serial, len(stored), outcome[RECOMPUTED], outcome[UNCHANGED], outcome[LEFT], revision)


def _settle_flags(store: Store, serial: str, now: datetime) -> None:
    """The unit's latest session may have another verdict now."""
    unit = store.units.hold(serial)
    was = store.fleet.refresh(unit)
    latest = was.last_session
    flag_verdict(store, unit, store.sessions.get(latest), store.sessions.decisions(latest), was, now)


def _recalibrate(
    storage: Storage, stored: StoredSession, now: datetime, coverage_factor: float, who: str
) -> tuple[str, int]:
    """One session: what became of it and the revision that it now rests on."""
    with storage.database.reading() as store:
        model = model_of(store.models.of_session(stored.id))
    if model.revision == stored.revision or stored.programme in WITHOUT_MODEL:
        return UNCHANGED, stored.revision
    try:
        new = _recomputed(storage, stored, model)
    except SessionError:
        return LEFT, stored.revision
    with storage.database.writing() as store:
        _store(store, new, now, coverage_factor, who)
    return RECOMPUTED, model.revision


def _recomputed(storage: Storage, stored: StoredSession, model: Model) -> Recomputed:
    """The stored bytes read and computed again; a recording is compared with the reference that was computed again."""
    session = read_upload(storage.files.read(stored.sha256), stored.filename)
    if session.programme != IN_SERVICE:
        return Recomputed(stored, session, model, calibrated(session, model), None)
    with storage.database.reading() as store:
        reference = reference_in_force(store, session, stored.started_at)
    recording = compared(session, reference)
    return Recomputed(stored, session, model, recording.calibration, recording)


def _store(store: Store, new: Recomputed, now: datetime, coverage_factor: float, who: str) -> None:
    """Another calibration with its decisions beside the ones before, in force from now on."""
    unit, id, revision = store.units.hold(new.stored.unit), new.stored.id, new.model.revision
    current = store.sessions.get(id)
    if current.revision >= revision:
        return
    judged = _judged(store, unit, new, coverage_factor)
    store.calibrations.add(id, revision, judged, now)
    store.sessions.put_in_force(id, revision, judged)
    store.history.add(unit, store.sessions.get(id), parameter_values(new.calibration))
    store.sessions.add_decisions(id, judged.decisions, revision)
    store.sessions.add_motions(id, judged.motions, revision)
    details = {"revision": revision, "verdict": judged.verdict.value, "before": current.verdict.value}
    store.log.audit(now, who, "recalibrate", id, details)


def _judged(store: Store, unit: int, new: Recomputed, coverage_factor: float) -> Judged:
    if new.recording is not None:
        unit_type = store.unit_types.of_unit(new.session.unit)
        return judge_recording(new.session, new.recording, unit_type, coverage_factor)
    since, until = store.services.around(unit, new.stored.started_at)
    alike = comparable(new.session.programme)
    reference = store.sessions.reference(unit, new.session.block, since, until, alike)
    own = reference is None or new.stored.is_reference
    return judge(
        new.session,
        new.calibration,
        None if own or reference is None else store.calibrations.get(reference),
        store.unit_types.of_unit(new.session.unit),
        coverage_factor,
        after_service=since is not None,
    )
