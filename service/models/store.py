"""Accepted causes as numbered revisions, and the units whose sessions are computed again for them."""

from dataclasses import asdict, dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, and_, bindparam, func, or_, select, update

from estimator.session import CALIBRATIONS, IN_SERVICE
from service.errors import NotFoundError
from service.models.evidence_document import evidence_from_dict, evidence_to_dict
from service.models.records import (
    ModelRevision,
    MovedParameter,
    MovedVerdict,
    Progress,
    Recomputation,
    Recomputed,
    Scope,
    Task,
)
from service.models.tables import ModelRow, RecomputationRow
from service.sessions.decision import Verdict
from service.sessions.tables import SessionRow
from service.stands.tables import StandRow
from service.storage.queries import Queries
from service.types.tables import UnitTypeRow
from service.units.tables import UnitRow

OWNER = or_(
    and_(ModelRow.scope == Scope.UNIT, ModelRow.subject == UnitRow.serial),
    and_(ModelRow.scope == Scope.UNIT_TYPE, ModelRow.subject == UnitTypeRow.name),
    and_(ModelRow.scope == Scope.STAND, ModelRow.subject == StandRow.name),
)
"""Whether a revision is of the model of a session's unit, its type or its stand."""


@dataclass(frozen=True)
class ModelQuery:
    """Which revisions are wanted."""

    scope: Scope | None = None
    subject: str | None = None
    offset: int = 0
    limit: int = 100


class Models(Queries):
    """Numbered revisions; a row is written once."""

    def add(self, new: ModelRevision) -> ModelRevision:
        """Stores a revision under the next number."""
        row = ModelRow(
            scope=new.scope,
            subject=new.subject,
            cause=new.cause,
            sensors=list(new.sensors),
            session_id=new.session,
            evidence=evidence_to_dict(new.evidence),
            accepted_by=new.accepted_by,
            note=new.note,
            accepted_at=new.accepted_at,
            withdraws=new.withdraws,
        )
        self._session.add(row)
        self._session.flush()
        return _revision(row)

    def get(self, id: int) -> ModelRevision:
        """One revision; NotFoundError."""
        row = self._session.get(ModelRow, id)
        if row is None:
            raise NotFoundError(f"There is no model revision {id}.")
        return _revision(row)

    def of_subject(self, scope: Scope, subject: str) -> tuple[ModelRevision, ...]:
        """All revisions of one model, oldest first."""
        query = select(ModelRow).where(ModelRow.scope == scope, ModelRow.subject == subject).order_by(ModelRow.id)
        return tuple(map(_revision, self._session.scalars(query)))

    def page(self, wanted: ModelQuery) -> tuple[ModelRevision, ...]:
        """Revisions, newest first."""
        query = select(ModelRow).order_by(ModelRow.id.desc())
        if wanted.scope is not None:
            query = query.where(ModelRow.scope == wanted.scope)
        if wanted.subject is not None:
            query = query.where(ModelRow.subject == wanted.subject)
        return tuple(map(_revision, self._session.scalars(query.offset(wanted.offset).limit(wanted.limit))))

    def for_upload(self, unit: str, new_type: str, stand: str | None) -> tuple[ModelRevision, ...]:
        """All revisions that concern a session yet to be stored, oldest first; a new unit gets the new type."""
        named = {"serial": unit, "new_type": new_type, "stand": stand or ""}
        return tuple(map(_revision, self._session.scalars(_FOR_UPLOAD, named)))

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
        """Serial numbers, in order and after one, of units with sessions that a later revision than theirs concerns."""
        query = select(UnitRow.serial).join(UnitTypeRow).where(_is_behind(), UnitRow.serial > after)
        return tuple(self._session.scalars(query.order_by(UnitRow.serial).limit(limit)))

    def count_behind(self) -> int:
        """How many those are."""
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
    """Whether a unit, beside its type, has a session that rests on an earlier revision than concerns it now."""
    later = (
        select(SessionRow.id)
        .outerjoin(StandRow, StandRow.id == SessionRow.stand_id)
        .join(ModelRow, OWNER)
        .where(SessionRow.unit_id == UnitRow.id, SessionRow.programme.in_((*CALIBRATIONS, IN_SERVICE)))
        .where(ModelRow.id > SessionRow.revision)
    )
    return later.correlate(UnitRow, UnitTypeRow).exists()


def _revision(row: ModelRow) -> ModelRevision:
    return ModelRevision(
        id=row.id,
        scope=Scope(row.scope),
        subject=row.subject,
        cause=row.cause,
        sensors=tuple(row.sensors),
        session=row.session_id,
        evidence=evidence_from_dict(row.evidence),
        accepted_by=row.accepted_by,
        note=row.note,
        accepted_at=row.accepted_at,
        withdraws=row.withdraws,
    )


