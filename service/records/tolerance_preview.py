"""What other tolerances would change in a unit type, if the latest sessions of its units were judged by them."""

from dataclasses import dataclass
from datetime import datetime

from service.records.answer import answer
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


@answer
@dataclass(frozen=True)
class VerdictChange:
    """A unit that would have another verdict."""

    unit: str
    """Serial number."""
    session: str
    """Id of its latest session."""
    before: Verdict
    """As it is stored."""
    after: Verdict
    """Under the other tolerances."""
    sensor: str
    """The sensor that it hangs on; empty where nothing would be judged."""
    parameter: str
    """The parameter that it hangs on."""
    reason: str
    """Why, in one sentence."""


@answer
@dataclass(frozen=True)
class TolerancePreview:
    """What other tolerances would change."""

    units: int
    """Units of the type with a session that counts."""
    judged: int
    """Those whose latest session was judged by the other tolerances."""
    references: int
    """Those whose latest session is judged against nothing."""
    recordings: int
    """Those whose latest session is a recording in service that no calibration stands beside."""
    beyond: int
    """Those that were not looked at, because there are so many."""
    changes: tuple[VerdictChange, ...]
    """Units that would have another verdict, the worst first."""
