"""Long jobs: requested, done piece by piece, cancelled between two pieces, ended once. The queue holds their leases."""

from dataclasses import asdict
from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import ColumnElement, Select, String, cast, delete, func, literal, or_, select, union_all, update
from sqlalchemy.orm import InstrumentedAttribute

from estimator.json_object import Json
from service.diagnosis.tables import DiagnosisRow
from service.diagnosis.words.diagnosis import CANNOT
from service.errors import NotFoundError
from service.flags.records import DeliveryState
from service.flags.tables import DeliveryRow
from service.groups.tables import GroupDiagnosisRow
from service.jobs.records import Job, JobFailure, JobKind, JobState, Made, NewJob, RecalibrationPiece
from service.jobs.tables import JobRow
from service.kit.copying import copied
from service.kit.failure import Failed, FailedKind
from service.models.records import Scope, task_of
from service.models.store import Recomputations, concerned
from service.queue.records import WorkKind
from service.queue.store import RETRY_AT_ONCE, WorkQueue, work_of
from service.queue.tables import WorkRow
from service.sessions.records import DiagnosisState
from service.sessions.sent import Replaced, Sent
from service.storage.columns import is_made_of
from service.storage.queries import Queries
from service.units.tables import UnitRow

MOST_LISTED = 100
"""Failures listed by name; all are counted."""
LONGEST_REASON = 500
"""Characters of a reason."""


