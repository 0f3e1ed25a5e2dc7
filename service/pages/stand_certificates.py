"""The page of all stands with the certificates of their own calibration."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import date

from service.records.paper import StandCertificate
from service.words.names import day_of

NONE = "No certificate on record: sessions on this stand state no traceability."
HOLDS = "Sessions on this stand are traceable until {until}."
EXPIRED = "Expired on {until}: traceability of sessions after that day is interrupted."


@dataclass(frozen=True)
class StandCard:
    """One stand."""

    name: str
    text: str
    tone: str
    certificates: tuple[tuple[str, str, str, str], ...]
    """Number, issued by, issued on, valid until; the latest first."""


@dataclass(frozen=True)
class StandCertificatesPage:
    """Everything that the page shows."""

    cards: tuple[StandCard, ...]


def stand_certificates_page(stands: Mapping[str, Sequence[StandCertificate]], today: date) -> StandCertificatesPage:
    """All stands, by name."""
    return StandCertificatesPage(tuple(_card(name, own, today) for name, own in stands.items()))


def _card(name: str, own: Sequence[StandCertificate], today: date) -> StandCard:
    rows = tuple((c.number, c.issued_by, day_of(c.issued_on), day_of(c.valid_until)) for c in reversed(own))
    issued = [certificate for certificate in own if certificate.issued_on <= today]
    if not issued:
        return StandCard(name, NONE, "undecidable", rows)
    until = issued[-1].valid_until
    holds = until >= today
    return StandCard(name, (HOLDS if holds else EXPIRED).format(until=day_of(until)), "pass" if holds else "fail", rows)
