"""Flow: a unit's stored sessions, computed again under the model that is in force now; nothing is overwritten."""

from collections.abc import Callable, Sequence
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
from service.judging.moved import furthest, moved_parameters, moved_verdicts
from service.records.model import Model
from service.records.recomputation import LeftSession, MovedParameter, MovedVerdict
from service.records.session import StoredSession
from service.storage import Storage
from service.storage.files import LOST
from service.storage.store import Store


@dataclass(frozen=True)
class Recalibrated:
    """What became of a unit's stored sessions under the model in force."""

    unit: str
    sessions: int
    recomputed: int
    unchanged: int
    """Computed under this model before."""
    kept: tuple[LeftSession, ...]
    """Sessions that cannot be calibrated under it, or whose file is lost; they keep what they have."""
    revision: int
    """The latest revision that any of them rests on."""
    verdicts: tuple[MovedVerdict, ...] = ()
    """Sessions of the unit that have another verdict since."""
    furthest: MovedParameter | None = None
    """The parameter that moved most."""

    @property
    def left(self) -> int:
        """How many sessions keep what they have."""
        return len(self.kept)


def nothing(store: Store, done: Recalibrated) -> None:
    """What else is done with it unless somebody says so."""


def recalibrate(
    storage: Storage,
    serial: str,
    now: datetime,
    *,
    coverage_factor: float = 2.0,
    who: str = "engineer",
    until: int | None = None,
    then: Callable[[Store, Recalibrated], None] = nothing,
) -> Recalibrated:
    """Computes every session of a unit under its model, those that do not count too, and judges what rests on them.

    ``until``: the last revision that counts, so that what each of several moved can be told apart; None for all.
    ``then`` belongs to the transaction that puts it in force.
    """
    with storage.database.reading() as store:
        store.units.key(serial)
        stored = store.sessions.of_unit(serial)
    outcomes = [_recalibrated(storage, session, until) for session in stored]
    made = [one for one in outcomes if isinstance(one, _Made)]
    way = Deriving(storage.files, coverage_factor, now, at_once=None)
    with storage.database.writing() as store:
        moved = _put_in_force(store, way, serial, made, who) if made else ()
        done = _told(serial, stored, outcomes, moved)
        then(store, done)
    return done


def _told(
    serial: str,
    stored: Sequence[StoredSession],
    outcomes: "Sequence[_Made | LeftSession | None]",
    moved: tuple[MovedVerdict, ...],
) -> Recalibrated:
    used = [
        one.model.revision if isinstance(one, _Made) else s.revision for one, s in zip(outcomes, stored, strict=True)
    ]
    made = [one for one in outcomes if isinstance(one, _Made)]
    return Recalibrated(
        unit=serial,
        sessions=len(stored),
        recomputed=len(made),
        unchanged=outcomes.count(None),
        kept=tuple(one for one in outcomes if isinstance(one, LeftSession)),
        revision=max(used, default=0),
        verdicts=moved,
        furthest=furthest([one for each in made for one in each.moved]),
    )


@dataclass(frozen=True, eq=False)
class _Made:
    """A session computed again."""

    session: StoredSession
    model: Model
    calibration: Calibration
    moved: tuple[MovedParameter, ...]


def _recalibrated(storage: Storage, stored: StoredSession, until: int | None) -> _Made | LeftSession | None:
    """One session under the model in force, why it cannot be, or None where it is already.

    A recording keeps its calibration here: it is compared anew with the reference that was computed again.
    """
    with storage.database.reading() as store:
        revisions = [r for r in store.models.of_session(stored.id) if until is None or r.id <= until]
        model, known = model_of(revisions, stored.started_at), store.calibrations.get(stored.id)
    if model.revision <= stored.revision or not rests_on_model(stored.programme):
        return None
    if stored.programme == IN_SERVICE:
        return _Made(stored, model, known, ())
    try:
        session = read_upload(storage.files.content(stored.sha256), stored.filename)
        found = calibrate(as_checked(session, stored.started_at), Basis(model, None)).calibration
    except (*LOST, SessionError) as fault:
        return LeftSession(stored.id, str(fault))
    return _Made(stored, model, found, tuple(moved_parameters(stored.id, known, found)))


def _put_in_force(
    store: Store, way: Deriving, serial: str, made: Sequence[_Made], who: str
) -> tuple[MovedVerdict, ...]:
    """Other calibrations beside the ones before, in force from now on, with what follows from them; what moved, also
    of sessions that are judged against one of them."""
    unit = store.units.hold(serial)
    before = {session.id: session for session in store.sessions.of_unit(serial)}
    new = [one for one in made if before[one.session.id].revision < one.model.revision]
    for one in new:
        store.derivations.put_revision(one.session.id, one.model.revision)
        keep(store, unit, store.sessions.get(one.session.id), one.calibration, way.at)
    if not new:
        return ()
    touched = [one.session.id for one in made]
    derive_again(store, way, serial, min(one.session.started_at for one in new), touched)
    for one in new:
        known, now = before[one.session.id], store.sessions.get(one.session.id)
        details = {"revision": now.revision, "verdict": now.verdict.value, "before": known.verdict.value}
        store.audit.write(way.at, who, "recalibrate", now.id, details)
    return tuple(moved_verdicts(before, store.sessions.of_unit(serial)))
