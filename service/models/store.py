"""Accepted causes as numbered revisions, and the units whose sessions are computed again for them."""

from dataclasses import asdict, dataclass
from datetime import datetime

from sqlalchemy import ColumnElement, String, and_, bindparam, cast, func, or_, select, update

from estimator.json_object import Json
from estimator.session import CALIBRATIONS, IN_SERVICE
from service.errors import NotFoundError
from service.kit.copying import copied
from service.models.records import (
    AcceptedFinding,
    ModelRevision,
    MovedParameter,
    MovedVerdict,
    Progress,
    Recomputation,
    Recomputed,
    Scope,
    Task,
    task_of,
)
from service.models.tables import ModelRow, RecomputationRow
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.queue.tables import WorkRow
from service.sessions.decision import Verdict
from service.sessions.tables import SessionRow
from service.stands.tables import StandRow
from service.storage.json_text import STORED
from service.storage.queries import Queries
from service.types.tables import UnitTypeRow
from service.units.tables import UnitRow


def evidence_to_dict(evidence: AcceptedFinding | None) -> Json:
    """The document of a revision's evidence; empty for a withdrawal."""
    return {} if evidence is None else STORED.written(evidence)


def evidence_from_dict(entry: Json) -> AcceptedFinding | None:
    """Reads a document of `evidence_to_dict`."""
    return STORED.read(AcceptedFinding, entry) if entry else None


OWNER = or_(
    and_(ModelRow.scope == Scope.UNIT, ModelRow.subject == UnitRow.serial),
    and_(ModelRow.scope == Scope.UNIT_TYPE, ModelRow.subject == UnitTypeRow.name),
    and_(ModelRow.scope == Scope.STAND, ModelRow.subject == StandRow.name),
)
"""Whether a revision is of the model of a session's unit, its type or its stand."""


@dataclass(frozen=True)
class ModelQuery:
    """Filter of revisions."""

    scope: Scope | None = None
    subject: str | None = None
    offset: int = 0
    limit: int = 100


class Models(Queries):
    """Numbered revisions; a row is written once."""

    def add(self, new: ModelRevision) -> ModelRevision:
        """Stores a revision under the next number."""
        values = {**vars(new), "sensors": list(new.sensors), "evidence": evidence_to_dict(new.evidence)}
        del values["id"]
        row = ModelRow(session_id=values.pop("session"), **values)
        self._session.add(row)
        self._session.flush()
        return _revision(row)

    def get(self, id: int) -> ModelRevision:
        """One revision; NotFoundError."""
        row = self._session.get(ModelRow, id)
        if row is None:
            raise NotFoundError("There is no model revision {id}.", id=id)
        return _revision(row)

    def of_subject(self, scope: Scope, subject: str) -> tuple[ModelRevision, ...]:
        """All revisions of one model, oldest first."""
        query = select(ModelRow).where(ModelRow.scope == scope, ModelRow.subject == subject).order_by(ModelRow.id)
        return tuple(map(_revision, self._session.scalars(query)))

    def page(self, filters: ModelQuery) -> tuple[ModelRevision, ...]:
        """Revisions, newest first."""
        query = select(ModelRow).order_by(ModelRow.id.desc())
        if filters.scope is not None:
            query = query.where(ModelRow.scope == filters.scope)
        if filters.subject is not None:
            query = query.where(ModelRow.subject == filters.subject)
        return tuple(map(_revision, self._session.scalars(query.offset(filters.offset).limit(filters.limit))))

    def for_upload(self, unit: str, new_type: str, stand: str | None) -> tuple[ModelRevision, ...]:
        """All revisions that concern a session yet to be stored, oldest first; a new unit has the new type."""
        parameters = {"serial": unit, "new_type": new_type, "stand": stand or ""}
        return tuple(map(_revision, self._session.scalars(_FOR_UPLOAD, parameters)))

    def of_session(self, id: str) -> tuple[ModelRevision, ...]:
        """All revisions that concern a stored session, oldest first, in one query."""
        query = (
            select(ModelRow)
            .select_from(SessionRow)
            .join(UnitRow, UnitRow.id == SessionRow.unit_id)
            .join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
            .outerjoin(StandRow, StandRow.id == SessionRow.stand_id)
            .join(ModelRow, OWNER)
            .where(SessionRow.id == id)
            .order_by(ModelRow.id)
        )
        return tuple(map(_revision, self._session.scalars(query)))

    def of_unit(self, serial: str) -> tuple[ModelRevision, ...]:
        """All revisions that concern any session of a unit, oldest first, in one query."""
        stands = (
            select(StandRow.name)
            .join(SessionRow, SessionRow.stand_id == StandRow.id)
            .join(UnitRow, UnitRow.id == SessionRow.unit_id)
            .where(UnitRow.serial == serial)
        )
        of_type = select(UnitTypeRow.name).join(UnitRow, UnitRow.unit_type_id == UnitTypeRow.id)
        owner = or_(
            and_(ModelRow.scope == Scope.UNIT, ModelRow.subject == serial),
            and_(ModelRow.scope == Scope.UNIT_TYPE, ModelRow.subject.in_(of_type.where(UnitRow.serial == serial))),
            and_(ModelRow.scope == Scope.STAND, ModelRow.subject.in_(stands)),
        )
        return tuple(map(_revision, self._session.scalars(select(ModelRow).where(owner).order_by(ModelRow.id))))

    def units_behind(self, after: str, limit: int) -> tuple[str, ...]:
        """Serial numbers, in order and after one, of units with sessions that a later revision concerns."""
        query = select(UnitRow.serial).join(UnitTypeRow).where(_is_behind(), UnitRow.serial > after)
        return tuple(self._session.scalars(query.order_by(UnitRow.serial).limit(limit)))

    def count_behind(self) -> int:
        """Number of such units."""
        return self._session.scalar(select(func.count(UnitRow.id)).join(UnitTypeRow).where(_is_behind())) or 0


