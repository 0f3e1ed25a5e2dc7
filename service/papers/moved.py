"""One judged parameter in a line: how far it moved, of what is allowed."""

from dataclasses import dataclass

from estimator.message import say
from service.kit.measures import deviation_measure, limit, measured, signed
from service.sessions.decision import Decision
from service.sessions.words.conditions import Condition, condition_of


@dataclass(frozen=True)
class Moved:
    """One parameter of one sensor."""

    name: str
    deviation: str
    """With its U."""
    tolerance: str
    condition: Condition


def moved(decision: Decision) -> Moved:
    """The decision in people's units."""
    sizes = (decision.deviation, decision.expanded, decision.tolerance)
    unit = deviation_measure(decision.kind, decision.parameter, max(abs(x or 0.0) for x in sizes))
    one_sided = decision.parameter == "axis"
    write = measured if one_sided else signed
    seen = decision.deviation is not None
    return Moved(
        name=say("{sensor} {parameter}", sensor=decision.sensor, parameter=decision.parameter),
        deviation=write(decision.deviation, decision.expanded, unit) if seen else "not observable",
        tolerance=limit(decision.tolerance, unit, one_sided),
        condition=condition_of(decision.verdict),
    )
