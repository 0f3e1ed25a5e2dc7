"""Long work: asked for, done piece by piece, cancelled between two, ended once. The queue says who is at it."""

from dataclasses import asdict
from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import ColumnElement, Select, String, cast, delete, func, literal, or_, select, union_all, update
from sqlalchemy.orm import InstrumentedAttribute

from estimator.json_object import Json
from estimator.message import say
from service.diagnosis.tables import DiagnosisRow
from service.diagnosis.words.diagnosis import CANNOT
from service.errors import NotFoundError
from service.flags.records import DeliveryState
from service.flags.tables import DeliveryRow
from service.groups.tables import GroupDiagnosisRow
from service.jobs.records import Job, JobFailure, JobKind, JobState, Made, NewJob, Piece
from service.jobs.tables import JobRow
from service.kit.failure import Failed, FailedKind
from service.models.records import Scope, task_of
from service.models.store import Recomputations, concerned
from service.queue.records import WorkKind
from service.queue.store import ANEW, WorkQueue, work_of
from service.queue.tables import WorkRow
from service.sessions.records import DiagnosisState
from service.sessions.sent import Replaced, Sent
from service.storage.columns import is_made_of
from service.storage.queries import Queries
from service.units.tables import UnitRow

MOST_LISTED = 100
"""Failures that a job lists by name; it counts all."""
LONGEST_REASON = 500
"""Characters of one."""


