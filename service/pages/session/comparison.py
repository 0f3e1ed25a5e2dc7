"""Two sessions of a unit beside each other.

For a session s, x_s = θ + J_s c + ε_s: θ the truth, c the stand's constant errors, ε_s the errors that differ from
session to session, with covariance R_s. The total covariance of one session is C_s = J_s Σ_c J_sᵀ + R_s. For two
sessions on one stand by like schedules, J_1 = J_2 and J c is in both: Var(x_2 − x_1) = R_1 + R_2. On different stands
it is C_1 + C_2, as the decision rule takes it everywhere; on one stand that is more. (JCGM 102, propagation of
covariance.).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.message import joined, say
from estimator.results import Calibration, Estimate, SensorCalibration
from estimator.session import Array
from service.errors import ConflictError
from service.fleet.condition import ToleranceUsed
from service.judging.judge import judge
from service.kit.measures import PARAMETER_NAMES, day_of, measured
from service.pages.fleet.pages import Margin, margin_of
from service.pages.session.pages import (
    decision_measure,
    deviation_in_words,
    parameters_of,
    reading_units,
    tolerance_in_words,
    value_in_words,
)
from service.sessions.calibrations_store import Calibrations
from service.sessions.decision import Decision, Judged, nominal_factor_of
from service.sessions.lines import SessionLine, session_lines
from service.sessions.records import ALL_PARAMETERS, StoredSession
from service.sessions.states import RecordState
from service.sessions.store import Sessions
from service.sessions.words.conditions import Condition, condition_of
from service.sessions.words.motion import MotionLine, motions_in_words
from service.storage.queries import Store
from service.types.store import UnitTypes
from service.units.records import Service
from service.units.store import Services

SAME = "Choose two different sessions: there is nothing to compare in one."
OF_TWO = "Session {first} is of unit {one} and session {second} of unit {other}: compare two sessions of one unit."


@dataclass(frozen=True, eq=False)
class ComparisonView:
    """The earlier session and the later one."""

    first: StoredSession
    second: StoredSession
    before: Calibration
    after: Calibration
    judged: Judged
    """The later one, judged as if the earlier one were its reference."""
    on_one_stand: Mapping[tuple[str, str], float]
    """Standard uncertainty of the change by sensor and parameter, without the stand's effects common to both sessions.
    Empty where they were not measured on one stand.
    """
    services: tuple[Service, ...]
    """Services between the two."""

    @property
    def stand(self) -> str | None:
        """Stand of both sessions; None where they were not measured on one."""
        return self.first.stand if self.first.stand == self.second.stand else None


def compare(store: Store, a: str, b: str, coverage_factor: float) -> ComparisonView:
    """Two sessions of one unit by their date, whichever is named first; NotFoundError, ConflictError."""
    if a == b:
        raise ConflictError(SAME)
    first, second = sorted((Sessions(store).get(a), Sessions(store).get(b)), key=lambda s: (s.started_at, s.id))
    if first.unit != second.unit:
        named = {"first": first.id, "second": second.id, "one": first.unit, "other": second.unit}
        raise ConflictError(OF_TWO, **named)
    known = Calibrations(store).in_force((first.id, second.id))
    before, after = known[first.id], known[second.id]
    return ComparisonView(
        first=first,
        second=second,
        before=before,
        after=after,
        judged=judge(after, before, UnitTypes(store).of_unit(first.unit), coverage_factor),
        on_one_stand=_repeatabilities(before, after) if first.stand is not None and first.stand == second.stand else {},
        services=tuple(
            service
            for service in Services(store).recorded(first.unit)
            if service.state is RecordState.ACCEPTED and first.started_at < service.at <= second.started_at
        ),
    )


def _repeatabilities(before: Calibration, after: Calibration) -> dict[tuple[str, str], float]:
    """√(R_1 + R_2) of every parameter that both sessions tell."""
    earlier = {sensor.name: sensor for sensor in before.sensors}
    found = {
        (sensor.name, parameter): _spread(before, after, earlier[sensor.name], sensor, parameter)
        for sensor in after.sensors
        for parameter in ALL_PARAMETERS
        if sensor.name in earlier
    }
    return {key: spread for key, spread in found.items() if spread is not None}


def _spread(
    before: Calibration, after: Calibration, old: SensorCalibration, now: SensorCalibration, parameter: str
) -> float | None:
    if parameter == "axis":
        return _axis_spread(_axis_repeatability(before, old), _axis_repeatability(after, now))
    first: Estimate | None = getattr(old, parameter)
    second: Estimate | None = getattr(now, parameter)
    if first is None or second is None or first.repeatability is None or second.repeatability is None:
        return None
    size = abs(first.value or 0.0) if parameter == "scale" else 1.0
    return float(np.hypot(first.repeatability, second.repeatability)) / size if size else None


def _axis_spread(before: Array | None, after: Array | None) -> float | None:
    """Along the direction in which the change of the axis is known least, rad; of both covariances (3, 3), rad²."""
    if before is None or after is None:
        return None
    return float(np.sqrt(np.linalg.eigvalsh(before + after)[-1]))


def _axis_repeatability(calibration: Calibration, sensor: SensorCalibration) -> Array | None:
    """(3, 3) in block axes, rad²: sessions have different tangents. None where it is not observed."""
    names = [f"{sensor.name}.axis_1", f"{sensor.name}.axis_2"]
    if not set(names) <= set(calibration.names):
        return None
    places = [calibration.names.index(name) for name in names]
    covariance = sensor.axis_tangents @ calibration.repeatability[np.ix_(places, places)] @ sensor.axis_tangents.T
    return np.asarray(covariance) if np.isfinite(covariance).all() else None


DIRECT = "They are compared directly, so the reference that both are judged against plays no part in the difference."
ONE_STAND = (
    "Both were measured on stand {stand}: unless it was realigned between them, its constant errors cancel in the "
    "difference. “On one stand” excludes them; ± U includes them in full for each, as the decision rule does, and is "
    "the larger of the two."
)
TWO_STANDS = (
    "They were measured on different stands, {first} and {second}: the constant errors of each count in full, and what "
    "differs between the stands is part of the difference."
)
NO_STAND = "Not both were measured on a stand: the errors of each count in full."
SERVICED = "The unit was serviced between them ({days}): a change may come from the service."
OTHER_MODEL = (
    "They were calibrated with different causes in the model, revisions {first} and {second}: part of the difference "
    "may come from the model."
)
OTHER_METHOD = "They were measured in different ways, {first} and {second}."


def in_common(first: StoredSession, second: StoredSession, services: Sequence[Service]) -> tuple[str, ...]:
    """Remarks on the two sessions, a sentence each."""
    said = [_stand(first.stand, second.stand), DIRECT]
    if services:
        said.append(say(SERVICED, days=joined(", ", dict.fromkeys(day_of(service.at) for service in services))))
    if first.revision != second.revision:
        said.append(say(OTHER_MODEL, first=first.revision, second=second.revision))
    if first.programme != second.programme:
        named = (session.programme.replace("-", " ") for session in (first, second))
        said.append(say(OTHER_METHOD, **dict(zip(("first", "second"), named, strict=True))))
    return tuple(said)


def _stand(first: str | None, second: str | None) -> str:
    if first is None or second is None:
        return NO_STAND
    return say(ONE_STAND, stand=first) if first == second else say(TWO_STANDS, first=first, second=second)


NOT_COMPARED = "not determined by both"


@dataclass(frozen=True)
class ParameterChangeRow:
    """One parameter of one sensor."""

    sensor: str
    parameter: str
    before: str
    after: str
    change: str
    on_one_stand: str
    """± of the change without what the stand does to both alike; empty where they have no stand in common."""
    tolerance: str
    used: Margin | None
    """Share of the tolerance that the change uses, U included."""
    condition: Condition | None
    """Condition of the change; None where the parameter is not judged, or not known of both."""


@dataclass(frozen=True)
class ComparisonPage:
    """Everything the page shows."""

    unit: str
    sessions: tuple[SessionLine, ...]
    """The earlier one, then the later one."""
    condition: Condition
    reason: str
    in_common: tuple[str, ...]
    motions: tuple[MotionLine, ...]
    rows: tuple[ParameterChangeRow, ...]
    """Rows by sensor, in the order of the file."""
    is_one_stand: bool
    """Whether both were measured on one stand."""
    coverage: str


def comparison_page(found: ComparisonView) -> ComparisonPage:
    """The page of a comparison."""
    judged = {(d.sensor, d.parameter): d for d in found.judged.decisions}
    k = nominal_factor_of(found.judged.decisions)
    earlier = {sensor.name: sensor for sensor in found.before.sensors}
    return ComparisonPage(
        unit=found.first.unit,
        sessions=session_lines((found.first, found.second)),
        condition=condition_of(found.judged.verdict),
        reason=found.judged.reason,
        in_common=in_common(found.first, found.second, found.services),
        motions=motions_in_words(found.judged.motions, k, "between the two"),
        rows=tuple(
            _row(earlier.get(sensor.name), sensor, parameter, judged.get((sensor.name, parameter)), (found, k))
            for sensor in found.after.sensors
            for parameter in _parameters(found.before, found.after)
        ),
        is_one_stand=bool(found.on_one_stand),
        coverage=f"k = {k:g}",
    )


def _parameters(before: Calibration, after: Calibration) -> tuple[str, ...]:
    """The parameters of either session."""
    told = {*parameters_of(before), *parameters_of(after)}
    return tuple(parameter for parameter in ALL_PARAMETERS if parameter in told)


def _row(
    old: SensorCalibration | None,
    now: SensorCalibration,
    parameter: str,
    decision: Decision | None,
    view_and_coverage: tuple[ComparisonView, float],
) -> ParameterChangeRow:
    found, k = view_and_coverage
    units = reading_units(found.after)
    spread = found.on_one_stand.get((now.name, parameter))
    known = decision if decision is not None and decision.deviation is not None else None
    return ParameterChangeRow(
        sensor=now.name,
        parameter=PARAMETER_NAMES[parameter],
        before="–" if old is None else value_in_words(old, parameter, k, units.get(now.name, "")),
        after=value_in_words(now, parameter, k, units.get(now.name, "")),
        change=NOT_COMPARED if known is None else deviation_in_words(known),
        on_one_stand="" if known is None or spread is None else _on_one_stand(known, spread),
        tolerance=tolerance_in_words(decision),
        used=None if known is None else _used(known),
        condition=None if known is None else condition_of(known.verdict),
    )


def _used(decision: Decision) -> Margin | None:
    if decision.deviation is None or decision.expanded is None:
        return None
    used = ToleranceUsed(abs(decision.deviation) / decision.tolerance, decision.expanded / decision.tolerance)
    return margin_of(used)


def _on_one_stand(decision: Decision, spread: float) -> str:
    return f"± {measured(decision.coverage_factor * spread, None, decision_measure(decision))}"