class Jobs(Queries):
    """Long jobs."""

    def add(self, new: NewJob, total: int, now: datetime) -> Job:
        """Adds a job and its request in the queue; the units of a changed model are queued separately."""
        sent = new.sent
        row = JobRow(
            kind=new.kind, scope=new.scope or "", subject=new.subject, form=new.form, language=new.language,
            revision=new.revision, who=new.who, account=new.account, state=JobState.WAITING, asked_at=now,
            cancelled_by="", done=0, total=total, cursor=0, recomputed=0, verdicts=0, failed=0, failures=[],
            filename="", size=0, sha256="" if sent is None else sent.sha256,
            sent=None if sent is None else asdict(sent), is_storing=False, session="",
        )  # fmt: skip
        self._session.add(row)
        self._session.flush()
        if new.kind is not JobKind.MODEL:
            self._queue(new.kind).enqueue_once((str(row.id),), now)
        return _record(row)

    def like(self, new: NewJob) -> Job | None:
        """The open job for the same work."""
        same = (JobRow.kind == new.kind, JobRow.scope == (new.scope or ""), JobRow.subject == new.subject)
        of_form = (JobRow.form == new.form, JobRow.language == new.language, JobRow.ended_at.is_(None))
        jobs = self._found(_JOBS.where(*same, *of_form).order_by(JobRow.id).limit(1))
        return jobs[0] if jobs else None

    def sending(self, sha256: str) -> tuple[Job, ...]:
        """Open jobs for a file of this content."""
        same = (JobRow.kind == JobKind.UPLOAD, JobRow.sha256 == sha256, JobRow.ended_at.is_(None))
        return self._found(_JOBS.where(*same).order_by(JobRow.id))

    def places(self) -> frozenset[str]:
        """The places of the files of open jobs."""
        conditions = (JobRow.kind == JobKind.UPLOAD, JobRow.ended_at.is_(None))
        return frozenset(
            sent["place"] for sent in self._session.scalars(select(JobRow.sent).where(*conditions)) if sent
        )

    def open_uploads(self, text: str | None = None) -> tuple[Job, ...]:
        """Received files that are not yet stored, the newest first; ``text`` is part of their names."""
        query = _JOBS.where(JobRow.kind == JobKind.UPLOAD, JobRow.ended_at.is_(None))
        if text:
            query = query.where(JobRow.subject.icontains(text, autoescape=True))
        return self._found(query.order_by(JobRow.id.desc()))

    def open_count(self) -> int:
        """Number of open jobs."""
        return self._session.scalar(select(func.count()).select_from(JobRow).where(JobRow.ended_at.is_(None))) or 0

    def get(self, id: int) -> Job:
        """One job; NotFoundError."""
        jobs = self._found(_JOBS.where(JobRow.id == id))
        if not jobs:
            raise NotFoundError("There is no job {id}.", id=id)
        return jobs[0]

    def page(self, most: int, *, before: int | None = None, account: str = "", subject: str = "") -> tuple[Job, ...]:
        """Jobs, the newest first: before one, of one account, about one subject."""
        query = _JOBS.order_by(JobRow.id.desc()).limit(most)
        if before is not None:
            query = query.where(JobRow.id < before)
        if account:
            query = query.where(JobRow.account == account)
        if subject:
            query = query.where(JobRow.subject == subject)
        return self._found(query)

    def units(self, scope: Scope | None, subject: str) -> int:
        """Number of units concerned."""
        query = select(func.count()).select_from(UnitRow)
        return self._session.scalar(query if scope is None else query.where(concerned(scope, subject))) or 0

    def next_unit(self, job: Job) -> tuple[int, str] | None:
        """Key and serial number of the next unit; None after the last one."""
        query = select(UnitRow.id, UnitRow.serial).where(UnitRow.id > job.cursor).order_by(UnitRow.id).limit(1)
        if job.scope is not None:
            query = query.where(concerned(job.scope, job.subject))
        row = self._session.execute(query).first()
        return None if row is None else (row[0], row[1])

    def begin(self, id: int, now: datetime) -> Job:
        """Starts the next piece, unless the job has ended."""
        begun = {"state": JobState.RUNNING, "begun_at": func.coalesce(JobRow.begun_at, now), "is_storing": False}
        self._put_if_open(id, **begun)
        return self.get(id)

    def advance(self, job: Job, cursor: int, piece: RecalibrationPiece, now: datetime) -> None:
        """Records a finished piece. Counted once, also where two processes did it because one was taken for dead."""
        values: dict[str, Any] = {}
        if piece.failure is not None:
            values["failed"] = JobRow.failed + 1
        if piece.failure is not None and len(job.failures) < MOST_LISTED:
            failure = {"subject": piece.failure.subject, "reason": piece.failure.reason[:LONGEST_REASON]}
            values["failures"] = [*map(vars, job.failures), failure]
        done = JobRow.done + 1
        changed = {"recomputed": JobRow.recomputed + piece.recomputed, "verdicts": JobRow.verdicts + piece.verdicts}
        counted = update(JobRow).where(JobRow.id == job.id, JobRow.cursor == job.cursor)
        counted = counted.values(cursor=cursor, done=done, **changed, **values)
        if self._session.scalar(counted.returning(JobRow.id)) is not None and job.kind is not JobKind.MODEL:
            self._queue(job.kind).requeue(str(job.id), now)

    def count_unit(self, revision: int, piece: RecalibrationPiece, now: datetime) -> None:
        """Records a finished unit of a changed model; the last one ends the job."""
        conditions = (JobRow.kind == JobKind.MODEL, JobRow.revision == revision)
        row = self._session.scalar(select(JobRow).where(*conditions).with_for_update())
        if row is None:  # asked for before jobs were kept
            return
        job = _record(row)
        if job.done >= job.total:  # a unit that was given up, and tried again
            return
        self.advance(job, job.cursor, piece, now)
        if job.is_open and job.done + 1 >= job.total:
            self.end(job.id, JobState.DONE, now)
        elif job.is_open:
            self._put(job.id, state=JobState.RUNNING, begun_at=job.begun_at or now)

    def end(self, id: int, state: JobState, now: datetime, **values: Any) -> bool:
        """Ends a job that is still open; whether it was."""
        query = update(JobRow).where(JobRow.id == id, JobRow.ended_at.is_(None))
        query = query.values(state=state, ended_at=now, **values)
        kind = self._session.scalar(query.returning(JobRow.kind))
        if kind is not None:
            self._queue(JobKind(kind)).drop(str(id))
        return kind is not None

    def finish(self, id: int, made: Made | None, now: datetime) -> bool:
        """Ends a job that is done, with its file."""
        if made is None:
            return self.end(id, JobState.DONE, now, total=JobRow.done)
        file = {"filename": made.filename, "size": made.size, "sha256": made.sha256, "kept_until": made.until}
        return self.end(id, JobState.DONE, now, done=1, **file)

    def fail(self, id: int, failure: JobFailure, now: datetime) -> bool:
        """Ends a job as failed."""
        document = {"subject": failure.subject, "reason": failure.reason[:LONGEST_REASON]}
        return self.end(id, JobState.FAILED, now, failed=1, failures=[document])

    def cancel(self, id: int, who: str, now: datetime) -> bool:
        """Cancels a job between two pieces; False where it has ended or its file is being stored."""
        self._session.execute(select(JobRow.id).where(JobRow.id == id).with_for_update())
        if self.get(id).is_storing:
            return False
        return self.end(id, JobState.CANCELLED, now, cancelled_by=who)

    def read_on(self, id: int, kilobytes: int, passes: int) -> bool:
        """Records the progress of reading a file; whether the job is still open."""
        return self._put_if_open(id, done=kilobytes, cursor=passes)

    def begin_storing(self, id: int) -> bool:
        """Marks the job as no longer cancellable; whether it is still open."""
        return self._put_if_open(id, is_storing=True)

    def take_in(self, id: int, session: str, now: datetime) -> bool:
        """Ends the job with the session of its file; whether it was still open."""
        return self.end(id, JobState.DONE, now, session=session, done=JobRow.total)

    def refuse(self, id: int, refusal: int, now: datetime) -> bool:
        """Ends the job with the refusal of its file; whether it was still open."""
        return self.end(id, JobState.FAILED, now, refusal=refusal)

    def outlived(self, now: datetime) -> tuple[int, ...]:
        """Jobs whose file has been stored for its time."""
        return tuple(self._session.scalars(select(JobRow.id).where(JobRow.kept_until <= now)))

    def forget_file(self, id: int) -> None:
        """Records that its file was removed."""
        self._put(id, kept_until=None)

    def _put(self, id: int, **values: Any) -> None:
        self._session.execute(update(JobRow).where(JobRow.id == id).values(**values))

    def _put_if_open(self, id: int, **values: Any) -> bool:
        statement = update(JobRow).where(JobRow.id == id, JobRow.ended_at.is_(None)).values(**values)
        return self._session.scalar(statement.returning(JobRow.id)) is not None

    def _found(self, query: Select[JobRow, str | None, datetime | None]) -> tuple[Job, ...]:
        rows = self._session.execute(query.execution_options(populate_existing=True))
        return tuple(_record(row, failed or "", is_leased=until is not None) for row, failed, until in rows)

    def _queue(self, kind: JobKind) -> WorkQueue:
        """Long files have a queue of their own."""
        return WorkQueue(self._store, WorkKind.UPLOAD if kind is JobKind.UPLOAD else WorkKind.JOB)


