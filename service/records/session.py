"""A stored session, what an upload is answered with, and what a session's page shows."""

from dataclasses import dataclass
from datetime import datetime

from service.records.answer import Hidden, answer
from service.records.decision import Verdict
from service.records.reservation import Reservations
from service.records.state import RecordState

PARAMETERS = ("scale", "bias", "quadratic", "axis")
"""What a calibration gives of every sensor."""


ALL_PARAMETERS = (*PARAMETERS, "misalignment")
"""With what only a turntable shows."""


@answer
@dataclass(frozen=True)
class StoredSession:
    """One stored session."""

    id: str
    """The first 20 digits of the content's SHA-256."""
    unit: str
    """Serial number of the unit."""
    sha256: str
    """SHA-256 of the uploaded bytes."""
    filename: str
    """What the file was called when it was uploaded."""
    size: int
    """Bytes."""
    programme: str
    """How it was measured."""
    stand: str | None
    """The stand, if one was used."""
    operator: str
    """Who measured, as the file says."""
    notes: str
    """Notes of the file."""
    started_at: datetime
    """When it was measured, UTC; the upload's time if the file does not say."""
    uploaded_at: datetime
    """When it was uploaded, UTC."""
    verdict: Verdict
    """The worst of the session's parameters."""
    reason: str
    """Why the verdict is what it is, in one sentence."""
    is_reference: bool
    """Whether later sessions are judged against this one."""
    simulated: bool
    """Whether it was simulated, not measured."""
    revision: int = 0
    """Model revision that its calibration in force was made under; 0 is the baseline."""
    stage: str | None = None
    """`as-found`, `as-left`, or null where neither was said."""
    reservations: Hidden[Reservations] = ()
    """What the verdict is said with."""
    state: RecordState = RecordState.ACCEPTED
    """Only an accepted session tells of its unit."""
    superseded_by: str | None = None
    """The session that stands for a superseded one."""
    temperature: Hidden[float | None] = None
    """°C, the mean over the session; None where it was not recorded."""
    is_check: bool = False
    """Whether it is only a check, which moves no due date unless it is a reference."""


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


@answer
@dataclass(frozen=True)
class Receipt:
    """The answer to an upload."""

    id: str
    """The session's id, made from the content: the same bytes have the same id."""
    unit: str
    """Serial number of the unit."""
    verdict: Verdict
    """Of the session: the worst of its parameters."""
    reason: str
    """Why, in one sentence."""
    created: bool
    """False when the same bytes were already stored."""
    is_reference: bool
    """Whether later sessions are judged against this one; then its own verdict is `undecidable`."""
    reservations: Hidden[Reservations] = None
    """What the verdict is said with."""
    state: RecordState = RecordState.ACCEPTED
    """`questioned` where the file cannot be as it says; then it tells nothing."""
    is_check: bool = False
    """Whether it is only a check; of what was stored before, as that was."""
