"""One parameter of one sensor through time."""

from dataclasses import dataclass
from datetime import datetime

from service.records.decision import Verdict
from service.records.instants import epoch_ms


@dataclass(frozen=True)
class HistoryPoint:
    """One parameter of one sensor at one session, ready for drawing a band."""

    session: str
    at: datetime
    sensor: str
    kind: str
    parameter: str
    value: float | None
    """SI; for the axis the angle from the reference axis, rad, what the whole block did taken off unless asked for."""
    u: float | None
    """Standard uncertainty of value."""
    lower: float | None
    """value − U."""
    upper: float | None
    reference: float | None
    deviation: float | None
    """From the reference, as it was judged: relative for scale, else SI; None where there was none to compare with."""
    expanded: float | None
    """U of the deviation, of both sessions."""
    tolerance: float | None
    """In the unit of value (for scale: relative tolerance times the reference); None where it is not judged."""
    verdict: Verdict
    is_reference: bool
    """Whether the session is one that later ones are judged against."""
    axis: tuple[float, float, float] | None
    revision: int = 0
    """The model revision that it was computed under."""

    @property
    def at_ms(self) -> int:
        """``at`` in milliseconds since 1970."""
        return epoch_ms(self.at)