class Jobs(Queries):
    """Long work that somebody asked for."""

    def add(self, new: NewJob, total: int, now: datetime) -> Job:
        """Keeps what is asked for, and asks for it in the queue; the units of a changed model are asked for apart."""
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
            self._queue(new.kind).ask_once((str(row.id),), now)
        return _record(row)

    def like(self, new: NewJob) -> Job | None:
        """The job that does the same and is still open."""
        same = (JobRow.kind == new.kind, JobRow.scope == (new.scope or ""), JobRow.subject == new.subject)
        of_form = (JobRow.form == new.form, JobRow.language == new.language, JobRow.ended_at.is_(None))
        found = self._found(_JOBS.where(*same, *of_form).order_by(JobRow.id).limit(1))
        return found[0] if found else None

    def sending(self, sha256: str) -> tuple[Job, ...]:
        """Open jobs that take in a file of this content."""
        same = (JobRow.kind == JobKind.UPLOAD, JobRow.sha256 == sha256, JobRow.ended_at.is_(None))
        return self._found(_JOBS.where(*same).order_by(JobRow.id))

    def places(self) -> frozenset[str]:
        """Of the files that open jobs take in."""
        own = (JobRow.kind == JobKind.UPLOAD, JobRow.ended_at.is_(None))
        return frozenset(sent["place"] for sent in self._session.scalars(select(JobRow.sent).where(*own)) if sent)

    def open_uploads(self, text: str | None = None) -> tuple[Job, ...]:
        """Files that were received and are not yet stored, the newest first; ``text`` is part of their names."""
        query = _JOBS.where(JobRow.kind == JobKind.UPLOAD, JobRow.ended_at.is_(None))
        if text:
            query = query.where(JobRow.subject.icontains(text, autoescape=True))
        return self._found(query.order_by(JobRow.id.desc()))

    def open_count(self) -> int:
        """How many jobs are still to be worked on."""
        return self._session.scalar(select(func.count()).select_from(JobRow).where(JobRow.ended_at.is_(None))) or 0

    def get(self, id: int) -> Job:
        """One job; NotFoundError."""
        found = self._found(_JOBS.where(JobRow.id == id))
        if not found:
            raise NotFoundError(say("There is no job {id}.", id=id))
        return found[0]

    def page(self, most: int, *, before: int | None = None, account: str = "", subject: str = "") -> tuple[Job, ...]:
        """Jobs, the newest first: from before one, of one account, about one subject."""
        query = _JOBS.order_by(JobRow.id.desc()).limit(most)
        if before is not None:
            query = query.where(JobRow.id < before)
        if account:
            query = query.where(JobRow.account == account)
        if subject:
            query = query.where(JobRow.subject == subject)
        return self._found(query)

    def units(self, scope: Scope | None, subject: str) -> int:
        """How many units are meant."""
        own = select(func.count()).select_from(UnitRow)
        return self._session.scalar(own if scope is None else own.where(concerned(scope, subject))) or 0

    def next_unit(self, job: Job) -> tuple[int, str] | None:
        """Key and serial number of the unit whose turn it is; None where all had theirs."""
        query = select(UnitRow.id, UnitRow.serial).where(UnitRow.id > job.cursor).order_by(UnitRow.id).limit(1)
        if job.scope is not None:
            query = query.where(concerned(job.scope, job.subject))
        found = self._session.execute(query).first()
        return None if found is None else (found[0], found[1])

    def begin(self, id: int, now: datetime) -> Job:
        """The job, whose next piece is begun now unless it has ended."""
        begun = {"state": JobState.RUNNING, "begun_at": func.coalesce(JobRow.begun_at, now), "is_storing": False}
        self._put_if_open(id, **begun)
        return self.get(id)

    def advance(self, job: Job, cursor: int, piece: Piece, now: datetime) -> None:
        """One more piece is whole. Counted once, also where two were at it because one was taken for dead."""
        own: dict[str, Any] = {}
        if piece.failure is not None:
            own["failed"] = JobRow.failed + 1
        if piece.failure is not None and len(job.failures) < MOST_LISTED:
            told = {"subject": piece.failure.subject, "reason": piece.failure.reason[:LONGEST_REASON]}
            own["failures"] = [*map(vars, job.failures), told]
        done = JobRow.done + 1
        changed = {"recomputed": JobRow.recomputed + piece.recomputed, "verdicts": JobRow.verdicts + piece.verdicts}
        counted = update(JobRow).where(JobRow.id == job.id, JobRow.cursor == job.cursor)
        counted = counted.values(cursor=cursor, done=done, **changed, **own)
        if self._session.scalar(counted.returning(JobRow.id)) is not None and job.kind is not JobKind.MODEL:
            self._queue(job.kind).next_turn(str(job.id), now)

    def count_unit(self, revision: int, piece: Piece, now: datetime) -> None:
        """One more unit of a changed model is whole; the last one ends the job."""
        own = (JobRow.kind == JobKind.MODEL, JobRow.revision == revision)
        row = self._session.scalar(select(JobRow).where(*own).with_for_update())
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

    def end(self, id: int, state: JobState, now: datetime, **own: Any) -> bool:
        """Ends it, unless somebody did before; whether that was so."""
        query = update(JobRow).where(JobRow.id == id, JobRow.ended_at.is_(None))
        query = query.values(state=state, ended_at=now, **own)
        kind = self._session.scalar(query.returning(JobRow.kind))
        if kind is not None:
            self._queue(JobKind(kind)).drop(str(id))
        return kind is not None

    def finish(self, id: int, made: Made | None, now: datetime) -> bool:
        """All of it is done; with the file that it made."""
        if made is None:
            return self.end(id, JobState.DONE, now, total=JobRow.done)
        file = {"filename": made.filename, "size": made.size, "sha256": made.sha256, "kept_until": made.until}
        return self.end(id, JobState.DONE, now, done=1, **file)

    def fail(self, id: int, failure: JobFailure, now: datetime) -> bool:
        """It cannot be done."""
        told = {"subject": failure.subject, "reason": failure.reason[:LONGEST_REASON]}
        return self.end(id, JobState.FAILED, now, failed=1, failures=[told])

    def cancel(self, id: int, who: str, now: datetime) -> bool:
        """Nobody begins its next piece; whether it was still open, and no file being stored."""
        self._session.execute(select(JobRow.id).where(JobRow.id == id).with_for_update())
        if self.get(id).is_storing:
            return False
        return self.end(id, JobState.CANCELLED, now, cancelled_by=who)

    def read_on(self, id: int, kilobytes: int, times: int) -> bool:
        """So much of a file was read, after so many times through all of it; whether that is still wanted."""
        return self._put_if_open(id, done=kilobytes, cursor=times)

    def begin_storing(self, id: int) -> bool:
        """From now on nobody cancels it; whether it is still wanted."""
        return self._put_if_open(id, is_storing=True)

    def take_in(self, id: int, session: str, now: datetime) -> bool:
        """Its file is this session; whether it was still open."""
        return self.end(id, JobState.DONE, now, session=session, done=JobRow.total)

    def refuse(self, id: int, refusal: int, now: datetime) -> bool:
        """Its file cannot be used; whether it was still open."""
        return self.end(id, JobState.FAILED, now, refusal=refusal)

    def outlived(self, now: datetime) -> tuple[int, ...]:
        """Jobs whose file has been kept for its time."""
        return tuple(self._session.scalars(select(JobRow.id).where(JobRow.kept_until <= now)))

    def forget_file(self, id: int) -> None:
        """Its file is gone."""
        self._put(id, kept_until=None)

    def _put(self, id: int, **values: Any) -> None:
        self._session.execute(update(JobRow).where(JobRow.id == id).values(**values))

    def _put_if_open(self, id: int, **values: Any) -> bool:
        own = update(JobRow).where(JobRow.id == id, JobRow.ended_at.is_(None)).values(**values)
        return self._session.scalar(own.returning(JobRow.id)) is not None

    def _found(self, query: Select[JobRow, str | None, datetime | None]) -> tuple[Job, ...]:
        rows = self._session.execute(query.execution_options(populate_existing=True))
        return tuple(_record(row, failed or "", is_leased=until is not None) for row, failed, until in rows)

    def _queue(self, kind: JobKind) -> WorkQueue:
        """Long files are worked on apart from the rest."""
        return WorkQueue(self._store, WorkKind.UPLOAD if kind is JobKind.UPLOAD else WorkKind.JOB)


