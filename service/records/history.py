"""One parameter of one sensor through time."""

from dataclasses import dataclass
from datetime import datetime

from pydantic import computed_field

from service.records.answer import answer
from service.records.decision import Verdict
from service.records.instants import epoch_ms


@answer
@dataclass(frozen=True)
class HistoryPoint:
    """One parameter of one sensor at one session, ready for drawing a band."""

    session: str
    """Id of the session."""
    at: datetime
    """When it was measured, UTC."""
    sensor: str
    """Name of the sensor."""
    kind: str
    """`accelerometer` or `gyroscope`."""
    parameter: str
    """`scale`, `bias`, `quadratic`, `axis`, `misalignment`, or a term of noise at rest."""
    value: float | None
    """SI; for the axis the angle from the reference axis as judged, rad."""
    u: float | None
    """Standard uncertainty of the value."""
    lower: float | None
    """Value minus expanded uncertainty; of a term of noise the end of its 95 % interval."""
    upper: float | None
    """Value plus expanded uncertainty; of a term of noise the end of its 95 % interval."""
    reference: float | None
    """The value that it is judged against."""
    deviation: float | None
    """From the reference, as it was judged: relative for scale, else SI."""
    expanded: float | None
    """U of the deviation, of both sessions."""
    tolerance: float | None
    """In the unit of the value; null where it is not judged."""
    verdict: Verdict
    """The state of this parameter at this session."""
    is_reference: bool
    """Whether the session is one that later ones are judged against."""
    axis: tuple[float, float, float] | None
    """For the axis: its components in block axes."""
    revision: int = 0
    """Model revision that it was computed under; 0 is the baseline."""

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def at_ms(self) -> int:
        """`at` in milliseconds since 1970."""
        return epoch_ms(self.at)
