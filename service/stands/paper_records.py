"""The certificate of a stand's own calibration."""

from dataclasses import dataclass
from datetime import date

from service.kit.answer import answer


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
