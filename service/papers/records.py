"""Statements of papers besides the measurement, and the signatures under them."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from service.kit.answer import answer
from service.stands.records import StandCertificate

NOT_STATED = "not stated"
"""Stands in a paper for a name that was not given: nothing is made up."""


@dataclass(frozen=True)
class Laboratory:
    """The laboratory, from the settings; empty texts are not stated."""

    name: str = ""
    address: str = ""
    country: str = ""
    """ISO 3166-1 alpha-2."""
    place: str = ""
    """Place of measurement, if not at its address."""


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
    """Traceability of a session's results to the SI."""

    state: TraceState
    """`traceable`; `interrupted`: the stand's certificate had expired at the day of measurement; `not-stated`: none
    that held is on record; `no-stand`."""
    text: str
    """Statement in one or two sentences, as on the certificate."""
    certificate: StandCertificate | None
    """Certificate of the stand, the latest that was issued by the day of measurement."""

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
    """Person who issued it."""
    replaces: str | None
    """Number of the certificate that it takes the place of."""
    content_hash: str
    """SHA-256 of all that it states."""


class Meaning(StrEnum):
    """Meaning of a signature; in the order in which they are given."""

    REVIEWED = "reviewed"
    APPROVED = "approved"


@answer
@dataclass(frozen=True)
class Signature:
    """One signature under a certificate."""

    certificate: str
    """Number of the certificate."""
    meaning: Meaning
    """Meaning of the signature."""
    login: str
    """Account that signed, with its password."""
    name: str
    """Name of the signer as it is printed."""
    signed_at: datetime
    """UTC."""
    content_hash: str
    """SHA-256 of all that the certificate stated when it was signed."""


@dataclass(frozen=True)
class Signed:
    """Signatures of an issue, and the owner of its seal."""

    signatures: tuple[Signature, ...] = ()
    sealed_by: str = ""
    """Owner of the seal; empty without a seal."""


UNSIGNED = Signed()
"""An issue without signatures."""


@dataclass(frozen=True)
class CertificateFile:
    """An approved issue as it is handed out, byte by byte."""

    format: str
    """``pdf`` or ``dcc``."""
    content: bytes
    sha256: str
    sealed_by: str
    """Subject of the certificate of the laboratory's key; empty where it has none."""


@answer
@dataclass(frozen=True)
class RestingCertificate:
    """An issued certificate whose numbers rest on a stand."""

    number: str
    """Number of the certificate."""
    unit: str
    """Serial number."""
    session: str
    """Id of the session."""
    started_at: datetime
    """Start of the measurement, UTC."""
    issued_at: datetime
    """UTC."""
    is_measured_there: bool
    """Whether the session was measured on the stand; if not, its reference was."""