_WORK = or_(work_of(WorkKind.JOB, JobRow.id), work_of(WorkKind.UPLOAD, JobRow.id))
_JOBS = select(JobRow, WorkRow.failed, WorkRow.lease_until).outerjoin(WorkRow, _WORK)
"""Jobs with their lease in the queue."""


def _record(row: JobRow, held_up: str = "", *, is_leased: bool = False) -> Job:
    kept_until = row.kept_until
    return copied(
        Job,
        row,
        scope=Scope(row.scope) if row.scope else None,
        failures=tuple(JobFailure(**failure) for failure in row.failures),
        held_up=held_up[:LONGEST_REASON],
        made=None if kept_until is None else Made(row.filename, row.size, row.sha256, kept_until),
        sent=None if row.sent is None else _sent(row.sent),
        is_storing=row.is_storing and is_leased,
    )


def _sent(document: Json) -> Sent:
    replaces = document["replaces"]
    return Sent(**{**document, "replaces": None if replaces is None else Replaced(**replaces)})


RECENT = timedelta(days=7)
"""Time for which failed jobs and messages are listed: nothing else removes them."""


Text = ColumnElement[str] | InstrumentedAttribute[Any]
"""A column or expression of text."""


class Failures(Queries):
    """Failed work of all queues."""

    def counts(self, now: datetime) -> dict[FailedKind, int]:
        """Number of failures of each kind; every kind is a key."""
        failures = union_all(*self._every(now)).subquery()
        counted = self._session.execute(select(failures.c.kind, func.count()).group_by(failures.c.kind))
        return dict.fromkeys(FailedKind, 0) | {FailedKind(kind): number for kind, number in counted}

    def listed(self, now: datetime, limit: int) -> tuple[Failed, ...]:
        """Failures by kind and name, with the reason."""
        failures = union_all(*self._every(now)).subquery()
        query = (
            select(failures.c.kind, failures.c.of, failures.c.why).order_by(failures.c.kind, failures.c.of).limit(limit)
        )
        return tuple(_failed(FailedKind(kind), subject, why) for kind, subject, why in self._session.execute(query))

    def try_again(self) -> int:
        """Retries all failed work in the queue at once, except derivations, which are retried anyway; returns the
        number."""
        Recomputations(self._store).try_again()
        failed = update(WorkRow).where(_HAS_FAILED, WorkRow.kind != WorkKind.DERIVATION)
        rows = self._session.execute(failed.values(**RETRY_AT_ONCE).returning(WorkRow.kind, WorkRow.key))
        return len({(kind, key) for kind, key in rows})

    def request_given_up(self, now: datetime) -> int:
        """Requests again diagnoses and group answers that were given up; returns the number."""
        deleted = delete(DiagnosisRow).where(_GIVEN_UP)
        sessions = tuple(self._session.scalars(deleted.returning(DiagnosisRow.session_id)))
        WorkQueue(self._store, WorkKind.DIAGNOSIS).enqueue_once(sessions, now)
        unanswered = delete(GroupDiagnosisRow).where(GroupDiagnosisRow.document.is_(None)).returning(_PLACE)
        groups = tuple(self._session.scalars(unanswered))
        WorkQueue(self._store, WorkKind.GROUP).enqueue_each(groups, now)
        self._session.expire_all()
        return len(sessions) + len(groups)

    def _every(self, now: datetime) -> list[Select[str, str, str]]:
        waiting = select(
            WorkRow.kind.label("kind"),
            WorkRow.key.label("of"),
            func.max(func.coalesce(WorkRow.failed, "")).label("why"),
        )
        given_up = _line(FailedKind.DIAGNOSIS, DiagnosisRow.session_id, DiagnosisRow.summary)
        answer = _line(FailedKind.GROUP, _PLACE, GroupDiagnosisRow.summary)
        return [
            waiting.where(_HAS_FAILED).group_by(WorkRow.kind, WorkRow.key),
            given_up.where(_GIVEN_UP),
            answer.where(GroupDiagnosisRow.document.is_(None)),
            *_ended(now - RECENT),
        ]


