"""Why a session's verdict is what it is, in one sentence that a technician understands."""

from collections.abc import Sequence

from estimator.results import Calibration
from service.measures import in_words
from service.records.decision import Decision, Opening, Verdict, worst_of
from service.records.reservation import Doubt, Reservation, Reservations
from service.records.unit import UnitSummary
from service.words.advice import left_open
from service.words.conditions import Condition, condition_of
from service.words.names import PARAMETER_NAMES
from service.words.reservation import LOOKING

FIRST_SESSION = "First session of this unit: it is now the reference that later sessions are judged against."
NEW_EPOCH = "First session after a service: it is now the reference that later sessions are judged against."
CHOSEN = "Chosen as the reference: the unit's other sessions are judged against it."
OPENINGS = {Opening.FIRST: FIRST_SESSION, Opening.SERVICE: NEW_EPOCH, Opening.CHOSEN: CHOSEN}
STILL_LOOKING = f"; {LOOKING}"
MOST_TOLD = 2
"""Reservations that a verdict is said with before the rest are counted: more are no longer read in one breath."""
NOTHING_JUDGED = "Nothing could be judged: no parameter of this session has a tolerance."
ALL_PASS = "Every parameter is within its tolerance by more than U; closest to it: {closest}."


def verdict_in_words(condition: Condition, reservations: Reservations) -> str:
    """A verdict as it is said wherever it stands: ``Fit, but the zero of A2 jumps once: repeat the session``."""
    return f"{condition.word}{but(reservations)}"


def unit_in_words(unit: UnitSummary) -> str:
    """The verdict of a unit's latest session, as it is said."""
    return verdict_in_words(condition_of(unit.verdict, is_reference=unit.is_reference), unit.reservations)


def but(reservations: Reservations) -> str:
    """What follows a verdict's word: nothing where it is plain."""
    if reservations is None:
        return STILL_LOOKING
    if not reservations:
        return ""
    told, more = reservations[:MOST_TOLD], len(reservations) - MOST_TOLD
    rest = f"; and {more} more" if more > 0 else ""
    return f", but {'; and '.join(one.text for one in told)}{rest}: {' and '.join(_advice(told))}"


def _advice(told: Sequence[Reservation]) -> tuple[str, ...]:
    """What to do, once, and not what other advice says already; a wrong file is put right before anything else."""
    if any(one.kind is Doubt.RECORD for one in told):
        told = [one for one in told if one.kind is Doubt.RECORD]
    advice = tuple(dict.fromkeys(one.advice for one in told))
    return tuple(one for one in advice if not any(one in other for other in advice if other != one))


def first_in_words(calibration: Calibration, opening: Opening) -> str:
    """That a session is the reference, and what of the unit it leaves open."""
    return " ".join(filter(None, (OPENINGS[opening], left_open(calibration))))


def reason(decisions: tuple[Decision, ...], blind: str = "") -> str:
    """One sentence on the worst parameter, in people's units; ``blind`` says why a session gives no uncertainty."""
    worst = worst_of(decisions)
    if worst is None:
        return blind or NOTHING_JUDGED
    if blind and worst.expanded is None:
        return blind
    return _sentence(worst, decisions)


def _sentence(worst: Decision, decisions: tuple[Decision, ...]) -> str:
    place = f"{worst.sensor} {_name(worst)}"
    if worst.deviation is None or worst.expanded is None:
        return _unseen(worst, decisions)
    moved = _words(worst, worst.deviation, signed=worst.parameter != "axis")
    spread, allowed = _words(worst, worst.expanded), _words(worst, worst.tolerance)
    if worst.verdict is Verdict.PASS:
        return ALL_PASS.format(closest=f"{place}, moved {moved} (U {spread}) of {allowed} allowed")
    if worst.verdict is Verdict.FAIL:
        return f"{place} moved {moved} (U {spread}) beyond the tolerance of {allowed}."
    if worst.verdict is Verdict.CONDITIONAL_FAIL:
        return f"{place} moved {moved} (U {spread}): beyond the tolerance of {allowed}, by less than U."
    if worst.verdict is Verdict.CONDITIONAL_PASS:
        return f"{place} moved {moved} (U {spread}): within the tolerance of {allowed}, by less than U."
    return _too_uncertain(place, moved, spread, allowed, worst)


def _too_uncertain(place: str, moved: str, spread: str, allowed: str, worst: Decision) -> str:
    if worst.expanded is not None and worst.expanded > worst.tolerance:
        return (
            f"{place} is known to U {spread} only, more than its tolerance of {allowed}: "
            "measure more positions or better averages, or set a tolerance that can be decided."
        )
    return (
        f"{place} moved {moved} (U {spread}), beyond the tolerance of {allowed} but no more than noise "
        "makes the largest of so many numbers: measure again."
    )


def _unseen(worst: Decision, decisions: tuple[Decision, ...]) -> str:
    sensors = [d.sensor for d in decisions if d.parameter == worst.parameter and d.deviation is None]
    named = ", ".join(sensors[:6]) + (f" and {len(sensors) - 6} more" if len(sensors) > 6 else "")
    missing = "has none in the reference session to compare with"
    if worst.value is None:
        missing = "is not observable in this session: add the positions that show it"
    return f"{_name(worst).capitalize()} of {named} {missing}."


def _name(decision: Decision) -> str:
    return PARAMETER_NAMES[decision.parameter]


def _words(decision: Decision, si: float, *, signed: bool = False) -> str:
    return in_words(decision.kind, decision.parameter, si, signed=signed)
