"""Which sessions a list holds, and in which order."""

from sqlalchemy import ColumnElement, case, select

from service.diagnosis.tables import DiagnosisRow
from service.sessions.decision import Verdict
from service.sessions.records import SessionOrder, SessionQuery
from service.sessions.tables import SessionRow
from service.stands.tables import StandRow
from service.storage.listing import Key, Listing
from service.types.tables import UnitTypeRow
from service.units.tables import UnitRow

SEVERITY = case({verdict.value: verdict.severity for verdict in Verdict}, value=SessionRow.verdict)
"""A number that orders verdicts from good to bad."""
LATEST = (Key(SessionRow.started_at, is_falling=True), Key(SessionRow.id, is_falling=True))
ORDERS = {
    SessionOrder.MEASURED: LATEST,
    SessionOrder.UPLOADED: (Key(SessionRow.uploaded_at, is_falling=True), Key(SessionRow.id, is_falling=True)),
    SessionOrder.VERDICT: (Key(SEVERITY, is_falling=True), *LATEST),
    SessionOrder.UNIT: (Key(UnitRow.serial), Key(SessionRow.started_at), Key(SessionRow.id)),
}


def _is_of(name: str) -> ColumnElement[bool]:
    of_type = select(UnitTypeRow.id).where(UnitTypeRow.name == name)
    return UnitRow.unit_type_id == of_type.scalar_subquery()


def _is_on(stand: str) -> ColumnElement[bool]:
    return SessionRow.stand_id == select(StandRow.id).where(StandRow.name == stand).scalar_subquery()


SESSIONS: Listing[SessionQuery] = Listing(
    name=SessionRow.id,
    keys=lambda wanted: ORDERS[wanted.order],
    conditions={
        "text": lambda text: UnitRow.serial.icontains(text, autoescape=True),
        "unit": lambda serial: UnitRow.serial == serial,
        "unit_type": _is_of,
        "stand": _is_on,
        "since": lambda since: SessionRow.started_at >= since,
        "until": lambda until: SessionRow.started_at < until,
        "state": lambda state: SessionRow.state == state,
        "verdict": lambda verdict: SessionRow.verdict == verdict,
        "is_reference": lambda is_so: SessionRow.is_reference.is_(is_so),
        "reserved": lambda _: DiagnosisRow.reservations.is_not(None),
    },
)