_WORK = or_(work_of(WorkKind.JOB, JobRow.id), work_of(WorkKind.UPLOAD, JobRow.id))
_JOBS = select(JobRow, WorkRow.failed, WorkRow.lease_until).outerjoin(WorkRow, _WORK)
"""With what the queue knows of them."""


def _record(row: JobRow, held_up: str = "", *, is_leased: bool = False) -> Job:
    kept = row.kept_until
    return Job(
        id=row.id, kind=JobKind(row.kind), scope=Scope(row.scope) if row.scope else None, subject=row.subject,
        form=row.form, language=row.language, revision=row.revision, who=row.who, account=row.account,
        state=JobState(row.state),
        asked_at=row.asked_at, begun_at=row.begun_at, ended_at=row.ended_at, cancelled_by=row.cancelled_by,
        done=row.done, total=row.total, cursor=row.cursor, recomputed=row.recomputed, verdicts=row.verdicts,
        failed=row.failed, failures=tuple(JobFailure(**one) for one in row.failures),
        held_up=held_up[:LONGEST_REASON],
        made=None if kept is None else Made(row.filename, row.size, row.sha256, kept),
        sent=None if row.sent is None else _sent(row.sent), is_storing=row.is_storing and is_leased,
        session=row.session,
        refusal=row.refusal,
    )  # fmt: skip


def _sent(kept: Json) -> Sent:
    replaces = kept["replaces"]
    return Sent(**{**kept, "replaces": None if replaces is None else Replaced(**replaces)})


RECENT = timedelta(days=7)
"""For which jobs and messages that ended as failed are listed: nothing else removes them."""


Text = ColumnElement[str] | InstrumentedAttribute[Any]
"""A column of text, or what is made of one."""


class Failures(Queries):
    """Over all queues."""

    def counts(self, now: datetime) -> dict[FailedKind, int]:
        """How much of each kind; every kind is a key."""
        found = union_all(*self._every(now)).subquery()
        counted = self._session.execute(select(found.c.kind, func.count()).group_by(found.c.kind))
        return dict.fromkeys(FailedKind, 0) | {FailedKind(kind): number for kind, number in counted}

    def listed(self, now: datetime, most: int) -> tuple[Failed, ...]:
        """What and why, by kind and name."""
        found = union_all(*self._every(now)).subquery()
        query = select(found.c.kind, found.c.of, found.c.why).order_by(found.c.kind, found.c.of).limit(most)
        return tuple(_failed(FailedKind(kind), of, why) for kind, of, why in self._session.execute(query))

    def try_again(self) -> int:
        """Everything that failed in the queue is tried at once; how much that is. Verdicts are tried all the time."""
        Recomputations(self._store).try_again()
        failed = update(WorkRow).where(_HAS_FAILED, WorkRow.kind != WorkKind.DERIVATION)
        found = self._session.execute(failed.values(**ANEW).returning(WorkRow.kind, WorkRow.key))
        return len({(kind, key) for kind, key in found})

    def ask_anew(self, now: datetime) -> int:
        """The same of diagnoses and answers that were given up."""
        gone = delete(DiagnosisRow).where(_GIVEN_UP)
        sessions = tuple(self._session.scalars(gone.returning(DiagnosisRow.session_id)))
        WorkQueue(self._store, WorkKind.DIAGNOSIS).ask_once(sessions, now)
        empty = delete(GroupDiagnosisRow).where(GroupDiagnosisRow.document.is_(None)).returning(_PLACE)
        groups = tuple(self._session.scalars(empty))
        WorkQueue(self._store, WorkKind.GROUP).ask_each(groups, now)
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
"""Jobs and messages keep by themselves how they ended; until then they are tried again."""
_GIVEN_UP = (DiagnosisRow.state == DiagnosisState.FAILED) & ~is_made_of(DiagnosisRow.summary, CANNOT)
"""A session that lacks something is no failure of the program, and no other try helps it."""
_PLACE = GroupDiagnosisRow.level + literal(" ") + cast(GroupDiagnosisRow.group_id, String)
"""`Group.place`."""


def _line(kind: FailedKind, of: Text, why: Text) -> Select[str, str, str]:
    return select(literal(kind.value).label("kind"), of.label("of"), why.label("why"))


def _failed(kind: FailedKind, of: str, why: str) -> Failed:
    return Failed(kind, task_of(of).unit if kind is FailedKind.RECOMPUTATION else of, why)


def _ended(since: datetime) -> tuple[Select[str, str, str], ...]:
    """Jobs that failed through no fault of their file, and messages that no receiver took."""
    job = _line(FailedKind.JOB, cast(JobRow.id, String), literal("see the page Jobs"))
    own = (JobRow.state == JobState.FAILED, JobRow.refusal.is_(None), JobRow.ended_at >= since)
    message = _line(FailedKind.MESSAGE, literal("webhook ") + cast(DeliveryRow.webhook_id, String), DeliveryRow.outcome)
    message = message.where(DeliveryRow.state == DeliveryState.FAILED, DeliveryRow.ended_at >= since)
    return job.where(*own), message
