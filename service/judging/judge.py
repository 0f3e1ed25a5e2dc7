"""Step: a calibrated session → a decision on every parameter, and on the session by the worst of them."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import dist

from estimator.health import ParameterJudgement
from estimator.health import judge as judge_parameters
from estimator.health.common_motion import Split, common_motion
from estimator.health.parity import RULE as PARITY_RULE
from estimator.health.parity import judge_parity
from estimator.health.rule import RULE
from estimator.health.temperature_law import NO_STEPS, Steps, at_reference
from estimator.message import joined, say
from estimator.results import Calibration
from service.judging.calibrate import ReferenceComparison
from service.judging.fault_words import faults_in_words
from service.judging.temperature_words import far_from_reference
from service.judging.words import by_defaults, first_in_words, reason, recording_in_words
from service.kit.lock_order import outside_writing
from service.models.records import MovedParameter, MovedVerdict
from service.sessions.decision import Decision, Judged, Opening, Verdict, worst_of
from service.sessions.records import ParameterValue, StoredSession
from service.sessions.words.advice import too_few
from service.sessions.words.motion import beyond_in_words
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
    steps: Steps = NO_STEPS,
) -> Judged:
    """Every parameter judged, and the session by its worst; ``steps`` are what its temperature is worth.

    Without a reference it becomes the reference, unless it gives no uncertainty that later ones could be judged with.
    """
    tolerances = tolerances_of(unit_type, reference or calibration)
    splits: tuple[Split, ...] = ()
    if reference is not None:
        splits = common_motion(at_reference(calibration, reference, steps), reference, tolerances)
    found = judge_parameters(
        calibration, reference, tolerances, coverage_factor=coverage_factor, splits=splits, steps=steps
    )
    if not unit_type.are_entered:
        found = _without_unseen(found, calibration, reference or calibration)
    decisions = _decisions(found, RULE, unit_type)
    blind = too_few(calibration)
    first = reference is None and not blind
    motions = tuple(split.motion for split in splits)
    together = () if worst_of(decisions) is None else beyond_in_words(motions, coverage_factor)
    return Judged(
        calibration=calibration,
        decisions=decisions,
        reason=first_in_words(calibration, opening)
        if first
        else said_of(unit_type, decisions, joined(" ", (reason(decisions, blind), *together))),
        is_reference=first,
        motions=motions,
    )


def decisions_of(
    calibration: Calibration,
    reference: Calibration,
    unit_type: UnitType,
    coverage_factor: float,
    steps: Steps = NO_STEPS,
) -> tuple[Decision, ...]:
    """Every parameter judged against any calibration of the unit, by the same rule as an upload."""
    return judge(calibration, reference, unit_type, coverage_factor, steps=steps).decisions


FAILS = (Verdict.FAIL, Verdict.CONDITIONAL_FAIL)
"""Verdicts that raise a flag."""


@outside_writing
def judge_recording(
    moved: Calibration,
    found: ReferenceComparison,
    unit_type: UnitType,
    coverage_factor: float,
    celsius: float | None = None,
) -> Judged:
    """Every parameter that parity sees, judged, and the recording by its worst, or by a sensor that fails within it.

    Far from the temperatures of its calibration, ``celsius``, a change may be temperature's: it decides nothing. A
    sensor that fails within the recording fails at any temperature.
    """
    tolerances = tolerances_of(unit_type, found.reference)
    seen = judge_parity(found.result, found.reference, tolerances, coverage_factor=coverage_factor)
    decisions = _decisions(seen, PARITY_RULE, unit_type)
    faults = faults_in_words(found.result, found.started_at)
    said, away = recording_in_words(found.result, decisions, faults), ""
    if not faults and any(decision.verdict in FAILS for decision in decisions):
        away = far_from_reference(celsius, found.reference.residuals)
    if away:
        said = joined(" ", (said, away))
        decisions = tuple(
            replace(decision, verdict=Verdict.UNDECIDABLE) if decision.verdict in FAILS else decision
            for decision in decisions
        )
    said = said if faults else said_of(unit_type, decisions, said)
    return Judged(moved, decisions, said, is_reference=False, faults=faults)


def said_of(unit_type: UnitType, decisions: tuple[Decision, ...], said: str) -> str:
    """A verdict's reason; where nobody entered the tolerances that decided it, with that."""
    return said if unit_type.are_entered or not decisions else joined(" ", (said, by_defaults(unit_type.name)))


def _without_unseen(judgements: Iterable[ParameterJudgement], *pair: Calibration) -> tuple[ParameterJudgement, ...]:
    """Judgements apart from parameters that no sensor of their kind shows in either session: nobody asked for them."""
    shown = {
        (s.kind, name)
        for calibration in pair
        for s in calibration.sensors
        for name in s.observable
        if s.observable[name]
    }
    return tuple(judgement for judgement in judgements if (judgement.kind, judgement.parameter) in shown)


def _decisions(judgements: Iterable[ParameterJudgement], rule: str, unit_type: UnitType) -> tuple[Decision, ...]:
    """Judgements with the rule and the revision of the tolerances that they rest on."""
    basis = say("{rule} ({name} rev {revision})", rule=rule, name=unit_type.name, revision=unit_type.revision)
    return as_decisions(judgements, basis)


def as_decisions(judgements: Iterable[ParameterJudgement], basis: str) -> tuple[Decision, ...]:
    """Judgements by a rule of a version, with tolerances of a revision."""
    return tuple(Decision(**(vars(j) | {"verdict": Verdict(j.verdict)}), rule=basis) for j in judgements)


def moved_verdicts(before: Mapping[str, StoredSession], after: Sequence[StoredSession]) -> Iterator[MovedVerdict]:
    """Accepted sessions with another verdict than before, in their order."""
    for now in after:
        was = before.get(now.id)
        if was is not None and was.state is now.state and was.verdict is not now.verdict:
            yield MovedVerdict(now.id, now.started_at, was.verdict, now.verdict)


def moved_parameters(
    session: str, before: Sequence[ParameterValue], after: Sequence[ParameterValue]
) -> Iterator[MovedParameter]:
    """Every parameter that both calibrations of a session give, and by how much it moved."""
    known = {(value.sensor, value.parameter): value for value in before}
    for now in after:
        was = known.get((now.sensor, now.parameter))
        change = None if was is None else _change(was, now)
        if change is not None and was is not None and was.u:
            yield MovedParameter(session, now.sensor, now.kind, now.parameter, change, _uncertainty(was))


def furthest(moved: Sequence[MovedParameter]) -> MovedParameter | None:
    """The parameter that moved most, in its own uncertainty; None where none moved."""
    found = max(moved, key=lambda parameter: abs(parameter.change) / parameter.u, default=None)
    return found if found is not None and found.change else None


def _change(was: ParameterValue, now: ParameterValue) -> float | None:
    """Relative of a scale factor; of an axis the angle between its directions, rad."""
    if was.axis is not None and now.axis is not None:
        return dist(was.axis, now.axis)
    if was.value is None or now.value is None:
        return None
    change = now.value - was.value
    return change / was.value if was.parameter == "scale" else change


def _uncertainty(was: ParameterValue) -> float:
    assert was.u is not None
    return was.u / abs(was.value) if was.parameter == "scale" and was.value else was.u
