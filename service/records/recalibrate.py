"""A unit's stored sessions computed again under the models in force."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from datetime import datetime

from pydantic import computed_field

from estimator.errors import SessionError
from estimator.results import Calibration
from estimator.session import IN_SERVICE
from service.ingest import read_upload
from service.ingest.checked import as_checked
from service.jobs.records import JobFailure, RecalibrationPiece
from service.jobs.store import Jobs
from service.jobs.words import left_in_words
from service.judging.calibrate import CalibrationBasis, calibrate, rests_on_model
from service.judging.judge import furthest, moved_parameters, moved_verdicts
from service.judging.reference import known_unit
from service.judging.store import Derivations
from service.kit.answer import Hidden, answer
from service.models.records import (
    LeftSession,
    Model,
    ModelRevision,
    MovedParameter,
    MovedVerdict,
    Recomputed,
    Scope,
    Task,
)
from service.models.rules import model_of
from service.models.store import Models, Recomputations
from service.records.derive_again import NOTHING_FORESEEN, Derived, Deriving, derive_again, foresee_revisions
from service.records.follow import follow
from service.records.judge_again import Foreseen
from service.records.keep import MadeCalibration, keep, made
from service.records.reception import Reception
from service.sessions.calibrations_store import Calibrations, SessionNoises
from service.sessions.history_store import History
from service.sessions.records import ParameterValue, StoredSession
from service.sessions.store import Sessions
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.files import LOST
from service.storage.queries import Store
from service.units.store import Units


@answer
@dataclass(frozen=True)
class Recalibrated:
    """Result of computing a unit's stored sessions again."""

    unit: str
    """Serial number of the unit."""
    sessions: int
    """Sessions of the unit."""
    recomputed: int
    """Sessions with a new calibration under the model in force."""
    unchanged: int
    """Sessions that had one already."""
    kept: Hidden[tuple[LeftSession, ...]]
    """Sessions that cannot be calibrated under it, or whose file is lost; they keep their calibration."""
    revision: int
    """The latest model revision that any of them rests on; 0 is the baseline."""
    verdicts: Hidden[tuple[MovedVerdict, ...]] = ()
    """Sessions of the unit that have another verdict since."""
    furthest: Hidden[MovedParameter | None] = None
    """The parameter that moved most."""

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def left(self) -> int:
        """Sessions that cannot be calibrated under it and keep their calibration."""
        return len(self.kept)


def nothing(store: Store, done: Recalibrated) -> None:
    """Records nothing, the default."""


def recalibrate(
    storage: Storage,
    serial: str,
    now: datetime,
    *,
    coverage_factor: float = 2.0,
    who: str = "engineer",
    until: int | None = None,
    record: Callable[[Store, Recalibrated], None] = nothing,
) -> Recalibrated:
    """Computes every session of a unit under its model, those that do not count too, and judges what rests on them.

    ``until``: the last revision that counts, so that what each of several moved can be distinguished; None for all.
    ``record`` belongs to the transaction that puts it in force.
    """
    sources = _sources(storage, serial, until)
    outcomes = [_recalibrated(storage, source) for source in sources]
    stored = [source.session for source in sources]
    new = [outcome for outcome in outcomes if isinstance(outcome, _Recomputed)]
    context, derived = Deriving(storage.files, coverage_factor, now, at_once=None), None
    foreseen = _foreseen(storage, context, serial, new)
    with storage.database.writing() as store:
        if new:
            Units(store).hold(serial)
        before = {session.id: session for session in Sessions(store).of_unit(serial)}
        put = [replace(r, session=before[r.session.id]) for r in new]
        put = [r for r in put if r.session.revision < r.model.revision]
        if put:
            derived = _put_in_force(store, context, serial, put, foreseen)
        after = {session.id: session for session in Sessions(store).of_unit(serial)}
        _write_down(store, context, [(before[r.session.id], after[r.session.id]) for r in put], who)
        done = _report(serial, stored, outcomes, tuple(moved_verdicts(before, tuple(after.values()))))
        if put:
            _credit(store, Task(done.revision, serial), done, now)
        record(store, done)
    if derived is not None:
        follow(storage, context, serial, derived)
    return done


@dataclass(frozen=True)
class _Source:
    session: StoredSession
    model: Model
    """Model in force now."""
    values: tuple[ParameterValue, ...]
    """Parameters as they were computed before."""
    recording: Calibration | None
    """The calibration of a recording in service."""

    @property
    def is_behind(self) -> bool:
        """Whether another model concerns it than the one that it was computed under."""
        return self.model.revision > self.session.revision and rests_on_model(self.session.programme)


def _sources(storage: Storage, serial: str, until: int | None) -> list[_Source]:
    with storage.database.reading() as store:
        unit, stored = Units(store).key(serial), Sessions(store).of_unit(serial)
        revisions = [r for r in Models(store).of_unit(serial) if until is None or r.id <= until]
        models = {s.id: model_of(_concerning(revisions, s.stand), s.started_at) for s in stored}
        behind = [s for s in stored if models[s.id].revision > s.revision]
        values = History(store).in_force(unit) if behind else {}
        recordings = Calibrations(store).in_force([s.id for s in behind if s.programme == IN_SERVICE])
    return [_Source(s, models[s.id], values.get(s.id, ()), recordings.get(s.id)) for s in stored]


