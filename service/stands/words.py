"""Condition of a stand by the units measured on it, and its permitted use, in words."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date, timedelta

from estimator.health.common_motion import AXES
from estimator.message import joined, say
from estimator.session import ACCELEROMETER
from service.kit.measures import COVERAGE, day_of, deviation_measure, in_words, measured, signed
from service.stands.records import StandCertificate, StandCondition, StandError, StandEvidence, StandSeating

STEADY = "No change common to all units measured on it."
TOO_FEW = "Fewer than three units have been measured on it at least twice."
PENDING = "The results of its units are still being computed."
JUDGED = "The units are judged without this effect."


def reason_of(
    evidence: Sequence[StandEvidence], shifts: Sequence[StandEvidence], seating: Sequence[StandSeating]
) -> str:
    """The effect of the stand on every block, since when, advice, and the usual scatter of seating."""
    if not shifts:
        return joined(" ", (STEADY, *_seating(seating))) if evidence else TOO_FEW
    lasting = [shift for shift in shifts if shift.until is None]
    shown = [_shift(shift) for shift in (*lasting, *(shift for shift in shifts if shift.until is not None))]
    advice = "Check stand and fixture." if lasting else "The shift has ended: record what was done to the stand."
    judged = [JUDGED] if all(shift.quantity == AXES for shift in shifts) else []
    return joined(" ", (*shown, advice, *judged, *_seating(seating)))


def _shift(shift: StandEvidence) -> str:
    """The effect of a shift, the number of units that show it, and its dates."""
    seen = say("found with {agreeing} of {units} units", agreeing=shift.agreeing, units=shift.units)
    when = say("since {since}", since=day_of(shift.since))
    if shift.until is not None:
        when = say("from {start} until before {end}", start=day_of(shift.since), end=day_of(shift.until))
    by = say("{shift}, {agreement} {period}.", shift=size_of_shift(shift), agreement=seen, period=when)
    if shift.quantity == AXES:
        return (
            say("It turns every block by {size}", size=by)
            if shift.until is None
            else say("It turned every block by {size}", size=by)
        )
    return (
        say("It changes every scale factor by {size}", size=by)
        if shift.until is None
        else say("It changed every scale factor by {size}", size=by)
    )


def size_of_shift(shift: StandEvidence) -> str:
    """``15.3 ± 0.4 arcsec``, ± U."""
    parameter, write = ("axis", measured) if shift.quantity == AXES else ("scale", signed)
    return write(shift.size, COVERAGE * shift.sigma, deviation_measure(shift.kind, parameter, shift.size))


def kind_of_shift(kind: str, quantity: str) -> str:
    """``Turn of every block``: what a stand does, by the sensors that show it."""
    change = "Turn of every block" if quantity == AXES else "Change of every scale factor"
    return change if kind == ACCELEROMETER else say("{quantity}, by gyros", quantity=change)


def scatter_of(seating: StandSeating) -> str:
    """``±0.4 arcsec per axis``, ± U."""
    parameter, per = ("axis", "per axis") if seating.quantity == AXES else ("scale", "of all scale factors")
    return say("±{size} {of}", size=in_words(seating.kind, parameter, COVERAGE * seating.tau), of=per)


def _seating(seating: Sequence[StandSeating]) -> Sequence[str]:
    return [say("Mounting repeatability: {own}.", own=scatter_of(s)) for s in seating if s.quantity == AXES][:1]


NONE = "No certificate recorded: sessions on this stand state no traceability."
NOT_YET = "Its certificate is dated {issued}, in the future: until then sessions state no traceability."
HOLDS = "Sessions on this stand are traceable until {until}."
EXPIRED = "Its certificate expired on {until}: traceability of sessions after that day is interrupted."
SOON = timedelta(days=30)
"""Time in which a laboratory can still have a stand calibrated before its certificate ends."""


@dataclass(frozen=True)
class StandWord:
    """Permitted use of a stand today, and the reason."""

    key: str
    """Name of the icon and the style."""
    word: str
    advice: str
    """Action for the crew."""


READY = StandWord("pass", "Ready to use", "No recorded objection.")
SOON_OVER = StandWord("conditional-pass", "Ready to use", "Its certificate expires soon: have the stand calibrated.")
NOT_STATED = StandWord("undecidable", "Usable, traceability not stated", "Record the certificate of the stand.")
CHECK = StandWord("conditional-fail", "Check before use", "Check stand and fixture before a unit is mounted.")
EXPIRED_TODAY = StandWord("fail", "Not traceable today", "Have the stand calibrated, or record its new certificate.")
WORDS = (EXPIRED_TODAY, CHECK, NOT_STATED, SOON_OVER, READY)
"""Words, worst first."""


ERRORS = {
    "theta_x": "Levelling about X",
    "theta_y": "Levelling about Y",
    "alpha": "Elevation of the head's axis",
    "beta": "Turn of the head",
    "meridian": "North direction",
    "wobble": "Wobble of the turntable",
}  # fmt: skip


def error_in_words(error: StandError) -> tuple[str, str]:
    """Name of the stand's error, and ``±0.40 arcsec``, ± U."""
    return ERRORS[error.name], "±" + in_words(ACCELEROMETER, "axis", COVERAGE * error.sigma)


def held(certificates: Sequence[StandCertificate], today: date) -> StandCertificate | None:
    """The latest certificate that was issued by today, whether it still holds or not; they come by issue."""
    issued = [certificate for certificate in certificates if certificate.issued_on <= today]
    return issued[-1] if issued else None


def certificate_in_words(certificates: Sequence[StandCertificate], today: date) -> str:
    """The state of the certificate on which sessions of today would rest."""
    latest = held(certificates, today)
    if latest is None:
        return say(NOT_YET, issued=day_of(certificates[0].issued_on)) if certificates else NONE
    return say(HOLDS if latest.valid_until >= today else EXPIRED, until=day_of(latest.valid_until))


def stand_word(
    condition: StandCondition | None, certificates: Sequence[StandCertificate], flags: int, today: date
) -> StandWord:
    """The worst that is known of it; ``flags``: how many are open that find it at fault."""
    shifted = condition is not None and condition.has_shifted
    found = [_certificate_word(held(certificates, today), today), CHECK if shifted or flags else READY]
    return min(found, key=WORDS.index)


def condition_in_words(condition: StandCondition | None, *, is_pending: bool) -> str:
    """The condition by the units measured on it; ``is_pending``: it is being worked out."""
    if is_pending and (condition is None or not condition.evidence):
        return PENDING
    return TOO_FEW if condition is None else condition.reason


def _certificate_word(latest: StandCertificate | None, today: date) -> StandWord:
    if latest is None:
        return NOT_STATED
    if latest.valid_until < today:
        return EXPIRED_TODAY
    return SOON_OVER if latest.valid_until < today + SOON else READY
