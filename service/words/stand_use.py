"""Whether a stand may be used today, as the crew needs to know before it mounts a unit."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date, timedelta

from service.records.paper import StandCertificate
from service.records.stand import StandCondition
from service.words.names import day_of
from service.words.stands import TOO_FEW

NONE = "No certificate on record: sessions on this stand state no traceability."
NOT_YET = "Its certificate is issued on {issued}, which is still to come: until then sessions state no traceability."
HOLDS = "Sessions on this stand are traceable until {until}."
EXPIRED = "Its certificate expired on {until}: traceability of sessions after that day is interrupted."
SOON = timedelta(days=30)
"""In which a laboratory can still have a stand calibrated before its certificate ends."""


@dataclass(frozen=True)
class StandWord:
    """What the crew does with a stand today, and why."""

    key: str
    """Name of the icon and the style."""
    word: str
    advice: str
    """What to do."""


READY = StandWord("pass", "Ready to use", "Nothing that is on record speaks against it.")
SOON_OVER = StandWord("conditional-pass", "Ready to use", "Its certificate ends soon: have the stand calibrated.")
NOT_STATED = StandWord("undecidable", "Usable, traceability not stated", "Record the certificate of the stand.")
CHECK = StandWord("conditional-fail", "Check before use", "Check stand and fixture before a unit is mounted.")
EXPIRED_TODAY = StandWord("fail", "Not traceable today", "Have the stand calibrated, or record its new certificate.")
WORDS = (EXPIRED_TODAY, CHECK, NOT_STATED, SOON_OVER, READY)
"""Worst first."""


def held(certificates: Sequence[StandCertificate], today: date) -> StandCertificate | None:
    """The latest certificate that was issued by today, whether it still holds or not; they come by issue."""
    issued = [certificate for certificate in certificates if certificate.issued_on <= today]
    return issued[-1] if issued else None


def certificate_in_words(certificates: Sequence[StandCertificate], today: date) -> str:
    """What sessions of today would hang on."""
    latest = held(certificates, today)
    if latest is None:
        return NOT_YET.format(issued=day_of(certificates[0].issued_on)) if certificates else NONE
    return (HOLDS if latest.valid_until >= today else EXPIRED).format(until=day_of(latest.valid_until))


def stand_word(
    condition: StandCondition | None, certificates: Sequence[StandCertificate], flags: int, today: date
) -> StandWord:
    """The worst that is known of it; ``flags``: how many are open that find it at fault."""
    shifted = condition is not None and condition.has_shifted
    found = [_certificate_word(held(certificates, today), today), CHECK if shifted or flags else READY]
    return min(found, key=WORDS.index)


def condition_in_words(condition: StandCondition | None) -> str:
    """What the units measured on it show."""
    return TOO_FEW if condition is None else condition.reason


def _certificate_word(latest: StandCertificate | None, today: date) -> StandWord:
    if latest is None:
        return NOT_STATED
    if latest.valid_until < today:
        return EXPIRED_TODAY
    return SOON_OVER if latest.valid_until < today + SOON else READY
