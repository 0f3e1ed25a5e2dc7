"""Statements of certificates: signatures, traceability, uncertainty."""

from datetime import date, datetime

from estimator.coverage import chance
from estimator.message import joined, say
from estimator.results import Calibration
from estimator.session import IN_SERVICE
from service.kit.measures import coverage_in_words, day_of, minute_of, noise_is_estimated, number
from service.papers.records import NOT_STATED, Laboratory, Meaning, Traceability, TraceState
from service.sessions.records import StoredSession
from service.stands.records import StandCertificate
from service.units.records import Customer

RELATES = "The results relate only to the item calibrated, as it was on the day of measurement."
WHOLE = "This certificate may be reproduced only in full, except with the written approval of the laboratory."
SAMPLING = "None: every sensor of the item was measured."
RECEIVED = "not stated (not critical to the results)"
DRAFT = "Draft, not an accredited certificate: {missing} not stated."


def missing_facts(laboratory: Laboratory, customer: Customer, *, dated: bool) -> tuple[str, ...]:
    """Required facts of a calibration certificate that are not stated."""
    required = (
        ("name of the laboratory", laboratory.name),
        ("address of the laboratory", laboratory.address),
        ("country of the laboratory", laboratory.country),
        ("name of the customer", customer.name),
        ("address of the customer", customer.address),
        ("day of measurement", dated),
    )
    return tuple(name for name, value in required if not value)


def draft_in_words(missing: tuple[str, ...]) -> str:
    """The statement that the paper is a draft, and why; empty where nothing is missing."""
    if not missing:
        return ""
    names = (
        missing[0]
        if len(missing) == 1
        else say("{first} and {last}", first=joined(", ", missing[:-1]), last=missing[-1])
    )
    return say(DRAFT, missing=names)


def stated(text: str) -> str:
    """The text, or that there is none."""
    return text.strip() or NOT_STATED


STATES = {
    Meaning.REVIEWED: "I have checked record, results, uncertainties and statements of this certificate, and have "
    "found nothing against them.",
    Meaning.APPROVED: "I release this certificate in the name of the laboratory.",
}
"""Statement of a signer."""
BOUND = "Signed in imu-health with the password asked again; holds for the content with SHA-256 {hash}."
NO_LONGER = (
    "The data of certificate {number} have changed since it was {done}: it no longer states what is stored. The next "
    "certificate has another number and must be signed again."
)
CHANGED_HASH = "Certificate {number} was signed for other content than is stored: the database was changed."
NOT_COUNTED = "The session no longer counts: certificate {number} should not be used."


def title_of(session: StoredSession) -> str:
    """A recording in service checks a calibration, but is none. A simulation certifies nothing."""
    if session.simulated:
        return "Specimen, not a certificate"
    return "Check in service" if session.programme == IN_SERVICE else "Calibration certificate"


def done_by(meaning: Meaning) -> str:
    """``Reviewed by``."""
    return say("{meaning} by", meaning=meaning.capitalize())


def moment_of(at: datetime) -> str:
    """``7 Mar 2026, 09:30 UTC``."""
    return minute_of(at)


HOLDS = (
    "Traceable to the SI through stand {stand}: certificate {number} of {by}, issued {issued}, valid until {until}. "
    "It held at the day of measurement, {day}."
)
EXPIRED = (
    "Traceability is interrupted: certificate {number} of stand {stand}, issued by {by} on {issued}, had expired on "
    "{until}, before the day of measurement, {day}."
)
NOT_ON_RECORD = (
    "Traceability is not stated: no certificate of stand {stand} issued by the day of measurement, {day}, is recorded."
)
NO_STAND = "Traceability is not stated: no stand was used, and gravity at the site carries no certificate."


def traceability(stand: str | None, certificate: StandCertificate | None, day: date) -> Traceability:
    """The traceability of a session measured on a day, by the latest certificate of its stand issued by then."""
    if stand is None:
        return Traceability(TraceState.NO_STAND, NO_STAND, None)
    if certificate is None:
        text = say(NOT_ON_RECORD, stand=stand, day=day_of(day))
        return Traceability(TraceState.NOT_STATED, text, None)
    expired = certificate.valid_until < day
    text = say(
        EXPIRED if expired else HOLDS,
        stand=stand,
        number=certificate.number,
        by=certificate.issued_by,
        issued=day_of(certificate.issued_on),
        until=day_of(certificate.valid_until),
        day=day_of(day),
    )
    return Traceability(TraceState.INTERRUPTED if expired else TraceState.TRACEABLE, text, certificate)


NORMAL = (
    "The reported expanded uncertainty of measurement is stated as the standard uncertainty of measurement multiplied "
    "by the coverage factor k = {k}, which for a normal distribution corresponds to a coverage probability of "
    "approximately {percent} %."
)
STUDENT = (
    "The reported expanded uncertainty of measurement is stated as the standard uncertainty of measurement multiplied "
    "by the coverage factor {k}; for a t-distribution of these degrees of freedom it corresponds to a coverage "
    "probability of approximately {percent} %."
)
BY = "The standard uncertainty of measurement has been determined in accordance with EA-4/02."


def uncertainty_in_words(calibration: Calibration, k: float) -> str:
    """The statement of uncertainty with the coverage factor of the decisions."""
    percent = number(100 * (2.0 * chance(k, None) - 1.0), 0)
    if noise_is_estimated(calibration):
        parts = {"coverage": say(STUDENT, k=coverage_in_words(calibration, k), percent=percent), "source": BY}
        return say("{coverage} {source}", **parts)
    return say("{coverage} {source}", coverage=say(NORMAL, k=number(k), percent=percent), source=BY)