_KNOWN_TYPE = (
    select(UnitTypeRow.name)
    .join(UnitRow, UnitRow.unit_type_id == UnitTypeRow.id)
    .where(UnitRow.serial == bindparam("serial"))
    .scalar_subquery()
)
_FOR_UPLOAD = (
    select(ModelRow)
    .where(
        or_(
            and_(ModelRow.scope == Scope.UNIT, ModelRow.subject == bindparam("serial")),
            and_(
                ModelRow.scope == Scope.UNIT_TYPE, ModelRow.subject == func.coalesce(_KNOWN_TYPE, bindparam("new_type"))
            ),
            and_(ModelRow.scope == Scope.STAND, ModelRow.subject == bindparam("stand")),
        )
    )
    .order_by(ModelRow.id)
)


def _is_behind() -> ColumnElement[bool]:
    """Whether a unit, joined with its type, has a session with an earlier revision than the current one."""
    later = (
        select(SessionRow.id)
        .outerjoin(StandRow, StandRow.id == SessionRow.stand_id)
        .join(ModelRow, OWNER)
        .where(SessionRow.unit_id == UnitRow.id, SessionRow.programme.in_((*CALIBRATIONS, IN_SERVICE)))
        .where(ModelRow.id > SessionRow.revision)
    )
    return later.correlate(UnitRow, UnitTypeRow).exists()


def _revision(row: ModelRow) -> ModelRevision:
    evidence = evidence_from_dict(row.evidence)
    return copied(ModelRevision, row, sensors=tuple(row.sensors), session=row.session_id, evidence=evidence)


