"""What is derived of a unit's accepted sessions: who is the reference, what was decided, what it tells of flags."""

from collections.abc import Iterable
from datetime import datetime

from sqlalchemy import delete, func, select, update

from service.records.decision import Judged
from service.records.derivation import Counted, Told
from service.records.flag import Concern, FlagState, Matter, NoticeKind
from service.storage.queries.accepted import IS_ACCEPTED
from service.storage.queries.base import Queries
from service.storage.queries.sessions import NOT_JUDGED, worst_columns
from service.storage.tables import (
    CalibrationRow,
    CommonMotionRow,
    DecisionRow,
    DiagnosisRow,
    FlagRow,
    NoticeRow,
    SessionRow,
    UnitRow,
)

Key = tuple[str, str]
"""Matter and place of a flag."""
Moment = tuple[datetime, str]
"""When a session was measured, and its id: the order of a unit's records."""


class Derivations(Queries):
    """The derived part of sessions."""

    def counted(self, unit: int) -> tuple[Counted, ...]:
        """The accepted sessions of a unit in order of time."""
        query = select(
            SessionRow.id, SessionRow.block, SessionRow.programme, SessionRow.started_at, SessionRow.revision,
            SessionRow.is_reference, SessionRow.basis,
        ).where(SessionRow.unit_id == unit, IS_ACCEPTED)  # fmt: skip
        rows = self._session.execute(query.order_by(SessionRow.started_at, SessionRow.id))
        return tuple(Counted(*row) for row in rows)

    def computed_at(self, id: str) -> datetime:
        """When the calibration in force of a session was computed."""
        query = select(CalibrationRow.computed_at).join(
            SessionRow, (SessionRow.id == CalibrationRow.session_id) & (SessionRow.revision == CalibrationRow.revision)
        )
        return self._session.scalars(query.where(SessionRow.id == id)).one()

    def put_references(self, unit: int, references: Iterable[str]) -> None:
        """Says which of a unit's sessions others are judged against."""
        wanted = SessionRow.id.in_(tuple(references))
        own = (SessionRow.unit_id == unit, SessionRow.is_reference != wanted)
        self._session.execute(update(SessionRow).where(*own).values(is_reference=wanted))
        self._session.expire_all()

    def put_revision(self, id: str, revision: int) -> None:
        """Makes a session speak for its calibration of a revision; the ones before stay where they are."""
        own = update(SessionRow).where(SessionRow.id == id)
        self._session.execute(own.values(revision=revision, basis=NOT_JUDGED))
        self._session.expire_all()

    def wait(self, ids: Iterable[str]) -> None:
        """Leaves sessions to be judged later."""
        self._session.execute(update(SessionRow).where(SessionRow.id.in_(tuple(ids))).values(basis=NOT_JUDGED))
        self._session.expire_all()

    def waiting(self) -> tuple[str, ...]:
        """Serial numbers of units with accepted sessions that are to be judged."""
        query = select(UnitRow.serial).join(SessionRow, SessionRow.unit_id == UnitRow.id)
        query = query.where(SessionRow.basis == NOT_JUDGED, IS_ACCEPTED)
        return tuple(self._session.scalars(query.distinct().order_by(UnitRow.serial)))

    def waiting_of(self, serial: str) -> int:
        """How many accepted sessions of a unit are to be judged."""
        query = select(func.count()).select_from(SessionRow).join(UnitRow, UnitRow.id == SessionRow.unit_id)
        own = (UnitRow.serial == serial, SessionRow.basis == NOT_JUDGED, IS_ACCEPTED)
        return self._session.scalar(query.where(*own)) or 0

    def put_judged(self, id: str, revision: int, judged: Judged, basis: str, told: Told | None) -> None:
        """What was decided of a session under its revision, in place of what was; the calibration stays."""
        for table in (DecisionRow, CommonMotionRow):
            self._session.execute(delete(table).where(table.session_id == id, table.revision == revision))
        summary = {"verdict": judged.verdict, "reason": judged.reason, **worst_columns(judged.worst)}
        tells = None if told is None else told_to_dict(told)
        own = update(SessionRow).where(SessionRow.id == id)
        self._session.execute(own.values(basis=basis, tells=tells, revision=revision, **summary))
        under = update(CalibrationRow).where(CalibrationRow.session_id == id, CalibrationRow.revision == revision)
        self._session.execute(under.values(**summary))
        self._session.expire_all()

    def tell(self, id: str, told: Told) -> None:
        """Keeps what the diagnosis of a session tells."""
        own = update(DiagnosisRow).where(DiagnosisRow.session_id == id)
        self._session.execute(own.values(tells=told_to_dict(told)))
        self._session.expire_all()

    def told(self, unit: int) -> tuple[tuple[Moment, Told | None, Told | None, bool], ...]:
        """What every accepted session of a unit tells, in order of time: by its verdict and by its diagnosis.

        None where that was not kept or is not there; last whether the session was judged before it was kept.
        """
        query = (
            select(SessionRow.started_at, SessionRow.id, SessionRow.tells, DiagnosisRow.tells, SessionRow.basis)
            .outerjoin(DiagnosisRow, DiagnosisRow.session_id == SessionRow.id)
            .where(SessionRow.unit_id == unit, IS_ACCEPTED)
            .order_by(SessionRow.started_at, SessionRow.id)
        )
        return tuple(
            ((at, id), _told(verdict), _told(diagnosis), basis is None)
            for at, id, verdict, diagnosis, basis in self._session.execute(query)
        )

    def settled(self, unit: int, by_service: str) -> dict[Key, Moment]:
        """The last session that a flag spoke of when a person resolved it, by matter and place."""
        own = (FlagRow.unit_id == unit, FlagRow.state == FlagState.RESOLVED)
        by_person = select(NoticeRow.flag_id).where(NoticeRow.kind == NoticeKind.RESOLVED, NoticeRow.who != by_service)
        query = select(FlagRow.matter, FlagRow.place, SessionRow.started_at, SessionRow.id).join(
            SessionRow, SessionRow.id == FlagRow.session_id
        )
        found: dict[Key, Moment] = {}
        for matter, place, at, id in self._session.execute(query.where(*own, FlagRow.id.in_(by_person))):
            found[matter, place] = max(found.get((matter, place), (at, id)), (at, id))
        return found

    def forget_diagnoses(self, unit: int, since: datetime, but: Iterable[str]) -> tuple[str, ...]:
        """Diagnoses from a date on looked at what has changed since: they are to be made again; all but some."""
        self.touch(unit)
        later = select(SessionRow.id).where(
            SessionRow.unit_id == unit, SessionRow.started_at >= since, SessionRow.id.not_in(tuple(but))
        )
        gone = delete(DiagnosisRow).where(DiagnosisRow.session_id.in_(later)).returning(DiagnosisRow.session_id)
        return tuple(sorted(self._session.scalars(gone)))


def told_to_dict(told: Told) -> dict[str, list[list[str | int]]]:
    """As the store keeps it."""
    concerns: list[list[str | int]] = [[c.matter.value, c.place, c.severity, c.summary] for c in told.concerns]
    return {"concerns": concerns, "clear": [list(line) for line in told.clear]}


def _told(document: dict[str, list[list[str | int]]] | None) -> Told | None:
    if document is None:
        return None
    concerns = tuple(
        Concern(Matter(str(matter)), str(place), int(severity), str(summary))
        for matter, place, severity, summary in document["concerns"]
    )
    clear = tuple((str(matter), str(place), str(why)) for matter, place, why in document["clear"])
    return Told(concerns, clear)
