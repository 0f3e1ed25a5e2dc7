"""Results of a readiness check."""

from dataclasses import dataclass
from enum import StrEnum

from estimator.codec import Document
from estimator.readiness.faults import RecordFault
from estimator.session import Array


class ReadinessState(StrEnum):
    """The answer."""

    READY = "ready"
    NOT_STILL = "not-still"
    NOT_WARM = "not-warm"
    TOO_EARLY = "too-early"
    CANNOT_TELL = "cannot-tell"


class DisturbanceKind(StrEnum):
    """Kind of disturbance."""

    STEP = "step"
    """The reading is another one afterwards."""
    BURST = "burst"
    """It shook for a while."""
    SHAKING = "shaking"
    """It shakes all the time, more than vibration rectification allows."""
    CLIPPED = "clipped"
    """It stands at the end of its range."""
    CREEP = "creep"
    """All sensors drift as if the block turned."""


@dataclass(frozen=True)
class Disturbance(Document, keys={"start": "start_s", "stop": "stop_s"}):
    """One reason why the block is not still."""

    kind: DisturbanceKind
    sensors: tuple[str, ...]
    start: float
    """s since the record's first row."""
    stop: float
    """s since the record's first row."""
    size: float
    """Largest value, m/s² or rad/s; share of the samples for a clipped channel; rad over the programme for a creep."""
    passed: bool = False
    """Whether the part after it is judged without it."""


@dataclass(frozen=True)
class DriftOutlook(
    Document,
    order=(
        "name", "expected", "bound", "allowed", "limit", "chance", "bias_share", "scale_share", "wander", "wait",
        "needed",
    ),
    keys={"wait": "wait_s", "needed": "needed_s"},
):  # fmt: skip
    """Forecast of the drift of one sensor, or of the thermometer."""

    name: str
    kind: str
    expected: float
    """Median of the largest departure from its present value during the programme, m/s² or rad/s (K)."""
    bound: float
    """Departure that is not exceeded with 95 % probability, the same unit."""
    chance: float
    """Chance that the departure exceeds what is allowed."""
    allowed: float
    """m/s² or rad/s (K)."""
    limit: str
    """``bias`` or ``scale``: the parameter whose tolerance is the nearer one."""
    wait: tuple[float, float, float] | None
    """s more until the drift to come is allowed, 5 %, 50 % and 95 % quantile; None where it is, or waiting is no
    help."""
    needed: float | None
    """s more of record until it can be judged; None where it can, or no length of it would do."""
    wander: float
    """One sigma of the sensor's own slow noise over the programme, m/s² or rad/s (K)."""
    bias_share: float | None = None
    """The bound as a share of the tolerance of the bias."""
    scale_share: float | None = None
    """The bound as a share of the tolerance of the scale factor, were it all of that."""


@dataclass(frozen=True, eq=False)
class Readiness(
    Document,
    format="imu-readiness/1",
    order=(
        "unit", "state", "ready", "duration", "recorded", "judged_from", "wait", "needed", "outlooks", "warmed",
        "temperature", "disturbances", "faults",
    ),
    keys={
        "duration": "duration_s", "recorded": "recorded_s", "judged_from": "judged_from_s", "wait": "wait_s",
        "needed": "needed_s", "outlooks": "sensors", "warmed": "warmed_k",
    },
):  # fmt: skip
    """The answer with its reasons."""

    unit: str
    state: ReadinessState
    outlooks: tuple[DriftOutlook, ...]
    disturbances: tuple[Disturbance, ...]
    faults: tuple[RecordFault, ...]
    """Reasons why no judgement is possible, and oddities of the record."""
    duration: float
    """s of the planned programme."""
    recorded: float
    """s of record."""
    judged_from: float
    """s since the first row from which on it was judged."""
    time: Array
    """(n,) s, middles of the means that were judged, since the first row."""
    change: Array
    """(n, m) their change since the first of them, m/s² or rad/s, position by position."""
    names: tuple[str, ...]
    temperature: DriftOutlook | None = None
    """Forecast of the zeros by the thermometer and the stated coefficient; None without either."""
    warmed: float | None = None
    """Rise of the thermometer over the judged part, K."""

    @property
    def ready(self) -> bool:
        """Whether the measurement may begin."""
        return self.state is ReadinessState.READY

    @property
    def wait(self) -> tuple[float, float, float] | None:
        """Further wait, s, quantiles 5 %, 50 % and 95 %, of the sensor that needs longest; None where waiting is no
        help.
        """
        waits = [outlook.wait for outlook in self._judged if outlook.wait is not None]
        return max(waits, key=lambda wait: wait[1]) if waits and self.state is ReadinessState.NOT_WARM else None

    @property
    def needed(self) -> float | None:
        """s more of record until it can be judged; None where it can, or no length would do."""
        lengths = [outlook.needed for outlook in self._judged if outlook.needed is not None]
        return max(lengths) if lengths and self.state is ReadinessState.TOO_EARLY else None

    @property
    def worst(self) -> DriftOutlook | None:
        """The sensor whose drift takes most of what is allowed."""
        return max(self._judged, key=lambda outlook: outlook.bound / outlook.allowed, default=None)

    @property
    def _judged(self) -> tuple[DriftOutlook, ...]:
        return self.outlooks if self.temperature is None else (*self.outlooks, self.temperature)
