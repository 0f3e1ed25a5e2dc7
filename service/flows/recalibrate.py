"""Flow: a unit's stored sessions, computed again under the model that is in force now; nothing is overwritten."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from estimator.errors import SessionError
from estimator.results import Calibration
from estimator.session import IN_SERVICE
from service.flows.derive_again import Deriving, derive_again
from service.flows.keep import keep
from service.ingest import read_upload
from service.ingest.checked import as_checked
from service.judging.calibrate import Basis, calibrate, rests_on_model
from service.judging.model_in_force import model_of
from service.records.model import Model
from service.records.session import StoredSession
from service.storage import Storage
from service.storage.store import Store

UNCHANGED, LEFT = "unchanged", "left"
"""What becomes of a session that is not computed again."""


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
    """Computes every session of a unit under its model, those that do not count too, and judges what rests on them."""
    with storage.database.reading() as store:
        store.units.key(serial)
        stored = store.sessions.of_unit(serial)
    outcomes = [_recalibrated(storage, session) for session in stored]
    made = [one for one in outcomes if isinstance(one, _Made)]
    if made:
        way = Deriving(storage.files, coverage_factor, now, at_once=None)
        with storage.database.writing() as store:
            _put_in_force(store, way, serial, made, who)
    used = [
        one.model.revision if isinstance(one, _Made) else s.revision for one, s in zip(outcomes, stored, strict=True)
    ]
    counted = Counter(one for one in outcomes if isinstance(one, str))
    return Recalibrated(serial, len(stored), len(made), counted[UNCHANGED], counted[LEFT], max(used, default=0))


@dataclass(frozen=True, eq=False)
class _Made:
    """A session computed again."""

    session: StoredSession
    model: Model
    calibration: Calibration


def _recalibrated(storage: Storage, stored: StoredSession) -> _Made | str:
    """One session under the model in force, or what became of it instead.

    A recording keeps its calibration here: it is compared anew with the reference that was computed again.
    """
    with storage.database.reading() as store:
        model = model_of(store.models.of_session(stored.id))
        known = store.calibrations.get(stored.id) if stored.programme == IN_SERVICE else None
    if model.revision == stored.revision or not rests_on_model(stored.programme):
        return UNCHANGED
    if known is not None:
        return _Made(stored, model, known)
    try:
        session = read_upload(storage.files.content(stored.sha256), stored.filename)
        return _Made(stored, model, calibrate(as_checked(session, stored.started_at), Basis(model, None)).calibration)
    except SessionError:
        return LEFT


def _put_in_force(store: Store, way: Deriving, serial: str, made: Sequence[_Made], who: str) -> None:
    """Other calibrations beside the ones before, in force from now on, with what follows from them."""
    unit = store.units.hold(serial)
    before = {one.session.id: store.sessions.get(one.session.id) for one in made}
    new = [one for one in made if before[one.session.id].revision < one.model.revision]
    for one in new:
        store.derivations.put_revision(one.session.id, one.model.revision)
        keep(store, unit, store.sessions.get(one.session.id), one.calibration, way.at)
    if not new:
        return
    derive_again(store, way, serial, min(one.session.started_at for one in new), [s.id for s in before.values()])
    for one in new:
        known, now = before[one.session.id], store.sessions.get(one.session.id)
        details = {"revision": now.revision, "verdict": now.verdict.value, "before": known.verdict.value}
        store.audit.write(way.at, who, "recalibrate", now.id, details)
