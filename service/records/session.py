"""A stored session, what an upload is answered with, and what a session's page shows."""

from dataclasses import dataclass
from datetime import datetime

from service.records.decision import Verdict
from service.records.reservation import Reservations
from service.records.state import RecordState

PARAMETERS = ("scale", "bias", "quadratic", "axis")
"""What a calibration gives of every sensor."""


ALL_PARAMETERS = (*PARAMETERS, "misalignment")
"""With what only a turntable shows."""


@dataclass(frozen=True)
class StoredSession:
    """One uploaded session. ``id`` is made from the content, so the same bytes always have the same id."""

    id: str
    unit: str
    sha256: str
    filename: str
    size: int
    programme: str
    stand: str | None
    operator: str
    notes: str
    started_at: datetime
    """UTC; the upload's time when the file states none."""
    uploaded_at: datetime
    verdict: Verdict
    reason: str
    """Why the verdict is what it is, in one sentence a technician understands."""
    is_reference: bool
    simulated: bool
    revision: int = 0
    """The model revision that the calibration in force was made under; 0 is the baseline."""
    stage: str | None = None
    """``as-found`` before the unit was worked on, ``as-left`` after; None where neither was said."""
    reservations: Reservations = ()
    """What the verdict is said with."""
    state: RecordState = RecordState.ACCEPTED
    """Only an accepted session tells of its unit."""
    superseded_by: str | None = None
    """The session that stands for a superseded one."""
    temperature: float | None = None
    """°C, the mean over the session; None where it was not recorded."""
    is_check: bool = False
    """Whether it only looks after the unit: it is judged, and the next calibration is due when it was due before."""


@dataclass(frozen=True)
class Digests:
    """By which a session is recognised, whatever its file's bytes."""

    content_digest: str
    """Of everything that it says."""
    readings_digest: str
    """Of its readings alone."""


@dataclass(frozen=True)
class ParameterValue:
    """One parameter of one sensor as a session measured it."""

    sensor: str
    sensor_index: int
    kind: str
    parameter: str
    value: float | None
    """SI; None for the axis, which has components instead."""
    u: float | None
    """Standard uncertainty; for the axis the root of the trace of its covariance, rad."""
    axis: tuple[float, float, float] | None


@dataclass(frozen=True)
class Receipt:
    """The answer to an upload."""

    id: str
    unit: str
    verdict: Verdict
    reason: str
    created: bool
    """False when the same bytes were already stored."""
    is_reference: bool
    """Whether later sessions are judged against this one."""
    reservations: Reservations = None
    """What the verdict is said with."""
    state: RecordState = RecordState.ACCEPTED
    is_check: bool = False
