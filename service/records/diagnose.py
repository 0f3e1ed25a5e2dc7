"""Flow: the diagnosis of a stored session, made once and stored.

A session without a diagnosis is one whose diagnosis is pending. An upload asks for it within its own transaction, and
background processes make it, or else its first reader does: see `service.work.loop`. So an acknowledged upload is never
left without one.
"""

from dataclasses import dataclass, replace
from datetime import datetime

from estimator import diagnose as find_causes
from estimator.errors import SessionError
from estimator.results import COVERAGE
from estimator.session import DIAGNOSED, CalibrationSession
from service.diagnosis.records import StoredDiagnosis, state_of
from service.diagnosis.store import Diagnoses, inapplicable_to_dict, read_diagnosis
from service.diagnosis.words.diagnosis import NOT_APPLICABLE, cannot_be_diagnosed, fault_of_the_program, summary_of
from service.diagnosis.words.gain import concerned, gain_in_words
from service.groups.changes import as_evidence, keep_statistics, kept_before
from service.ingest import read_upload
from service.ingest.checked import dated
from service.judging.reservations import UNCHECKED
from service.kit.failure import with_last_try
from service.kit.lock_order import outside_writing
from service.kit.log import log
from service.models.store import Models
from service.outlook.explained import explains
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.changes import question_diagnosed
from service.records.derive_again import NOTHING_LEFT, Derived, Deriving
from service.records.flagging.fold import flag_diagnosis
from service.records.follow import follow
from service.records.keep import keep_noise
from service.records.weigh import Weighed, unlooked, weigh, weighing_of
from service.sessions.records import DiagnosisState, StoredSession
from service.sessions.states import RecordState
from service.sessions.store import Sessions
from service.settings import VERSION
from service.storage import Files, Storage
from service.storage.audit import Audit
from service.storage.files import LOST
from service.storage.json_text import STORED, json_text
from service.storage.queries import Store
from service.units.store import Services, Units

MOST_EARLIER = 10
"""Earlier sessions of the unit that a diagnosis looks at."""


@dataclass(frozen=True)
class DiagnosisTask:
    """A stored session with the input of its diagnosis."""

    session: StoredSession
    earlier: tuple[StoredSession, ...]
    """Earlier sessions of the same unit and epoch, oldest first."""
    model_revision: int


def task_of(store: Store, id: str) -> DiagnosisTask:
    """The input for the diagnosis of a session."""
    session = Sessions(store).get(id)
    since = Services(store).began(Units(store).key(session.unit), session.started_at)
    revisions = Models(store).of_session(id)
    return DiagnosisTask(
        session, Sessions(store).before(session, since, MOST_EARLIER), max((r.id for r in revisions), default=0)
    )


def diagnose(storage: Storage, id: str, now: datetime, coverage_factor: float = COVERAGE) -> StoredDiagnosis:
    """The diagnosis of a session: the stored one, or a new one that is stored.

    Where its input changes meanwhile it is made anew.
    """
    context = Deriving(storage.files, coverage_factor, now)
    while True:
        with storage.database.reading() as store:
            known = known_of(store, id)
            if known is not None:
                return known
            task, asked = task_of(store, id), WorkQueue(store, WorkKind.DIAGNOSIS).get(id)
        made = _made(storage, task, now)
        with storage.database.writing() as store:
            kept = _keep(store, context, task.session.unit, made, None if asked is None else asked.ticket)
        if kept is not None:
            follow(storage, context, task.session.unit, kept)
            keep_noise(storage, id, now)
            if made.state is not DiagnosisState.FAILED:
                keep_statistics(storage, id, now)
            return made


def give_up(storage: Storage, id: str, now: datetime) -> None:
    """Stores of a session that the program failed at its diagnosis; this version does not try again."""
    with storage.database.reading() as store:
        task, asked = task_of(store, id), WorkQueue(store, WorkKind.DIAGNOSIS).get(id)
    log.error("diagnosis given up", session=id, estimator_version=VERSION)
    summary = with_last_try(fault_of_the_program(id), "" if asked is None else asked.failed)
    made, context = _failed(task, summary, now), Deriving(storage.files, COVERAGE, now)
    with storage.database.writing() as store:
        _keep(store, context, task.session.unit, made, None if asked is None else asked.ticket)


