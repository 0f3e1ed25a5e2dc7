"""What papers name besides the measurement: laboratory, customer, the stand's own certificate, their own numbers."""

from dataclasses import dataclass
from datetime import date, datetime
from enum import StrEnum

NOT_STATED = "not stated"
"""Stands in a paper where a name is wanted and nobody gave one: nothing is ever made up."""


@dataclass(frozen=True)
class Laboratory:
    """Who calibrates, as the operator of the service set it; empty texts are not stated."""

    name: str = ""
    address: str = ""
    country: str = ""
    """ISO 3166-1 alpha-2."""
    place: str = ""
    """Where it measures, if that is not at its address."""


@dataclass(frozen=True)
class Customer:
    """For whom a unit is calibrated; empty texts are not stated."""

    name: str = ""
    address: str = ""


NOBODY = Customer()
"""Of a unit for which no customer is stated."""


@dataclass(frozen=True)
class StandCertificate:
    """The certificate of a stand's own calibration."""

    stand: str
    number: str
    issued_by: str
    issued_on: date
    valid_until: date
    """The last day on which it holds."""


class TraceState(StrEnum):
    """Whether the chain from the unit to the SI holds, as far as it is on record."""

    TRACEABLE = "traceable"
    INTERRUPTED = "interrupted"
    """The stand's certificate had expired at the day of measurement."""
    NOT_STATED = "not-stated"
    """No certificate that held at the day of measurement is on record."""
    NO_STAND = "no-stand"


@dataclass(frozen=True)
class Traceability:
    """What a session's numbers hang on."""

    state: TraceState
    text: str
    """In one or two sentences."""
    certificate: StandCertificate | None
    """Of the stand, the latest that was issued by the day of measurement."""

    @property
    def has_expired(self) -> bool:
        """Whether the stand's certificate had expired at the day of measurement."""
        return self.state is TraceState.INTERRUPTED


@dataclass(frozen=True)
class Issue:
    """One issue of a session's certificate."""

    number: str
    session: str
    revision: int
    issued_at: datetime
    who: str
    replaces: str | None
    """Number of the certificate that this one takes the place of; None for a session's first."""
    content_hash: str
    """SHA-256 of all that it states."""
