"""A unit as found and as left, both against the reference in force when it was found."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from estimator.health.temperature_law import NO_STEPS
from estimator.message import say
from estimator.session import AS_FOUND, AS_LEFT, CALIBRATIONS
from service.judging.judge import decisions_of
from service.kit.measures import deviation_measure, limit, measured, signed
from service.sessions.calibrations_store import Calibrations
from service.sessions.decision import Decision
from service.sessions.records import StoredSession
from service.sessions.states import RecordState
from service.sessions.store import reference_query
from service.sessions.words.conditions import Condition, condition_of
from service.storage.queries import Store
from service.types.records import UnitType
from service.units.store import Units


@dataclass(frozen=True)
class JudgedChange:
    """One parameter of one sensor."""

    name: str
    deviation: str
    """Deviation with its U."""
    tolerance: str
    condition: Condition


def moved(decision: Decision) -> JudgedChange:
    """The decision in practical units."""
    sizes = (decision.deviation, decision.expanded, decision.tolerance)
    unit = deviation_measure(decision.kind, decision.parameter, max(abs(x or 0.0) for x in sizes))
    one_sided = decision.parameter == "axis"
    format_value = measured if one_sided else signed
    is_observed = decision.deviation is not None
    return JudgedChange(
        name=say("{sensor} {parameter}", sensor=decision.sensor, parameter=decision.parameter),
        deviation=format_value(decision.deviation, decision.expanded, unit) if is_observed else "not observable",
        tolerance=limit(decision.tolerance, unit, one_sided),
        condition=condition_of(decision.verdict),
    )


@dataclass(frozen=True)
class FoundAndLeft:
    """The latest pair of a unit; a session still to be measured is None."""

    reference: str | None
    """The common reference; None where the unit was found at its reference."""
    found: StoredSession
    left: StoredSession | None
    decisions: tuple[tuple[Decision, Decision | None], ...]
    """Decisions on every judged parameter as found and as left, in the order of the sensors."""


def found_and_left(
    store: Store, unit_type: UnitType, sessions: Sequence[StoredSession], coverage_factor: float
) -> FoundAndLeft | None:
    """The latest as-found session among some, and the first as-left one after it; None without an as-found session."""
    sessions = [s for s in sessions if s.state is RecordState.ACCEPTED]
    found = max((s for s in sessions if s.stage == AS_FOUND), key=_started_at, default=None)
    if found is None:
        return None
    later = (
        s
        for s in sessions
        if s.stage == AS_LEFT and _started_at(s) > _started_at(found) and s.programme in CALIBRATIONS
    )
    left = min(later, key=_started_at, default=None)
    unit = Units(store).key(found.unit)
    pair = (found.id,) if left is None else (found.id, left.id)
    reference, calibrations, steps = Calibrations(store).beside_reference(
        pair, reference_query(unit, unit_type.block, found.started_at)
    )

    def judged(session: StoredSession | None) -> tuple[Decision, ...]:
        """The decisions by the current tolerances; as found, at the reference's temperature where a law is known."""
        if session is None or reference is None:
            return ()
        step = steps[session.id] if session is found else NO_STEPS
        return decisions_of(calibrations[session.id], calibrations[reference], unit_type, coverage_factor, step)

    return FoundAndLeft(None if reference == found.id else reference, found, left, _paired(judged(found), judged(left)))


def _paired(found: Sequence[Decision], left: Sequence[Decision]) -> tuple[tuple[Decision, Decision | None], ...]:
    """Every judged parameter as found, with the same as left."""
    by_key = {(d.sensor, d.parameter): d for d in left}
    return tuple((d, by_key.get((d.sensor, d.parameter))) for d in found)


def _started_at(session: StoredSession) -> datetime:
    return session.started_at
