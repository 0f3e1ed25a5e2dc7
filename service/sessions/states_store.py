"""States of sessions and services, the references that engineers chose, and which records count."""

from dataclasses import asdict

from sqlalchemy import select, update

from service.kit.copying import copied
from service.sessions.doubt import Remedies
from service.sessions.states import RecordKind, RecordState, ReferenceChoice, StateChange, Step
from service.sessions.tables import RecordStateRow, ReferenceChoiceRow, SessionRow
from service.storage.queries import Queries
from service.units.tables import ServiceRow


class States(Queries):
    """The lives of records; a line is written once."""

    def add(
        self,
        kind: RecordKind,
        record: str,
        state: RecordState,
        step: Step,
        *,
        superseded_by: str | None = None,
        remedies: Remedies | None = None,
    ) -> None:
        """Writes another line of a record's life."""
        self._session.add(
            RecordStateRow(
                kind=kind,
                record=record,
                state=state,
                **vars(step),
                superseded_by=superseded_by,
                remedies=None if remedies is None else asdict(remedies),
            )
        )
        self._session.flush()

    def of(self, kind: RecordKind, record: str) -> tuple[StateChange, ...]:
        """The life of a record, oldest first; empty where it was accepted and remained so."""
        query = select(RecordStateRow).where(RecordStateRow.kind == kind, RecordStateRow.record == record)
        return tuple(map(state_change, self._session.scalars(query.order_by(RecordStateRow.id))))

    def put_session(self, id: str, state: RecordState, superseded_by: str | None = None) -> None:
        """Stores whether a session counts, and which one superseded it."""
        values = {"state": state, "superseded_by": superseded_by}
        changed = update(SessionRow).where(SessionRow.id == id).values(**values).returning(SessionRow.unit_id)
        self.touch(*self._session.scalars(changed))
        self._session.expire_all()

    def choose(self, unit: int, session: str, step: Step) -> None:
        """A session is chosen as the reference of its epoch."""
        self._session.add(ReferenceChoiceRow(unit_id=unit, session_id=session, **vars(step)))
        self._session.flush()

    def choices(self, unit: int) -> tuple[ReferenceChoice, ...]:
        """The references that engineers chose, oldest first."""
        query = select(ReferenceChoiceRow).where(ReferenceChoiceRow.unit_id == unit).order_by(ReferenceChoiceRow.id)
        return tuple(ReferenceChoice(r.session_id, r.who, r.at, r.why) for r in self._session.scalars(query))


def state_change(row: RecordStateRow) -> StateChange:
    """A stored line of a record's life."""
    return copied(StateChange, row, remedies=None if row.remedies is None else Remedies(**row.remedies))


IS_ACCEPTED = SessionRow.state == RecordState.ACCEPTED
"""Condition of sessions that count for their unit."""
IS_BREAK = ServiceRow.state == RecordState.ACCEPTED
"""Services that begin an epoch."""