def _keep(store: Store, context: Deriving, unit: str, made: StoredDiagnosis, ticket: str | None) -> Derived | None:
    """Stores a diagnosis made from current records, unless another one was made meanwhile, and returns the remaining
    derivations; None where it is outdated.
    """
    Units(store).hold(unit)
    if not WorkQueue(store, WorkKind.DIAGNOSIS).settle(made.session, ticket):
        return None
    derived = None
    if Diagnoses(store).add_once(made):
        details = {"state": made.state.value, "summary": made.summary}
        Audit(store).write(context.at, "diagnosis", "diagnose", made.session, details)
        flag_diagnosis(store, made, context.at)
        is_counted = Sessions(store).get(made.session).state is RecordState.ACCEPTED
        if made.found is not None and is_counted and explains(made.found):
            WorkQueue(store, WorkKind.OUTLOOK).enqueue_again(unit, context.at)
        if made.found is not None:
            derived = question_diagnosed(store, context, made.session, made.found)
    return derived or NOTHING_LEFT


def known_of(store: Store, id: str) -> StoredDiagnosis | None:
    """The stored diagnosis; None where there is none, or where an earlier version of the program failed to make it."""
    found = Diagnoses(store).get(id)
    failed_before = found is not None and found.state is DiagnosisState.FAILED and found.estimator_version != VERSION
    return None if failed_before else found


@outside_writing
def _made(storage: Storage, task: DiagnosisTask, now: datetime) -> StoredDiagnosis:
    """Reads the stored bytes again and looks for causes, where the programme is one that can show any."""
    if task.session.programme not in DIAGNOSED:
        nothing = json_text(inapplicable_to_dict(task.session.unit))
        inapplicable = _nothing_found(task, DiagnosisState.NOT_APPLICABLE, NOT_APPLICABLE, now)
        return replace(inapplicable, document=nothing, reservations=unlooked(storage, task.session.id))
    try:
        return _found(storage, task, now)
    except SessionError as fault:
        return _failed(task, cannot_be_diagnosed(fault), now)


def _found(storage: Storage, task: DiagnosisTask, now: datetime) -> StoredDiagnosis:
    """The session's causes, and its verdict with them in the model."""
    session = _read(storage.files, task.session)
    earlier = _comparable(storage.files, task, session)
    with storage.database.reading() as store:
        kept = kept_before(store, task.session)
    found = find_causes(session, tuple(earlier.values()), records=as_evidence(session, kept, earlier))
    document = json_text(STORED.written(found))
    read = read_diagnosis(document)
    with storage.database.reading() as store:
        weighing = weighing_of(store, task.session.id, session.block)
    weighed = Weighed(None, ()) if read is None else weigh(session, read, weighing)
    return replace(
        _nothing_found(task, state_of(found), summary_of(found), now),
        found=read,
        document=document,
        gain_in_words=gain_in_words(found.gain, concerned(found.findings)) if found.findings else "",
        verdict_after=weighed.verdict_after,
        reservations=weighed.reservations,
    )


def _failed(task: DiagnosisTask, summary: str, now: datetime) -> StoredDiagnosis:
    """The result of a failed diagnosis, with the reason: the verdict was not checked."""
    return replace(_nothing_found(task, DiagnosisState.FAILED, summary, now), reservations=UNCHECKED)


def _nothing_found(task: DiagnosisTask, state: DiagnosisState, summary: str, now: datetime) -> StoredDiagnosis:
    """The result of a diagnosis in one line, without causes."""
    return StoredDiagnosis(
        session=task.session.id,
        model_revision=task.model_revision,
        state=state,
        summary=summary,
        found=None,
        document=None,
        verdict_after=None,
        estimator_version=VERSION,
        created_at=now,
    )


def _read(files: Files, stored: StoredSession) -> CalibrationSession:
    return dated(read_upload(files.content(stored.sha256), stored.filename), stored.started_at)


def _comparable(files: Files, task: DiagnosisTask, session: CalibrationSession) -> dict[str, CalibrationSession]:
    """Earlier sessions of the same sensors measured in the same way, oldest first, by their identifier; a lost file is
    passed over.

    One that is questioned is compared with none: it cannot be as it says, and everything about it would seem new.
    """
    found = {}
    for past in () if task.session.state is RecordState.QUESTIONED else task.earlier:
        try:
            earlier = _read(files, past)
        except (*LOST, SessionError):
            continue
        if _sensors(earlier) == _sensors(session):
            found[past.id] = earlier
    return found


def _sensors(session: CalibrationSession) -> list[tuple[str, str]]:
    return [(sensor.name, sensor.kind) for sensor in session.sensors]
