"""Flow: a unit's stored sessions, computed again under the model that is in force now; nothing is overwritten."""

from collections import Counter
from dataclasses import dataclass
from datetime import datetime

from estimator.errors import SessionError
from service.flows.flagging.settle import Occasion
from service.flows.flagging.verdict import flag_verdict
from service.flows.keep import keep
from service.flows.refresh_outlook import refresh_outlook
from service.ingest import read_upload
from service.ingest.checked import as_checked
from service.judging.calibrate import Calibrated, basis_of, calibrate, rests_on_model
from service.judging.judge import judge_in_epoch
from service.judging.model_in_force import model_of
from service.records.model import Model
from service.records.session import StoredSession
from service.storage import Storage
from service.storage.store import Store

RECOMPUTED, UNCHANGED, LEFT = "recomputed", "unchanged", "left"
"""What can become of a session."""


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
    occasion = Occasion(unit, latest, now)
    flag_verdict(store, occasion, store.sessions.get(latest), store.sessions.decisions(latest), was)


def _recalibrate(
    storage: Storage, stored: StoredSession, now: datetime, coverage_factor: float, who: str
) -> tuple[str, int]:
    """One session: what became of it and the revision that it now rests on."""
    with storage.database.reading() as store:
        model = model_of(store.models.of_session(stored.id))
    if model.revision == stored.revision or not rests_on_model(stored.programme):
        return UNCHANGED, stored.revision
    try:
        new = _recomputed(storage, stored, model)
    except SessionError:
        return LEFT, stored.revision
    with storage.database.writing() as store:
        _put_in_force(store, stored, new, coverage_factor, who=who, now=now)
    return RECOMPUTED, model.revision


def _recomputed(storage: Storage, stored: StoredSession, model: Model) -> Calibrated:
    """The stored bytes read and computed again; a recording is compared with the reference that was computed again."""
    session = read_upload(storage.files.read(stored.sha256), stored.filename)
    checked = as_checked(session, stored.started_at)
    with storage.database.reading() as store:
        basis = basis_of(store, checked, model)
    return calibrate(checked, basis)


def _put_in_force(
    store: Store, stored: StoredSession, new: Calibrated, coverage_factor: float, *, who: str, now: datetime
) -> None:
    """Another calibration with its decisions beside the ones before, in force from now on."""
    unit, id, revision = store.units.hold(stored.unit), stored.id, new.model.revision
    current = store.sessions.get(id)
    if current.revision >= revision:
        return
    judged = judge_in_epoch(store, unit, new, coverage_factor, is_reference=stored.is_reference)
    store.sessions.put_in_force(id, revision, judged)
    keep(store, unit, store.sessions.get(id), judged, now)
    details = {"revision": revision, "verdict": judged.verdict.value, "before": current.verdict.value}
    store.log.audit(now, who, "recalibrate", id, details)
