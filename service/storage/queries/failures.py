"""Work beside the requests that has failed: how much of each kind, what and why, and to be tried again."""

from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import ColumnElement, Select, String, cast, delete, func, literal, select, union_all
from sqlalchemy.orm import InstrumentedAttribute

from service.records.diagnosis import DiagnosisState
from service.records.failure import Failed, FailedKind
from service.records.group import Level
from service.records.job import JobState
from service.records.recomputation import Progress
from service.records.webhook import DeliveryState
from service.storage.group_tables import GroupDiagnosisRow, PendingGroupRow, PendingSummaryRow
from service.storage.job_tables import JobRow
from service.storage.model_tables import RecomputationRow
from service.storage.pending_tables import FailedDerivationRow, PendingOutlookRow, PendingRow
from service.storage.queries.base import Queries
from service.storage.queries.groups import Groups
from service.storage.queries.pending import PendingDiagnoses
from service.storage.queries.pending_groups import PendingGroups, PendingSummaries
from service.storage.queries.pending_outlooks import PendingOutlooks
from service.storage.queries.recomputations import Recomputations
from service.storage.tables import DeliveryRow, DiagnosisRow, UnitRow
from service.words.diagnosis import cannot_be_diagnosed

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
        return tuple(Failed(FailedKind(kind), of, why) for kind, of, why in self._session.execute(query))

    def put_derivation(self, serial: str, why: str) -> None:
        """Keeps why sessions of a unit could not be judged again."""
        unit = self._session.scalar(select(UnitRow.id).where(UnitRow.serial == serial))
        new = self._upsert(FailedDerivationRow).values(unit_id=unit, failed=why)
        self._session.execute(new.on_conflict_do_update(index_elements=["unit_id"], set_={"failed": why}))

    def settle_derivation(self, unit: int) -> None:
        """They are judged."""
        self._session.execute(delete(FailedDerivationRow).where(FailedDerivationRow.unit_id == unit))

    def try_again(self) -> int:
        """Everything that failed in a queue is tried at once; how much that is."""
        queues = (PendingDiagnoses, PendingOutlooks, PendingGroups, PendingSummaries, Recomputations)
        return sum(queue(self._session).try_again() for queue in queues)

    def ask_anew(self, now: datetime) -> int:
        """The same of diagnoses and answers that were given up."""
        gone = delete(DiagnosisRow).where(_GIVEN_UP)
        sessions = tuple(self._session.scalars(gone.returning(DiagnosisRow.session_id)))
        PendingDiagnoses(self._session).add(sessions, now)
        of = (GroupDiagnosisRow.level, GroupDiagnosisRow.group_id)
        empty = delete(GroupDiagnosisRow).where(GroupDiagnosisRow.document.is_(None)).returning(*of)
        groups = [Groups(self._session).by_key(Level(level), id) for level, id in self._session.execute(empty)]
        PendingGroups(self._session).ask(groups, now)
        self._session.expire_all()
        return len(sessions) + len(groups)

    def _every(self, now: datetime) -> list[Select[str, str, str]]:
        outlook = _line(FailedKind.OUTLOOK, UnitRow.serial, PendingOutlookRow.failed)
        derivation = _line(FailedKind.DERIVATION, UnitRow.serial, FailedDerivationRow.failed)
        diagnosis = _line(FailedKind.DIAGNOSIS, PendingRow.session_id, PendingRow.failed)
        given_up = _line(FailedKind.DIAGNOSIS, DiagnosisRow.session_id, DiagnosisRow.summary)
        answer = _line(FailedKind.GROUP, _group(GroupDiagnosisRow), GroupDiagnosisRow.summary)
        return [
            outlook.join(PendingOutlookRow, PendingOutlookRow.unit_id == UnitRow.id).where(
                PendingOutlookRow.failed.is_not(None)
            ),
            derivation.join(FailedDerivationRow, FailedDerivationRow.unit_id == UnitRow.id),
            diagnosis.where(PendingRow.failed.is_not(None)),
            given_up.where(_GIVEN_UP),
            answer.where(GroupDiagnosisRow.document.is_(None)),
            *(_asked(kind, row) for kind, row in GROUPS),
            _models(),
            *_ended(now - RECENT),
        ]


_GIVEN_UP = (DiagnosisRow.state == DiagnosisState.FAILED) & ~DiagnosisRow.summary.startswith(cannot_be_diagnosed(""))
"""A session that lacks something is no failure of the program, and no other try helps it."""
GROUPS = ((FailedKind.GROUP, PendingGroupRow), (FailedKind.SUMMARY, PendingSummaryRow))


def _line(kind: FailedKind, of: Text, why: Text) -> Select[str, str, str]:
    return select(literal(kind.value).label("kind"), of.label("of"), why.label("why"))


def _group(row: type[GroupDiagnosisRow] | type[PendingGroupRow] | type[PendingSummaryRow]) -> ColumnElement[str]:
    return row.level + literal(" ") + cast(row.group_id, String)


def _asked(kind: FailedKind, row: type[PendingGroupRow] | type[PendingSummaryRow]) -> Select[str, str, str]:
    """A line a group, however often it is asked for."""
    found = _line(kind, _group(row), func.max(func.coalesce(row.failed, ""))).where(row.failed.is_not(None))
    return found.group_by(row.level, row.group_id)


def _models() -> Select[str, str, str]:
    why = func.coalesce(RecomputationRow.failed, literal("given up"))
    is_failed = (RecomputationRow.state == Progress.GIVEN_UP) | (
        (RecomputationRow.state == Progress.WAITING) & RecomputationRow.failed.is_not(None)
    )
    found = _line(FailedKind.RECOMPUTATION, UnitRow.serial, why).join(UnitRow, UnitRow.id == RecomputationRow.unit_id)
    return found.where(is_failed)


def _ended(since: datetime) -> tuple[Select[str, str, str], ...]:
    """Jobs that failed through no fault of their file, and messages that no receiver took."""
    job = _line(FailedKind.JOB, cast(JobRow.id, String), literal("see the page Jobs"))
    own = (JobRow.state == JobState.FAILED, JobRow.refusal.is_(None), JobRow.ended_at >= since)
    message = _line(FailedKind.MESSAGE, literal("webhook ") + cast(DeliveryRow.webhook_id, String), DeliveryRow.outcome)
    message = message.where(DeliveryRow.state == DeliveryState.FAILED, DeliveryRow.next_at >= since)
    return job.where(*own), message
