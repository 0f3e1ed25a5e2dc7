"""What the units measured on a stand show of it, in words."""

from collections.abc import Sequence

from estimator.health.common_motion import AXES
from estimator.session import ACCELEROMETER
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
    by = f"{size_of_shift(shift)}, {seen} {when}."
    if shift.quantity == AXES:
        return f"It {'turns' if shift.until is None else 'turned'} every block by {by}"
    return f"It {'changes' if shift.until is None else 'changed'} every scale factor by {by}"


def size_of_shift(shift: StandEvidence) -> str:
    """``15.3 ± 0.4 arcsec``, ± U."""
    parameter, write = ("axis", measured) if shift.quantity == AXES else ("scale", signed)
    return write(shift.size, COVERAGE * shift.sigma, deviation_measure(shift.kind, parameter, shift.size))


def kind_of_shift(kind: str, quantity: str) -> str:
    """``Turn of every block``: what a stand does, by the sensors that show it."""
    what = "Turn of every block" if quantity == AXES else "Change of every scale factor"
    return what if kind == ACCELEROMETER else f"{what}, by gyros"


def scatter_of(own: StandSeating) -> str:
    """``±0.4 arcsec about each axis``: from one mounting to the next, ± U."""
    parameter, of = ("axis", "about each axis") if own.quantity == AXES else ("scale", "of all scale factors")
    return f"±{in_words(own.kind, parameter, COVERAGE * own.tau)} {of}"


def _seating(seating: Sequence[StandSeating]) -> list[str]:
    """How blocks are seated, ± U."""
    return [
        f"From one mounting to the next a block sits within {scatter_of(own)}."
        for own in seating
        if own.quantity == AXES
    ][:1]
