"""Accepted causes: numbered revisions of the models of units, unit types and stands."""

from dataclasses import dataclass

from sqlalchemy import ColumnElement, and_, bindparam, func, or_, select

from estimator.session import CALIBRATIONS, IN_SERVICE
from service.errors import NotFoundError
from service.records.model import ModelRevision, Scope
from service.storage.diagnosis_document import evidence_from_dict, evidence_to_dict
from service.storage.queries.base import Queries
from service.storage.tables import ModelRow, SessionRow, StandRow, UnitRow, UnitTypeRow

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
