"""What the numbers of a session hang on, in words; never more than what is on record."""

from datetime import date

from service.records.paper import StandCertificate, Traceability, TraceState
from service.words.names import day_of

HOLDS = (
    "Traceable to the SI through stand {stand}: certificate {number} of {by}, issued {issued}, valid until {until}. "
    "It held at the day of measurement, {day}."
)
EXPIRED = (
    "Traceability is interrupted: certificate {number} of stand {stand}, issued by {by} on {issued}, had expired on "
    "{until}, before the day of measurement, {day}."
)
NOT_ON_RECORD = (
    "Traceability is not stated: no certificate of stand {stand} that was issued by the day of measurement, {day}, is "
    "on record."
)
NO_STAND = "Traceability is not stated: no stand was used, and gravity at the site carries no certificate."


def traceability(stand: str | None, certificate: StandCertificate | None, day: date) -> Traceability:
    """Of a session measured on a day; the certificate is the latest of its stand that was issued by then."""
    if stand is None:
        return Traceability(TraceState.NO_STAND, NO_STAND, None)
    if certificate is None:
        text = NOT_ON_RECORD.format(stand=stand, day=day_of(day))
        return Traceability(TraceState.NOT_STATED, text, None)
    expired = certificate.valid_until < day
    text = (EXPIRED if expired else HOLDS).format(
        stand=stand,
        number=certificate.number,
        by=certificate.issued_by,
        issued=day_of(certificate.issued_on),
        until=day_of(certificate.valid_until),
        day=day_of(day),
    )
    return Traceability(TraceState.INTERRUPTED if expired else TraceState.TRACEABLE, text, certificate)
