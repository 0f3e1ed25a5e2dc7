"""What the units measured on a stand show of it, in words."""

from estimator.health.common_motion import AXES
from service.measures import COVERAGE, deviation_measure, measured, signed
from service.records.stand import StandEvidence
from service.words.names import day_of

STEADY = "Nothing that all units measured on it have in common."
TOO_FEW = "Fewer than three units tell of it."


def why_shifted(worst: StandEvidence) -> str:
    """What the stand does to every block, on how many units it was seen, and what to do."""
    seen = f"seen on {worst.agreeing} of {worst.units} units since {day_of(worst.since)}"
    if worst.quantity == AXES:
        size = measured(worst.size, COVERAGE * worst.sigma, deviation_measure(worst.kind, "axis", worst.size))
        return f"It turns every block by {size}, {seen}: check stand and fixture. The units are judged without it."
    size = signed(worst.size, COVERAGE * worst.sigma, deviation_measure(worst.kind, "scale", worst.size))
    return f"It changes every scale factor by {size}, {seen}: check it. The units are judged without it."
