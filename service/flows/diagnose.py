"""Flow: what the simulation gets wrong about a stored session, found once and kept.

A session without a diagnosis is one whose diagnosis is pending; whoever asks for it first makes it, and a starting
service makes those that were interrupted. So an acknowledged upload is never left without one.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from datetime import datetime
from threading import Lock

from estimator.diagnosis import diagnose as find_causes
from estimator.errors import SessionError
from estimator.results import COVERAGE
from estimator.session import DIAGNOSED, CalibrationSession
from service.flows.derive_again import Deriving
from service.flows.flagging.diagnosis import flag_diagnosis
from service.flows.question_session import question_diagnosed
from service.flows.weigh import Weighed, weigh, weighing_of
from service.ingest import read_upload
from service.judging.reservations import UNCHECKED
from service.log import log
from service.records.diagnosis import DiagnosisState, StoredDiagnosis, state_of
from service.records.session import StoredSession
from service.records.state import RecordState
from service.settings import VERSION
from service.storage import Files, Storage
from service.storage.diagnosis_document import diagnosis_to_dict, inapplicable_to_dict, read_diagnosis, written
from service.storage.files import LOST
from service.storage.store import Store
from service.words.diagnosis import NOT_APPLICABLE, cannot_be_diagnosed, fault_of_the_program, summary_of

MOST_EARLIER = 10
"""Earlier sessions of the unit that a diagnosis looks at."""
QUICK_BYTES, QUICK_EARLIER_BYTES = 40_000, 400_000
"""Files up to this size are diagnosed within the request that brought them: some tenths of a second."""
FAULTS = (ArithmeticError, AssertionError, AttributeError, LookupError, TypeError, ValueError)
"""What a mistake in the program ends in. A store or memory that is missing is none: it leaves the diagnosis pending."""


@dataclass(frozen=True)
class Task:
    """A stored session with what its diagnosis looks at."""

    session: StoredSession
    earlier: tuple[StoredSession, ...]
    """Of the same unit and epoch, oldest first."""
    model_revision: int

    @property
    def is_quick(self) -> bool:
        """Whether it is made within a request."""
        if self.session.programme not in DIAGNOSED:
            return True
        earlier = sum(past.size for past in self.earlier)
        return self.session.size <= QUICK_BYTES and earlier <= QUICK_EARLIER_BYTES


@dataclass(frozen=True)
class InProgress:
    """The sessions that this process is diagnosing."""

    _ids: set[str] = field(default_factory=set)
    _lock: Lock = field(default_factory=Lock)

    @contextmanager
    def claim(self, id: str) -> Iterator[bool]:
        """Whether the session is ours to diagnose until the block ends."""
        with self._lock:
            free = id not in self._ids
            self._ids.add(id)
        try:
            yield free
        finally:
            if free:
                with self._lock:
                    self._ids.discard(id)


def task_of(store: Store, id: str) -> Task:
    """What the diagnosis of a session looks at."""
    session = store.sessions.get(id)
    since, _ = store.services.around(store.units.key(session.unit), session.started_at)
    revisions = store.models.of_session(id)
    return Task(session, store.sessions.before(session, since, MOST_EARLIER), max((r.id for r in revisions), default=0))


def diagnose(storage: Storage, id: str, now: datetime) -> StoredDiagnosis:
    """The diagnosis of a session: the stored one, or a new one that is stored."""
    with storage.database.reading() as store:
        known = _known(store, id)
        if known is not None:
            return known
        task = task_of(store, id)
    made = _made(storage, task, now)
    with storage.database.writing() as store:
        if store.diagnoses.add_once(made):
            details = {"state": made.state.value, "summary": made.summary}
            store.audit.write(now, "diagnosis", "diagnose", id, details)
            flag_diagnosis(store, made, now)
            if made.found is not None:
                question_diagnosed(store, Deriving(storage.files, COVERAGE, now), id, made.found)
    return made


def diagnose_now_or_later(
    storage: Storage, id: str, now: datetime, later: Callable[[str], None], *, wait: bool = True
) -> StoredDiagnosis | None:
    """The diagnosis of a session where it is there or quickly made; otherwise ``later`` is asked for it."""
    with storage.database.reading() as store:
        known = _known(store, id)
        if known is not None:
            return known
        is_quick = wait and task_of(store, id).is_quick
    if is_quick:
        return diagnose(storage, id, now)
    later(id)
    return None


def _known(store: Store, id: str) -> StoredDiagnosis | None:
    """The stored diagnosis; None where there is none, or where an earlier version of the program failed to make it."""
    found = store.diagnoses.get(id)
    failed_before = found is not None and found.state is DiagnosisState.FAILED and found.estimator_version != VERSION
    return None if failed_before else found


def _made(storage: Storage, task: Task, now: datetime) -> StoredDiagnosis:
    """Reads the stored bytes again and looks for causes, where the programme is one that can show any.

    Where the program fails it says so, and this version does not try again; the next one does.
    """
    if task.session.programme not in DIAGNOSED:
        nothing = written(inapplicable_to_dict(task.session.unit))
        return replace(_nothing_found(task, DiagnosisState.NOT_APPLICABLE, NOT_APPLICABLE, now), document=nothing)
    try:
        return _found(storage, task, now)
    except SessionError as fault:
        return _failed(task, cannot_be_diagnosed(fault), now)
    except FAULTS as fault:
        log.error("diagnosis failed", session=task.session.id, estimator_version=VERSION, exc_info=fault)
        return _failed(task, fault_of_the_program(task.session.id), now)


def _found(storage: Storage, task: Task, now: datetime) -> StoredDiagnosis:
    """The session's causes, and its verdict with them in the model."""
    session = _read(storage.files, task.session)
    found = find_causes(session, _comparable(storage.files, task, session))
    document = written(diagnosis_to_dict(found))
    kept = read_diagnosis(document)
    with storage.database.reading() as store:
        by = weighing_of(store, task.session.id, session.block)
    weighed = Weighed(None, ()) if kept is None else weigh(session, kept, by)
    return replace(
        _nothing_found(task, state_of(found), summary_of(found), now),
        found=kept,
        document=document,
        verdict_after=weighed.verdict_after,
        reservations=weighed.reservations,
    )


def _failed(task: Task, summary: str, now: datetime) -> StoredDiagnosis:
    """Why there is none: the verdict was not checked."""
    return replace(_nothing_found(task, DiagnosisState.FAILED, summary, now), reservations=UNCHECKED)


def _nothing_found(task: Task, state: DiagnosisState, summary: str, now: datetime) -> StoredDiagnosis:
    """What it came to in one line, and no more."""
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
    return read_upload(files.content(stored.sha256), stored.filename)


def _comparable(files: Files, task: Task, session: CalibrationSession) -> list[CalibrationSession]:
    """Earlier sessions of the same sensors measured in the same way; a lost file is passed over.

    One that is questioned is compared with none: it cannot be as it says, and everything about it would seem new.
    """
    found = []
    for past in () if task.session.state is RecordState.QUESTIONED else task.earlier:
        try:
            earlier = _read(files, past)
        except (*LOST, SessionError):
            continue
        if _sensors(earlier) == _sensors(session):
            found.append(earlier)
    return found


def _sensors(session: CalibrationSession) -> list[tuple[str, str]]:
    return [(sensor.name, sensor.kind) for sensor in session.sensors]