_HAS_FAILED = WorkRow.failed.is_not(None) & WorkRow.kind.not_in((WorkKind.JOB, WorkKind.UPLOAD, WorkKind.MESSAGE))
"""Jobs and messages store their own outcome; until then they are attempted again."""
_GIVEN_UP = (DiagnosisRow.state == DiagnosisState.FAILED) & ~is_made_of(DiagnosisRow.summary, CANNOT)
"""A session that lacks something is not a failure of the program: another attempt does not help."""
_PLACE = GroupDiagnosisRow.level + literal(" ") + cast(GroupDiagnosisRow.group_id, String)
"""`Group.place`."""


def _line(kind: FailedKind, subject: Text, why: Text) -> Select[str, str, str]:
    return select(literal(kind.value).label("kind"), subject.label("of"), why.label("why"))


def _failed(kind: FailedKind, subject: str, why: str) -> Failed:
    return Failed(kind, task_of(subject).unit if kind is FailedKind.RECOMPUTATION else subject, why)


def _ended(since: datetime) -> tuple[Select[str, str, str], ...]:
    """Jobs that failed through no fault of their file, and messages that were not delivered."""
    job = _line(FailedKind.JOB, cast(JobRow.id, String), literal("see the page Jobs"))
    conditions = (JobRow.state == JobState.FAILED, JobRow.refusal.is_(None), JobRow.ended_at >= since)
    message = _line(FailedKind.MESSAGE, literal("webhook ") + cast(DeliveryRow.webhook_id, String), DeliveryRow.outcome)
    message = message.where(DeliveryRow.state == DeliveryState.FAILED, DeliveryRow.ended_at >= since)
    return job.where(*conditions), message
