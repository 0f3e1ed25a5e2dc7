"""Units whose sessions are computed again because a model changed: asked for, claimed by one process, kept."""

from dataclasses import asdict
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, or_, select, update

from service.records.decision import Verdict
from service.records.model import Scope
from service.records.recomputation import (
    MovedParameter,
    MovedVerdict,
    Progress,
    Recomputation,
    Recomputed,
    Task,
)
from service.storage.model_tables import RecomputationRow
from service.storage.queries.base import Queries
from service.storage.tables import SessionRow, StandRow, UnitRow, UnitTypeRow


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
