"""Members of the demonstration fleet and the events of each unit. Amounts: ppm, µg (gyro: °/h), µg/g², arcsec."""

from dataclasses import dataclass, field
from datetime import UTC, datetime

from estimator.session import ACCELEROMETER, GYROSCOPE, ROTATION_ALIGNMENT, TWO_AXIS_STAND
from service.demo.blocks import DemoEffect, ParameterMove
from service.flags.records import FlagState, Matter

START = datetime(2023, 11, 14, 8, 30, tzinfo=UTC)
"""Three years before the end."""
END = datetime(2026, 11, 12, 8, 30, tzinfo=UTC)
"""Fixed, so that the demonstration is always the same."""
YEARS = 3.0
"""Years from start to end."""


@dataclass(frozen=True)
class DemoDrift:
    """A change that grows to its full amount over the three years."""

    change: ParameterMove
    power: float = 1.0
    """1 grows steadily, 3 slowly at first and fast at the end."""
    ends: float = YEARS
    """Years after the start at which it stops growing, because the sensor was replaced."""


@dataclass(frozen=True)
class Jump:
    """A change that came at once, and that nobody recorded."""

    change: ParameterMove
    at: float
    """Years after the start."""


@dataclass(frozen=True)
class Intervention:
    """A service on the unit, with its effects."""

    at: datetime
    kind: str
    note: str
    changes: tuple[ParameterMove, ...]
    who: str = ""
    sensor: str = ""
    measured: bool = False
    """Whether the unit was measured shortly before and shortly after, as found and as left."""


@dataclass(frozen=True)
class DemoHandling:
    """Handling of a flag on a sensor."""

    at: datetime
    sensor: str
    state: FlagState
    who: str
    why: str
    matter: Matter = Matter.TOLERANCE


@dataclass(frozen=True)
class Remark:
    """A note on the unit's history."""

    at: datetime
    text: str
    who: str


@dataclass(frozen=True)
class DemoMember:
    """One unit of the fleet."""

    serial: str
    kind: str
    story: str
    sessions: int = 13
    joined: float = 0.0
    """Years after the start at which it was first measured."""
    left: float = YEARS
    """Years after the start at which it was last measured."""
    drifts: tuple[DemoDrift, ...] = ()
    jumps: tuple[Jump, ...] = ()
    services: tuple[Intervention, ...] = ()
    handled: tuple[DemoHandling, ...] = ()
    remarks: tuple[Remark, ...] = ()
    noise: dict[int, float] = field(default_factory=dict)
    """Factor on the reading noise of single sessions, by their number from 0; −1 is the last."""
    hidden: DemoEffect | None = None
    """Effect hidden in the latest session."""
    programme: str = TWO_AXIS_STAND
    """Programme of measurement; on a turntable a drift's sensor is the axis of the accelerometers."""
    flown: ParameterMove | None = None
    """Move shown by a recording in service that is made after the last session."""

    @property
    def files(self) -> int:
        """Number of the unit's files."""
        return self.sessions + (self.flown is not None)


def _replaced(sensor: int, at: datetime) -> Intervention:
    new = (
        ParameterMove(sensor, "scale", 310.0),
        ParameterMove(sensor, "bias", -420.0),
        ParameterMove(sensor, "axis", 140.0),
    )
    return Intervention(at, "sensor-swap", "Replaced, block aligned again.", new, "M. Okafor", f"A{sensor + 1}")


GAINS = {0: 72.0, 3: -58.0}
"""Sensors of BA-109 whose amplifiers drift, and how far until they are adjusted, ppm."""
ADJUSTED = datetime(2025, 2, 11, 9, 0, tzinfo=UTC)
"""Time at which the unit that shows a service was adjusted."""
UNTIL_ADJUSTED = (ADJUSTED - START).days / 365.25
"""Years after the start."""


def _adjusted() -> Intervention:
    back = tuple(ParameterMove(sensor, "scale", -gain) for sensor, gain in GAINS.items())
    note = "Amplifiers of A1 and A4 adjusted to nominal gain."
    return Intervention(ADJUSTED, "adjustment", note, back, "R. Duarte", measured=True)


ECCENTRIC_STAND, ECCENTRICITY = "ODG-2", (3.6e-6, -2.0e-6)
"""Stand whose angle scale sits off centre, and the eccentricity along cos β and sin β, rad. It is below an arcsecond,
and too small for any single session to show.
"""
WAVY_STAND, WAVE = "ODG-1", 4.4e-6
"""Stand whose head is turned by sin 3β, and the amplitude, rad, as three feet of a table would: no cause of the
catalogue.
"""
CUBIC = 4.4e-8
"""(m/s²)⁻² of every accelerometer: a property of their design, 4.2 µg/g³."""

