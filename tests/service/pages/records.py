"""Records for page tests: real calibrations of built sessions, judged by the real rule."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta

from estimator.calibration import calibrate
from estimator.reading import read_session
from estimator.results import Calibration
from service.fleet.condition import UnitSummary
from service.ingest.checked import as_checked
from service.judging.judge import judge
from service.judging.records import Usable, UseFacts
from service.judging.usable import usable
from service.papers.certified import SessionReport
from service.sessions.decision import Verdict
from service.sessions.records import HistoryPoint, StoredSession
from service.types.rules import type_of
from tests.builders import Document, accelerometer_block

NOON = datetime(2026, 3, 1, 12, tzinfo=UTC)


def session_report(
    document: Document | None = None, reference: Calibration | None = None, **changes: object
) -> SessionReport:
    """The report of a session as the service would store it."""
    session = read_session(document or accelerometer_block())
    calibration = calibrate(session)
    judged = judge(calibration, reference, type_of(as_checked(session, NOON, session.unit)), 2.0)
    stored = StoredSession(
        id="5e55", unit=session.unit, sha256="5e55" * 16, filename="BA-017.json", size=12_345,
        programme=session.programme, stand="ODG-1", operator="K. Ito", notes="", started_at=NOON, uploaded_at=NOON,
        verdict=judged.verdict, reason=judged.reason, is_reference=reference is None, simulated=False,
    )  # fmt: skip
    return SessionReport(replace(stored, **changes), calibration, judged.decisions)


def bias_point(day: int, value: float | None, *, reference: float | None = 0.0, sensor: str = "A1") -> HistoryPoint:
    """One bias of one session, m/s²; tolerance 5e-4, U 1e-4."""
    return HistoryPoint(
        session=f"s{day}", at=NOON + timedelta(days=day), sensor=sensor, kind="accelerometer", parameter="bias",
        value=value, u=5e-5, lower=None if value is None else value - 1e-4,
        upper=None if value is None else value + 1e-4, reference=reference,
        deviation=None, expanded=None, is_reference=False,
        tolerance=None if reference is None else 5e-4, verdict=Verdict.PASS, axis=None,
    )  # fmt: skip


def unit_summary(serial: str = "BA-017", verdict: Verdict = Verdict.PASS, margin: float | None = 0.4) -> UnitSummary:
    """One line of the fleet."""
    return UnitSummary(
        serial=serial, unit_type="hex-cone", simulated=False, sessions=3, last_session="5e55", last_at=NOON,
        verdict=verdict, is_reference=False, reason="why", worst_sensor="A3", worst_parameter="bias", margin=margin,
    )  # fmt: skip


def uses_of(*units: UnitSummary) -> dict[str, Usable]:
    """Use of units of which nothing else is known, by serial number."""
    return {unit.serial: usable(UseFacts(unit), NOON) for unit in units}