class Recomputations(Queries):
    """Recomputations after model revisions, unit by unit."""

    def ask(self, revision: int, scope: Scope, subject: str, now: datetime) -> int:
        """Requests the recomputation of every unit concerned by a revision; returns their number."""
        query = select(UnitRow.id, UnitRow.serial).where(concerned(scope, subject)).order_by(UnitRow.id)
        found = self._session.execute(query).all()
        rows = [{"revision": revision, "unit_id": unit, "state": Progress.WAITING} for unit, _ in found]
        self.insert_all_once(RecomputationRow, rows)
        self._queue.enqueue_once((Task(revision, serial).key for _, serial in found), now)
        return len(found)

    def waiting(self, now: datetime, limit: int) -> tuple[Task, ...]:
        """Unclaimed tasks, the oldest request first."""
        return tuple(map(task_of, self._queue.waiting(now, limit)))

    def try_again(self) -> None:
        """Retries recomputations that were given up, as their work is."""
        statement = update(RecomputationRow).where(RecomputationRow.state == Progress.GIVEN_UP)
        self._session.execute(statement.values(state=Progress.WAITING, done_at=None))

    def give_up(self, task: Task, now: datetime) -> None:
        """Gives up: the sessions stay as they were."""
        self._session.execute(update(RecomputationRow).where(*_of(task)).values(state=Progress.GIVEN_UP, done_at=now))
        self._queue.give_up(task.key)

    def cancel(self, revision: int, now: datetime) -> None:
        """Cancels the unclaimed units of a revision."""
        conditions = (RecomputationRow.revision == revision, RecomputationRow.state == Progress.WAITING)
        query = select(RecomputationRow.unit_id, UnitRow.serial).join(UnitRow, UnitRow.id == RecomputationRow.unit_id)
        rows = self._session.execute(query.where(*conditions).with_for_update(of=RecomputationRow))
        units = {Task(revision, serial).key: unit for unit, serial in rows}
        unclaimed = [units[key] for key in self._queue.drop_free(units, now)]
        statement = update(RecomputationRow).where(*conditions, RecomputationRow.unit_id.in_(unclaimed))
        self._session.execute(statement.values(state=Progress.CANCELLED, done_at=now))

    def settle(self, task: Task, outcome: Recomputed, now: datetime) -> bool:
        """Stores the result of a unit, once, also where nobody asked for it; whether that was now."""
        document = {
            **asdict(outcome),
            "verdicts": [asdict(v) | {"started_at": v.started_at.isoformat()} for v in outcome.verdicts],
        }
        unit = self._session.scalar(select(UnitRow.id).where(UnitRow.serial == task.unit))
        row = {"revision": task.revision, "unit_id": unit, "state": Progress.WAITING}
        self.insert_all_once(RecomputationRow, [row])
        statement = update(RecomputationRow).where(*_of(task), RecomputationRow.state == Progress.WAITING)
        stored = statement.values(state=Progress.DONE, done_at=now, outcome=document).returning(
            RecomputationRow.unit_id
        )
        is_new = self._session.scalar(stored) is not None
        self._queue.drop(task.key)
        return is_new

    def of(self, revision: int) -> tuple[Recomputation, ...]:
        """Recomputations of a revision, by serial number."""
        query = select(RecomputationRow, UnitRow.serial, WorkRow.failed)
        query = query.join(UnitRow, UnitRow.id == RecomputationRow.unit_id).outerjoin(WorkRow, _WORK)
        rows = self._session.execute(query.where(RecomputationRow.revision == revision).order_by(UnitRow.serial))
        return tuple(
            Recomputation(
                serial,
                Progress(row.state),
                row.done_at,
                None if row.outcome is None else _read(row.outcome),
                failed or "",
            )
            for row, serial, failed in rows
        )

    @property
    def _queue(self) -> WorkQueue:
        return WorkQueue(self._store, WorkKind.RECOMPUTATION)


_KEY = UnitRow.serial + " " + cast(RecomputationRow.revision, String)
"""`Task.key`."""
_WORK = and_(WorkRow.kind == WorkKind.RECOMPUTATION, WorkRow.key == _KEY)


def concerned(scope: Scope, subject: str) -> ColumnElement[bool]:
    """Units of a scope."""
    match scope:
        case Scope.UNIT:
            return UnitRow.serial == subject
        case Scope.UNIT_TYPE:
            return UnitRow.unit_type_id.in_(select(UnitTypeRow.id).where(UnitTypeRow.name == subject))
        case Scope.STAND:
            units = select(SessionRow.unit_id).join(StandRow, StandRow.id == SessionRow.stand_id)
            return UnitRow.id.in_(units.where(StandRow.name == subject))


def _of(task: Task) -> tuple[ColumnElement[bool], ColumnElement[bool]]:
    unit = select(UnitRow.id).where(UnitRow.serial == task.unit).scalar_subquery()
    return RecomputationRow.revision == task.revision, RecomputationRow.unit_id == unit


def _read(document: Json) -> Recomputed:
    furthest = document["furthest"]
    return Recomputed(
        sessions=document["sessions"],
        recomputed=document["recomputed"],
        left=document["left"],
        verdicts=tuple(_moved(verdict) for verdict in document["verdicts"]),
        furthest=None if furthest is None else MovedParameter(**furthest),
    )


def _moved(document: dict[str, str]) -> MovedVerdict:
    at = datetime.fromisoformat(document["started_at"])
    return MovedVerdict(document["session"], at, Verdict(document["before"]), Verdict(document["after"]))