CAST = (
    DemoMember(
        "BA-101", ACCELEROMETER, "stable; the head's angle scale was off centre in the last session", 14,
        hidden=DemoEffect("beta-eccentricity", (60e-6, 25e-6)),
    ),
    DemoMember(
        "BA-102", ACCELEROMETER, "bias of A5 jumped one day; the axis of A3 crept during the last session", 12,
        jumps=(Jump(ParameterMove(4, "bias", 24.0), 1.5),),
        handled=(
            DemoHandling(
                datetime(2026, 11, 13, 10, 0, tzinfo=UTC), "A5", FlagState.RESOLVED, "R. Duarte",
                "A5 was dropped with its box in May 2025; its bias has held since.", Matter.JUMP,
            ),
        ),
        hidden=DemoEffect("axis-creep", (5e-8, 3e-8), sensor=2),
    ),
    DemoMember(
        "BA-103", ACCELEROMETER, "bias of A3 drifts, still within tolerance", 9,
        drifts=(DemoDrift(ParameterMove(2, "bias", 34.0)),),
        remarks=(Remark(datetime(2025, 5, 6, 12, 0, tzinfo=UTC), "Moved to the other hangar by road.", "K. Ito"),),
    ),
    DemoMember(
        "BA-104", ACCELEROMETER, "scale factor of A5 drifts up to its tolerance", 14,
        drifts=(DemoDrift(ParameterMove(4, "scale", 104.0)),),
    ),
    DemoMember(
        "BA-105", ACCELEROMETER, "axis of A2 creeps just over its tolerance", 9,
        drifts=(DemoDrift(ParameterMove(1, "axis", 23.0), power=1.5),),
    ),
    DemoMember(
        "BA-106", ACCELEROMETER, "A6 fails: bias and scale factor run away", 12,
        drifts=(
            DemoDrift(ParameterMove(5, "bias", 170.0), power=4.0),
            DemoDrift(ParameterMove(5, "scale", -150.0), power=4.0),
        ),
        handled=(
            DemoHandling(
                datetime(2026, 11, 13, 9, 0, tzinfo=UTC), "A6", FlagState.ACKNOWLEDGED, "K. Ito",
                "Taken out of service; a replacement of A6 is ordered.",
            ),
        ),
    ),
    DemoMember(
        "BA-107", ACCELEROMETER, "A4 wore out and was replaced; a new reference since", 15,
        drifts=(DemoDrift(ParameterMove(3, "bias", 150.0), power=1.5, ends=1.6),),
        services=(_replaced(3, datetime(2025, 6, 20, 9, 0, tzinfo=UTC)),),
        handled=(
            DemoHandling(
                datetime(2025, 12, 1, 9, 0, tzinfo=UTC), "A4", FlagState.RESOLVED, "M. Okafor",
                "A4 was worn and is replaced; the sessions since agree.",
            ),
        ),
    ),
    DemoMember("BA-108", ACCELEROMETER, "stable; the last session was too noisy to decide", 12, noise={-1: 60.0}),
    DemoMember(
        "BA-109", ACCELEROMETER, "amplifiers of A1 and A4 drifted and were adjusted; measured as found and as left", 9,
        drifts=tuple(
            DemoDrift(ParameterMove(sensor, "scale", gain * YEARS / UNTIL_ADJUSTED), ends=UNTIL_ADJUSTED)
            for sensor, gain in GAINS.items()
        ),
        services=(_adjusted(),),
    ),
    DemoMember(
        "BA-110", ACCELEROMETER, "joined the fleet last year; A4 sticks since the last session", 6, joined=1.7,
        hidden=DemoEffect("hysteresis", (3.5e-4,), sensor=3),
    ),
    DemoMember("BG-201", GYROSCOPE, "stable, but not measured for longer than it may be", 12, left=1.8),
    DemoMember(
        "BG-202", GYROSCOPE, "bias of G2 drifts towards its tolerance", 10,
        drifts=(DemoDrift(ParameterMove(1, "bias", 0.024)),),
    ),
    DemoMember(
        "BA-111", ACCELEROMETER, "new, stable on the stand; its last flight shows that A2 moved since", 5, joined=2.1,
        flown=ParameterMove(1, "bias", 120.0),
    ),
    DemoMember(
        "RT-301", GYROSCOPE, "aligned on a turntable before use; the bias of x drifts up to its tolerance", 9,
        drifts=(DemoDrift(ParameterMove(0, "bias", 48.5)),), programme=ROTATION_ALIGNMENT,
    ),
)  # fmt: skip
