"""What papers name besides the measurement: laboratory, customer, the stand's own certificate, their own numbers."""

from dataclasses import dataclass
from datetime import date, datetime
from enum import StrEnum

from service.records.answer import answer

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


@answer
@dataclass(frozen=True)
class Customer:
    """For whom a unit is calibrated, as its certificates name them."""

    name: str = ""
    """Empty where it is not stated."""
    address: str = ""
    """Where they can be reached."""


NOBODY = Customer()
"""Of a unit for which no customer is stated."""


@answer
@dataclass(frozen=True)
class StandCertificate:
    """The certificate of a stand's own calibration."""

    stand: str
    """Name of the stand."""
    number: str
    """As printed on it."""
    issued_by: str
    """The laboratory that calibrated the stand."""
    issued_on: date
    """From this day on it speaks for the stand."""
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


@answer
@dataclass(frozen=True)
class Traceability:
    """What a session's numbers hang on."""

    state: TraceState
    """`traceable`; `interrupted`: the stand's certificate had expired at the day of measurement; `not-stated`: none
    that held is on record; `no-stand`."""
    text: str
    """In one or two sentences, as on the certificate."""
    certificate: StandCertificate | None
    """Of the stand, the latest that was issued by the day of measurement."""

    @property
    def has_expired(self) -> bool:
        """Whether the stand's certificate had expired at the day of measurement."""
        return self.state is TraceState.INTERRUPTED


@answer
@dataclass(frozen=True)
class Issue:
    """One issue of a session's certificate."""

    number: str
    """Session, model revision, and count of the issue."""
    session: str
    """Id of the session."""
    revision: int
    """Model revision of its numbers; 0 is the baseline."""
    issued_at: datetime
    """UTC."""
    who: str
    """Who issued it."""
    replaces: str | None
    """Number of the certificate that it takes the place of."""
    content_hash: str
    """SHA-256 of all that it states."""
