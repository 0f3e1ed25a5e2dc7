"""What other tolerances would change in a unit type, if the latest sessions of its units were judged by them."""

from dataclasses import dataclass
from datetime import datetime

from service.records.decision import Verdict
from service.records.unit import Tolerances


@dataclass(frozen=True)
class WantedTolerances:
    """What somebody thinks of setting."""

    tolerances: Tolerances
    gyro_tolerances: Tolerances | None


@dataclass(frozen=True)
class LatestSession:
    """The session that a unit's verdict is of."""

    unit: str
    key: int
    """Of the unit."""
    session: str
    started_at: datetime
    block: str
    programme: str
    is_reference: bool
    verdict: Verdict


@dataclass(frozen=True)
class VerdictChange:
    """A unit that would have another verdict."""

    unit: str
    session: str
    before: Verdict
    after: Verdict
    sensor: str
    parameter: str
    """That the other verdict hangs on; both empty where nothing would be judged."""
    reason: str
    """In a sentence."""


@dataclass(frozen=True)
class TolerancePreview:
    """What other tolerances would change."""

    units: int
    """Of the type, with a session that counts."""
    judged: int
    """Of them, those whose latest session was judged by them; a reference is judged by nothing."""
    references: int
    recordings: int
    """Units whose latest session is a recording in service that was compared with no calibration."""
    beyond: int
    """Units that were not looked at, because there are so many."""
    changes: tuple[VerdictChange, ...]
    """Worst first."""