def _concerning(revisions: Iterable[ModelRevision], stand: str | None) -> list[ModelRevision]:
    """Revisions of a unit's model that concern its sessions on a stand."""
    return [r for r in revisions if r.scope is not Scope.STAND or r.subject == stand]


def _report(
    serial: str,
    stored: Sequence[StoredSession],
    outcomes: "Sequence[_Recomputed | LeftSession | None]",
    moved: tuple[MovedVerdict, ...],
) -> Recalibrated:
    pairs = zip(outcomes, stored, strict=True)
    used = [new.model.revision if isinstance(new, _Recomputed) else old.revision for new, old in pairs]
    made = [outcome for outcome in outcomes if isinstance(outcome, _Recomputed)]
    return Recalibrated(
        unit=serial,
        sessions=len(stored),
        recomputed=len(made),
        unchanged=outcomes.count(None),
        kept=tuple(outcome for outcome in outcomes if isinstance(outcome, LeftSession)),
        revision=max(used, default=0),
        verdicts=moved,
        furthest=furthest([parameter for r in made for parameter in r.moved]),
    )


@dataclass(frozen=True, eq=False)
class _Recomputed:
    session: StoredSession
    model: Model
    made: MadeCalibration
    moved: tuple[MovedParameter, ...]


def _recalibrated(storage: Storage, source: _Source) -> _Recomputed | LeftSession | None:
    """One session under the model in force, why it cannot be, or None where it is already.

    A recording keeps its calibration here: it is compared anew with the reference that was computed again.
    """
    stored, model = source.session, source.model
    if not source.is_behind:
        return None
    if source.recording is not None:
        return _Recomputed(stored, model, made(source.recording), ())
    try:
        session = read_upload(storage.files.content(stored.sha256), stored.filename)
        found = calibrate(
            as_checked(session, stored.started_at, stored.unit), CalibrationBasis(model, None)
        ).calibration
    except (*LOST, SessionError) as fault:
        return LeftSession(stored.id, str(fault))
    result = made(found)
    return _Recomputed(stored, model, result, tuple(moved_parameters(stored.id, source.values, result.values)))


def _foreseen(storage: Storage, context: Deriving, serial: str, new: Sequence[_Recomputed]) -> Foreseen:
    if not new:
        return NOTHING_FORESEEN
    made = {r.session.id: (r.model.revision, r.made.calibration) for r in new}
    with storage.database.reading() as store:
        return foresee_revisions(store, context, serial, made, min(r.session.started_at for r in new))


def _put_in_force(
    store: Store, context: Deriving, serial: str, new: Sequence[_Recomputed], foreseen: Foreseen
) -> Derived:
    """Other calibrations beside the ones before, in force from now on, with what follows from them, also of sessions
    that are judged against one of them."""
    unit = Units(store).key(serial)
    revisions = {r.session.id: r.model.revision for r in new}
    Derivations(store).put_revisions(revisions)
    keep(store, unit, [(replace(r.session, revision=r.model.revision), r.made) for r in new], context.at)
    SessionNoises(store).carry(revisions)
    made = {r.session.id: r.made.calibration for r in new}
    known, since = known_unit(store, unit, made, foreseen.references), min(r.session.started_at for r in new)
    return derive_again(store, context, serial, since, tuple(made), known=known, foreseen=foreseen)


def _write_down(
    store: Store, context: Deriving, changed: Sequence[tuple[StoredSession, StoredSession]], who: str
) -> None:
    for was, now in changed:
        details = {"revision": now.revision, "verdict": now.verdict.value, "before": was.verdict.value}
        Audit(store).write(context.at, who, "recalibrate", now.id, details)


def recompute_beside(reception: Reception, now: datetime) -> None:
    """Wakes the background work; without any, the recomputation is done at once."""
    reception.ring()
    while not reception.is_dated_later:
        with reception.storage.database.reading() as store:
            waiting = Recomputations(store).waiting(now, 1)
        if not waiting:
            return
        recompute(reception.storage, waiting[0], now, reception.coverage_factor)


def recompute(storage: Storage, task: Task, now: datetime, coverage_factor: float) -> None:
    """Computes a unit's sessions again for a task. Nothing is overwritten: earlier results stay readable under their
    revision.
    """

    with storage.database.reading() as store:
        who = Models(store).get(task.revision).accepted_by
    recalibrate(
        storage,
        task.unit,
        now,
        coverage_factor=coverage_factor,
        who=who,
        until=task.revision,
        record=lambda store, done: _credit(store, task, done, now),
    )


def _credit(store: Store, task: Task, done: Recalibrated, now: datetime) -> None:
    """Records a unit's result with the revision that brought it, once, whoever asked for the recomputation."""
    outcome = Recomputed(done.sessions, done.recomputed, done.left, done.verdicts, done.furthest)
    if Recomputations(store).settle(task, outcome, now):
        left = JobFailure(task.unit, left_in_words(done.left)) if done.left else None
        Jobs(store).count_unit(task.revision, RecalibrationPiece(done.recomputed, len(done.verdicts), left), now)
