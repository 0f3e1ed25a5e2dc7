"""Step: a calibrated session → a decision on every parameter, and on the session by the worst of them."""

from collections.abc import Iterable

from estimator.health import Judgement
from estimator.health import judge as judge_parameters
from estimator.health.common_motion import common_motion
from estimator.health.parity import RULE as PARITY_RULE
from estimator.health.parity import judge_parity
from estimator.health.rule import RULE
from estimator.message import say
from estimator.results import Calibration
from service.judging.calibrate import Comparison
from service.judging.in_service_words import reason as recording_in_words
from service.judging.words import first_in_words, reason
from service.kit.lock_order import outside_writing
from service.sessions.decision import Decision, Judged, Opening, Verdict
from service.sessions.words.advice import too_few
from service.types.records import UnitType
from service.types.rules import tolerances_of


@outside_writing
def judge(
    calibration: Calibration,
    reference: Calibration | None,
    unit_type: UnitType,
    coverage_factor: float,
    *,
    opening: Opening = Opening.FIRST,
) -> Judged:
    """Every parameter judged, and the session by its worst.

    Without a reference it becomes the reference, unless it gives no uncertainty that later ones could be judged with.
    """
    tolerances = tolerances_of(unit_type)
    splits = () if reference is None else common_motion(calibration, reference, tolerances)
    found = judge_parameters(calibration, reference, tolerances, coverage_factor=coverage_factor, splits=splits)
    decisions = _decisions(found, RULE, unit_type)
    blind = too_few(calibration)
    first = reference is None and not blind
    return Judged(
        calibration=calibration,
        decisions=decisions,
        reason=first_in_words(calibration, opening) if first else reason(decisions, blind),
        is_reference=first,
        motions=tuple(split.motion for split in splits),
    )


def decisions_of(
    calibration: Calibration, reference: Calibration, unit_type: UnitType, coverage_factor: float
) -> tuple[Decision, ...]:
    """Every parameter judged against any calibration of the unit, by the same rule as an upload."""
    return judge(calibration, reference, unit_type, coverage_factor).decisions


@outside_writing
def judge_recording(moved: Calibration, found: Comparison, unit_type: UnitType, coverage_factor: float) -> Judged:
    """Every parameter that parity sees, judged, and the recording by its worst."""
    tolerances = tolerances_of(unit_type)
    seen = judge_parity(found.result, found.reference, tolerances, coverage_factor=coverage_factor)
    decisions = _decisions(seen, PARITY_RULE, unit_type)
    return Judged(moved, decisions, recording_in_words(found.result, decisions), is_reference=False)


def _decisions(judgements: Iterable[Judgement], rule: str, unit_type: UnitType) -> tuple[Decision, ...]:
    """Judgements with the rule and the revision of the tolerances that they rest on."""
    basis = say("{rule} ({name} rev {revision})", rule=rule, name=unit_type.name, revision=unit_type.revision)
    return tuple(Decision(**(vars(own) | {"verdict": Verdict(own.verdict)}), rule=basis) for own in judgements)
