"""Work beside the requests that has failed: how much of each kind, what and why, and to be tried again."""

from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import ColumnElement, Select, String, cast, delete, func, literal, select, union_all, update
from sqlalchemy.orm import InstrumentedAttribute

from service.diagnosis.tables import DiagnosisRow
from service.diagnosis.words.diagnosis import CANNOT
from service.flags.records import DeliveryState
from service.flags.tables import DeliveryRow
from service.groups.tables import GroupDiagnosisRow
from service.jobs.records import JobState
from service.jobs.tables import JobRow
from service.kit.failure import Failed, FailedKind
from service.models.records import task_of
from service.models.store import Recomputations
from service.queue.records import WorkKind
from service.queue.store import ANEW, WorkQueue
from service.queue.tables import WorkRow
from service.sessions.records import DiagnosisState
from service.storage.columns import is_made_of
from service.storage.queries import Queries

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
