"""Stored values behind the temperatures that a unit's calibrations cover, in one statement."""

from dataclasses import dataclass

from sqlalchemy import Subquery, or_, select

from estimator.health.temperature_law import TemperatureCorrection, TemperatureStep
from service.sessions.decision import Verdict
from service.sessions.records import StoredSession
from service.sessions.states_store import IS_ACCEPTED
from service.sessions.store import epoch_bounds, reference_query
from service.sessions.tables import CalibrationRow, DecisionRow, SessionRow
from service.storage.queries import Queries, lists
from service.units.tables import UnitRow


@dataclass(frozen=True)
class CoveringRows:
    """Stored temperatures of a unit up to a session."""

    reference: bytes | None
    """Calibration in force of the session that it is judged against; None where there is none."""
    measured: tuple[tuple[float | None, Verdict], ...]
    """Temperature, °C, and verdict of the earlier sessions of its epoch."""
    steps: tuple[TemperatureStep, ...]
    """Effects of the session's own temperature."""


class Covering(Queries):
    """The sessions and laws that cover temperatures."""

    def up_to(self, session: StoredSession, programmes: tuple[str, ...], most: int) -> CoveringRows:
        """Up to a session that is judged against those of some programmes, with so many earlier ones at most."""
        listed, reference, earlier, laws = (
            lists("reference", "earlier", "laws"),
            _reference(session, programmes),
            _earlier(session, most),
            _laws(session),
        )
        query = (
            select(listed.c.list, reference.c.document, earlier.c.temperature, earlier.c.verdict, laws.c.taken)
            .outerjoin(reference, listed.c.list == "reference")
            .outerjoin(earlier, listed.c.list == "earlier")
            .outerjoin(laws, listed.c.list == "laws")
        )
        rows = self._session.execute(query).all()
        return CoveringRows(
            reference=next((row.document for row in rows if row.document is not None), None),
            measured=tuple((row.temperature, Verdict(row.verdict)) for row in rows if row.verdict is not None),
            steps=tuple(TemperatureCorrection(**row.taken) for row in rows if row.taken is not None),
        )


def _reference(session: StoredSession, programmes: tuple[str, ...]) -> Subquery:
    unit = select(UnitRow.id).where(UnitRow.serial == session.unit).scalar_subquery()
    block = select(SessionRow.block).where(SessionRow.id == session.id).scalar_subquery()
    id = reference_query(unit, block, session.started_at, programmes).scalar_subquery()
    in_force = (CalibrationRow.session_id == SessionRow.id) & (CalibrationRow.revision == SessionRow.revision)
    return select(CalibrationRow.document).join(SessionRow, in_force).where(SessionRow.id == id).subquery()


def _earlier(session: StoredSession, most: int) -> Subquery:
    """The last sessions of the same programme, not before the epoch of the session."""
    since, _ = epoch_bounds(UnitRow.id.expression, session.started_at)
    query = select(SessionRow.temperature, SessionRow.verdict).join(UnitRow, UnitRow.id == SessionRow.unit_id)
    earlier = query.where(
        UnitRow.serial == session.unit,
        SessionRow.programme == session.programme,
        SessionRow.started_at < session.started_at,
        or_(since.is_(None), SessionRow.started_at >= since),
        IS_ACCEPTED,
    )
    return earlier.order_by(SessionRow.started_at.desc(), SessionRow.id.desc()).limit(most).subquery()


def _laws(session: StoredSession) -> Subquery:
    taken = DecisionRow.temperature_correction
    in_force = (DecisionRow.session_id == SessionRow.id) & (DecisionRow.revision == SessionRow.revision)
    query = select(taken.label("taken")).join(SessionRow, in_force)
    return query.where(SessionRow.id == session.id, taken.is_not(None)).subquery()
