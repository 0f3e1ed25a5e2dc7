"""Step: a calibrated session, judged against the unit's reference session."""

from dataclasses import asdict

from estimator.health import Judgement
from estimator.health import judge as judge_parameters
from estimator.health.common_motion import common_motion
from estimator.health.rule import RULE
from estimator.results import Calibration
from estimator.session import CalibrationSession
from service.judging.tolerances import tolerances_of
from service.records.decision import Decision, Judged, Verdict, Worst
from service.records.unit import UnitType
from service.words.verdict import first_in_words, reason, worst_of, worst_record

NONE_YET = Worst(None, None, None)


def judge(
    session: CalibrationSession,
    calibration: Calibration,
    reference: Calibration | None,
    unit_type: UnitType,
    coverage_factor: float,
    *,
    after_service: bool = False,
) -> Judged:
    """Every parameter judged, and the session by its worst; without a reference it becomes the reference."""
    tolerances = tolerances_of(unit_type)
    splits = () if reference is None else common_motion(calibration, reference, tolerances)
    found = judge_parameters(calibration, reference, tolerances, coverage_factor=coverage_factor, splits=splits)
    decisions = tuple(_decision(judgement, unit_type, coverage_factor) for judgement in found)
    worst = worst_of(decisions)
    return Judged(
        source=session,
        calibration=calibration,
        decisions=decisions,
        verdict=Verdict.UNDECIDABLE if worst is None else worst.verdict,
        reason=reason(decisions) if reference else first_in_words(calibration, after_service=after_service),
        worst=NONE_YET if reference is None else worst_record(decisions),
        is_reference=reference is None,
        motions=tuple(split.motion for split in splits),
    )


def decisions_of(
    calibration: Calibration, reference: Calibration, unit_type: UnitType, coverage_factor: float
) -> tuple[Decision, ...]:
    """Every parameter judged against any calibration of the unit."""
    splits, tolerances = common_motion(calibration, reference), tolerances_of(unit_type)
    found = judge_parameters(calibration, reference, tolerances, coverage_factor=coverage_factor, splits=splits)
    return tuple(_decision(judgement, unit_type, coverage_factor) for judgement in found)


def _decision(judgement: Judgement, unit_type: UnitType, coverage_factor: float) -> Decision:
    own = asdict(judgement)
    own["verdict"] = Verdict(judgement.verdict)
    return Decision(
        **own,
        coverage_factor=coverage_factor,
        guard_band=judgement.expanded,
        rule=f"{RULE} ({unit_type.name} rev {unit_type.revision})",
    )
