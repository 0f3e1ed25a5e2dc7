"""The answer to the one question of a ground computer: may this unit be used?"""

from dataclasses import dataclass
from datetime import datetime

from service.records.decision import Verdict


@dataclass(frozen=True)
class Usable:
    """Whether a unit may be used now, and why."""

    usable: bool
    why: str
    """In one sentence."""
    reasons: tuple[str, ...]
    """Everything that speaks against it; empty where it may be used."""
    reservations: tuple[str, ...]
    """What must be known although it does not forbid the use."""
    until: datetime | None
    """The answer holds no longer than that: the next calibration is due."""
    verdict: Verdict | None
    """Of the session that the answer rests on."""
    session: str | None
    """The latest judged one; None where there is none since the last service."""
    correction: str | None
    """Id of the session whose correction firmware applies; None where no session calibrates every sensor."""
    as_of: datetime
    """When it was asked."""
