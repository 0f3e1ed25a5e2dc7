"""What the units measured on a stand show of it, in words."""

from collections.abc import Sequence

from estimator.health.common_motion import AXES
from service.measures import COVERAGE, deviation_measure, in_words, measured, signed
from service.records.stand import StandEvidence, StandSeating
from service.words.names import day_of

STEADY = "Nothing that all units measured on it have in common."
TOO_FEW = "Fewer than three units tell of it."
JUDGED = "The units are judged without it."


def reason_of(
    evidence: Sequence[StandEvidence], shifts: Sequence[StandEvidence], seating: Sequence[StandSeating]
) -> str:
    """What the stand does to every block, since when, what to do, and how blocks are seated anyway."""
    if not shifts:
        return " ".join([STEADY, *_seating(seating)]) if evidence else TOO_FEW
    lasting = [shift for shift in shifts if shift.until is None]
    told = [_shift(shift) for shift in (*lasting, *(shift for shift in shifts if shift.until is not None))]
    advice = "Check stand and fixture." if lasting else "It is back where it was: note what was done to it."
    return " ".join([*told, advice, JUDGED, *_seating(seating)])


def _shift(shift: StandEvidence) -> str:
    """What it does, or did, on how many units it was seen, and when."""
    seen = f"seen on {shift.agreeing} of {shift.units} units"
    when = f"since {day_of(shift.since)}"
    if shift.until is not None:
        when = f"from {day_of(shift.since)} until before {day_of(shift.until)}"
    if shift.quantity == AXES:
        size = measured(shift.size, COVERAGE * shift.sigma, deviation_measure(shift.kind, "axis", shift.size))
        return f"It turn{_s(shift)} every block by {size}, {seen} {when}."
    size = signed(shift.size, COVERAGE * shift.sigma, deviation_measure(shift.kind, "scale", shift.size))
    return f"It change{_s(shift)} every scale factor by {size}, {seen} {when}."


def _s(shift: StandEvidence) -> str:
    """The ending of a verb, now or then."""
    if shift.until is None:
        return "s"
    return "ed" if shift.quantity == AXES else "d"


def _seating(seating: Sequence[StandSeating]) -> list[str]:
    """How blocks are seated, ± U."""
    return [
        f"From one mounting to the next a block sits within ±{in_words(own.kind, 'axis', COVERAGE * own.tau)}"
        " about each axis."
        for own in seating
        if own.quantity == AXES
    ][:1]