class Recomputations(Queries):
    """What model revisions brought, unit by unit."""

    def ask(self, revision: int, scope: Scope, subject: str, now: datetime) -> int:
        """Asks for every unit that a revision of a model concerns; returns how many those are."""
        units = select(UnitRow.id).where(concerned(scope, subject)).order_by(UnitRow.id)
        keys = tuple(self._session.scalars(units))
        for unit in keys:
            own = {"state": Progress.WAITING, "asked_at": now, "attempts": 0}
            self.insert_once(RecomputationRow, revision=revision, unit_id=unit, **own)
        return len(keys)

    def waiting(self, now: datetime, limit: int) -> tuple[Task, ...]:
        """What nobody is at, the one that was asked for first before all, and of a unit its oldest revision."""
        query = select(RecomputationRow.revision, UnitRow.serial).join(UnitRow, UnitRow.id == RecomputationRow.unit_id)
        order = (RecomputationRow.asked_at, RecomputationRow.revision, RecomputationRow.unit_id)
        found = self._session.execute(query.where(*_is_free(now)).order_by(*order).limit(limit))
        return tuple(Task(*row) for row in found)

    def claim(self, task: Task, now: datetime, until: datetime) -> int | None:
        """How often it was claimed, with this time, since a claim ended with a word; None where another is at it."""
        own = update(RecomputationRow).where(*_of(task), *_is_free(now))
        claimed = own.values(claimed_until=until, attempts=RecomputationRow.attempts + 1)
        return self._session.scalar(claimed.returning(RecomputationRow.attempts))

    def extend(self, task: Task, until: datetime) -> None:
        """Whoever claimed it is still at it."""
        self._session.execute(update(RecomputationRow).where(*_of(task)).values(claimed_until=until))

    def give_back(self, task: Task) -> None:
        """Whoever was at it died: the next one may take it at once."""
        self._session.execute(update(RecomputationRow).where(*_of(task)).values(claimed_until=None))

    def put_off(self, task: Task, until: datetime | None) -> None:
        """Gives it back after a word of why: nobody begins it before a time."""
        own = update(RecomputationRow).where(*_of(task))
        self._session.execute(own.values(claimed_until=until, attempts=0))

    def hold_up(self, task: Task, why: str) -> None:
        """Keeps why a try failed."""
        self._session.execute(update(RecomputationRow).where(*_of(task)).values(failed=why))

    def try_again(self) -> int:
        """What failed is tried at once, also what was given up; how many units that are."""
        failed = (RecomputationRow.state == Progress.WAITING) & RecomputationRow.failed.is_not(None)
        own = failed | (RecomputationRow.state == Progress.GIVEN_UP)
        anew = {"state": Progress.WAITING, "claimed_until": None, "attempts": 0, "failed": None, "done_at": None}
        free = update(RecomputationRow).where(own).values(**anew)
        return len(self._session.scalars(free.returning(RecomputationRow.unit_id)).all())

    def give_up(self, task: Task, now: datetime) -> None:
        """No process outlived it: its sessions keep what they have."""
        own = update(RecomputationRow).where(*_of(task))
        self._session.execute(own.values(state=Progress.GIVEN_UP, claimed_until=None, done_at=now))

    def cancel(self, revision: int, now: datetime) -> None:
        """Nobody begins the units of a revision that nobody is at."""
        free = update(RecomputationRow).where(RecomputationRow.revision == revision, *_is_free(now))
        self._session.execute(free.values(state=Progress.CANCELLED, done_at=now))

    def settle(self, task: Task, outcome: Recomputed, now: datetime) -> bool:
        """Keeps what became of a unit's sessions, once; whether that was now."""
        told = {
            **asdict(outcome),
            "verdicts": [asdict(one) | {"started_at": one.started_at.isoformat()} for one in outcome.verdicts],
        }
        own = update(RecomputationRow).where(*_of(task), RecomputationRow.state == Progress.WAITING)
        kept = own.values(state=Progress.DONE, claimed_until=None, done_at=now, outcome=told)
        return self._session.scalar(kept.returning(RecomputationRow.unit_id)) is not None

    def of(self, revision: int) -> tuple[Recomputation, ...]:
        """What a revision brought, by serial number."""
        query = select(RecomputationRow, UnitRow.serial).join(UnitRow, UnitRow.id == RecomputationRow.unit_id)
        rows = self._session.execute(query.where(RecomputationRow.revision == revision).order_by(UnitRow.serial))
        return tuple(
            Recomputation(
                serial,
                Progress(row.state),
                row.done_at,
                None if row.outcome is None else _read(row.outcome),
                row.failed or "",
            )
            for row, serial in rows
        )


def concerned(scope: Scope, subject: str) -> ColumnElement[bool]:
    """Units that a model, or work of this scope, is of."""
    match scope:
        case Scope.UNIT:
            return UnitRow.serial == subject
        case Scope.UNIT_TYPE:
            return UnitRow.unit_type_id.in_(select(UnitTypeRow.id).where(UnitTypeRow.name == subject))
        case Scope.STAND:
            on = select(SessionRow.unit_id).join(StandRow, StandRow.id == SessionRow.stand_id)
            return UnitRow.id.in_(on.where(StandRow.name == subject))


def _of(task: Task) -> tuple[ColumnElement[bool], ColumnElement[bool]]:
    unit = select(UnitRow.id).where(UnitRow.serial == task.unit).scalar_subquery()
    return RecomputationRow.revision == task.revision, RecomputationRow.unit_id == unit


def _is_free(now: datetime) -> tuple[ColumnElement[bool], ColumnElement[bool]]:
    until = RecomputationRow.claimed_until
    return RecomputationRow.state == Progress.WAITING, or_(until.is_(None), until <= now)


def _read(told: dict[str, Any]) -> Recomputed:
    """What `settle` wrote."""
    furthest = told["furthest"]
    return Recomputed(
        sessions=told["sessions"],
        recomputed=told["recomputed"],
        left=told["left"],
        verdicts=tuple(_moved(one) for one in told["verdicts"]),
        furthest=None if furthest is None else MovedParameter(**furthest),
    )


def _moved(one: dict[str, str]) -> MovedVerdict:
    at = datetime.fromisoformat(one["started_at"])
    return MovedVerdict(one["session"], at, Verdict(one["before"]), Verdict(one["after"]))
