"""Unit types with their tolerances, and what other tolerances would change."""

from dataclasses import dataclass
from datetime import datetime

from estimator.health.type_law import TypeLaw
from service.kit.answer import answer
from service.sessions.decision import Verdict

answer(TypeLaw)


@answer
@dataclass(frozen=True)
class Tolerances:
    """Largest allowed deviations from the reference; null where a parameter is not judged."""

    scale: float | None
    """Relative: 1e-6 is 1 ppm."""
    bias: float | None
    """m/s² (rad/s)."""
    quadratic: float | None
    """s²/m (s/rad)."""
    axis: float | None
    """rad."""


@answer
@dataclass(frozen=True)
class UnitType:
    """A kind of unit: nominal axes and tolerances that all its units share."""

    name: str
    """Name of the type."""
    block: str
    """`accelerometer` or `gyroscope`; empty of a type of which no unit was measured yet."""
    sensors: tuple[str, ...]
    """Names of the sensors."""
    nominal_axes: tuple[tuple[float, float, float], ...]
    """Unit vectors in block axes."""
    nominal_scales: tuple[float, ...]
    """Reading unit per m/s² (rad/s)."""
    tolerances: Tolerances
    """Tolerances of the sensors of the block's own kind."""
    gyro_tolerances: Tolerances | None
    """Tolerances of the gyros of a block of accelerometers."""
    revision: int
    """Counts up with every change of tolerances; decisions name theirs."""
    maximum_interval_days: float = 365.0
    """Longest time from a session to the next calibration."""
    flag_share: float = 0.3
    """Part of the tolerance from which on a change within it has a flag; a smaller one is a remark."""
    temperature_laws: tuple[TypeLaw, ...] = ()
    """Temperature laws common to the type's units, as far as in force."""
    are_entered: bool = True
    """Whether somebody entered the tolerances; else they are defaults, and a parameter whose reference is too uncertain
    for its default is judged by three times the U of a change."""
    holds_before: bool = False
    """Whether the tolerances in force judge sessions from before them too."""


@dataclass(frozen=True)
class ToleranceRevision:
    """Tolerances of a type from a time on."""

    revision: int
    since: datetime
    tolerances: Tolerances
    gyro_tolerances: Tolerances | None
    temperature_laws: tuple[TypeLaw, ...] = ()
    are_entered: bool = True


@dataclass(frozen=True)
class TypeUse:
    """The units of a type by their condition."""

    units: int
    verdicts: dict[Verdict, int]
    """Number of units with an accepted session, by verdict; every verdict is a key."""


@answer
@dataclass(frozen=True)
class WantedTolerances:
    """Tolerances that somebody tries, or that are proposed."""

    tolerances: Tolerances
    """Tolerances of the block's sensors."""
    gyro_tolerances: Tolerances | None
    """Tolerances of its gyros where it has accelerometers too; else null."""


@dataclass(frozen=True)
class LatestSession:
    """The session of a unit's verdict."""

    unit: str
    key: int
    """Key of the unit."""
    session: str
    started_at: datetime
    block: str
    programme: str
    is_reference: bool
    temperature: float | None
    """°C"""
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
    """Verdict as it is stored."""
    after: Verdict
    """Verdict under the other tolerances."""
    sensor: str
    """Sensor that sets it; empty where nothing would be judged."""
    parameter: str
    """Parameter that sets it."""
    reason: str
    """Reason for the other verdict, in one sentence."""


@answer
@dataclass(frozen=True)
class TolerancePreview:
    """Effect of other tolerances on the verdicts of a type's units."""

    units: int
    """Units of the type with a session that counts."""
    judged: int
    """Units whose latest session was judged by the other tolerances."""
    references: int
    """Units whose latest session is judged against nothing."""
    recordings: int
    """Units whose latest session is a recording in service without a calibration to compare it with."""
    beyond: int
    """Units that were not examined, because there are so many."""
    changes: tuple[VerdictChange, ...]
    """Units that would have another verdict, the worst first."""
