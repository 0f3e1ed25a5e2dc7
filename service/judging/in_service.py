"""Step: a recording in service, compared with the calibration that its unit's readings are corrected by."""

from dataclasses import asdict, dataclass
from datetime import datetime

from estimator.errors import Problem, ScheduleError
from estimator.health.parity import RULE, judge_parity
from estimator.parity import ParityResult, parity_check
from estimator.parity.as_calibration import parity_calibration
from estimator.results import Calibration
from estimator.session import CalibrationSession
from service.ingest.storable import measured_at
from service.judging.tolerances import tolerances_of
from service.records.decision import Decision, Judged, Verdict
from service.records.unit import UnitType
from service.storage.store import Store
from service.words.in_service import reason
from service.words.verdict import worst_of, worst_record


def reference_in_force(store: Store, session: CalibrationSession, now: datetime) -> Calibration:
    """The calibration of the epoch that a recording was made in; ScheduleError where there is none yet."""
    if not store.units.exists(session.unit):
        raise ScheduleError([Problem("unit", _uncalibrated(session.unit))])
    unit = store.units.key(session.unit)
    since, until = store.services.around(unit, measured_at(session, now))
    reference = store.sessions.reference(unit, session.block, since, until)
    if reference is None:
        raise ScheduleError([Problem("unit", _uncalibrated(session.unit, since))])
    return store.calibrations.get(reference)


@dataclass(frozen=True)
class Compared:
    """A recording beside its reference."""

    reference: Calibration
    result: ParityResult

    @property
    def calibration(self) -> Calibration:
        """The reference moved by what the recording shows."""
        return parity_calibration(self.result, self.reference)


def compared(session: CalibrationSession, reference: Calibration) -> Compared:
    """The recording's parity; ScheduleError where the recording cannot say anything."""
    return Compared(reference, parity_check(session, reference))


def judge_recording(
    session: CalibrationSession, found: Compared, unit_type: UnitType, coverage_factor: float
) -> Judged:
    """Every parameter that parity sees, judged, and the recording by its worst."""
    tolerances = tolerances_of(unit_type)
    judgements = judge_parity(found.result, found.reference, tolerances, coverage_factor=coverage_factor)
    rule = f"{RULE} ({unit_type.name} rev {unit_type.revision})"
    decisions = tuple(
        Decision(
            **{**asdict(judgement), "verdict": Verdict(judgement.verdict)},
            coverage_factor=coverage_factor,
            guard_band=judgement.expanded,
            rule=rule,
        )
        for judgement in judgements
    )
    worst = worst_of(decisions)
    return Judged(
        source=session,
        calibration=found.calibration,
        decisions=decisions,
        verdict=Verdict.UNDECIDABLE if worst is None else worst.verdict,
        reason=reason(found.result, decisions),
        worst=worst_record(decisions),
        is_reference=False,
    )


def _uncalibrated(unit: str, since: datetime | None = None) -> str:
    """What to do first."""
    service = "" if since is None else f" since its service of {since:%Y-%m-%d}"
    return (
        f"{unit} has no calibration yet{service}, and a recording in service is compared with one: "
        "upload a calibration session of the unit first, then this file again"
    )
