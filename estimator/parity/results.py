"""Results of a parity check; no algorithms. The JSON form is ``imu-parity/1``."""

import math
from dataclasses import dataclass

from estimator.codec import Document
from estimator.json_object import Json
from estimator.session import Array

BIAS, SCALE, AXIS, SEVERAL = "bias", "scale", "axis", "several"
KINDS = (BIAS, SCALE, AXIS, SEVERAL)
"""``several``: bias, scale and axis of one sensor together."""
STEP, RAMP, STUCK, ZERO, FULL_SCALE, GAIN = "step", "ramp", "stuck", "zero", "full-scale", "gain"
NOISE, DELAY, EXCHANGED, INTERMITTENT = "noise", "delay", "exchanged", "intermittent"
COURSE_KINDS = (STEP, RAMP, STUCK, ZERO, FULL_SCALE, GAIN, NOISE, DELAY, EXCHANGED, INTERMITTENT)
"""Kinds of failure of a sensor in service."""


@dataclass(frozen=True)
class Candidate:
    """One sensor that alone could have caused what was found."""

    sensor: str
    kind: str
    amplitude: tuple[float, ...]
    """bias m/s² (rad/s); scale relative; axis two turns, rad; several: bias, scale, axis."""
    sigma: tuple[float, ...]
    ratio: float
    """Generalised likelihood ratio: the fall of χ²."""
    p_value: float
    """p-value of the ratio, for this hypothesis alone."""


@dataclass(frozen=True)
class CourseFault:
    """A sensor that fails within the recording, or all through it."""

    sensor: str | None
    """Name of the sensor; None where parity cannot say which of the ``suspects``: then there are two at least."""
    suspects: tuple[str, ...]
    """Sensors that explain it about equally well, the likeliest first; the ``sensor`` alone where one is named."""
    kind: str
    """One of `COURSE_KINDS`."""
    since: float
    """s since the start, or rows where no rate is known; 0 where it lasts from the first."""
    until: float | None
    """End of the fault, as ``since``; None where it lasts to the end."""
    since_sigma: float
    """One sigma of ``since``, its unit."""
    size: float | None
    """Size of the sensor's change: step, zero, full scale, intermittent m/s² (rad/s); ramp m/s² (rad/s) per second;
    gain relative; noise m/s² (rad/s), one sigma of a sample; delay s. None where it is not known.
    """
    sigma: float | None
    """One sigma of ``size``, its unit."""
    p_value: float
    """Chance of so much in a sound recording, over everything that was looked at."""


@dataclass(frozen=True)
class Sight:
    """Visibility of one parameter of one sensor in the recording, if that alone has changed.

    Where another sensor was isolated, its change is taken out first. All None where nothing can be seen.
    """

    change: tuple[float, ...] | None
    """Estimate: bias m/s² (rad/s), scale relative; axis two turns along the reference's tangents, rad."""
    covariance: tuple[tuple[float, ...], ...] | None
    detectable: float | None
    """Size that is detected with 95 % power at the stated level."""
    isolable: float | None
    """Size that is also attributed to this sensor with 95 % power; None where another's change looks the same."""

    @property
    def size(self) -> float | None:
        """Signed for one number, the length of two."""
        if self.change is None:
            return None
        return self.change[0] if len(self.change) == 1 else math.hypot(*self.change)

    @property
    def sigma(self) -> float | None:
        """One sigma; root of the trace for an axis."""
        return None if self.covariance is None else math.sqrt(sum(row[k] for k, row in enumerate(self.covariance)))


NOTHING = Sight(None, None, None, None)
"""Sight of a parameter that a recording does not show."""


@dataclass(frozen=True)
class SensorParity:
    """One sensor, seen through parity."""

    name: str
    visible_share: float
    """Part of any change of this sensor, in energy, that parity shows: 1 − eᵢᵀ(HᵀH)⁻¹eᵢ; the rest looks like motion."""
    bias: Sight
    scale: Sight
    axis: Sight


def _before_motion(document: Json) -> Json:
    """Completes documents from before motion was allowed for, in which it was taken to have no effect."""
    unmoved = {"chi2_unmoved": document["chi2"], "p_value_unmoved": document["p_value"]}
    return {"clipped": {}, "moving": False, "suspects": [], "motion_share": 0.0, **unmoved} | document


@dataclass(frozen=True, eq=False)
class ParityResult(
    Document,
    format="imu-parity/1",
    earlier=_before_motion,
    optional=("before", "after", "course_fine", "course_fine_time", "course_fine_sigma"),
):
    """A recording of a redundant block beside its reference calibration.

    Where a sensor begins to fail within it (``faults``), all but the faults and the fine course is of the part before.
    """

    unit: str
    kind: str
    sensors: tuple[SensorParity, ...]
    chi2: float
    dof: int
    p_value: float
    """p-value of χ² under no change."""
    detected: bool
    false_alarm: float
    """Chance that an unchanged block is called changed."""
    candidates: tuple[Candidate, ...]
    """Changes of single sensors that explain the finding about equally well, best first; none without a detection."""
    isolated: str | None
    """The sensor, when all candidates name the same one and it explains the finding."""
    explained: bool
    """Whether the best candidate leaves nothing but noise."""
    complete: bool
    """Whether the recording turns enough to tell bias from scale and axis."""
    constant: Array
    """(d,) change of bias in parity space, m/s² (rad/s)."""
    slope: Array
    """(d, 3) change per unit of the applied vector in parity space, dimensionless."""
    covariance: Array
    """(4 d, 4 d) covariance of (constant, g·slope columns), (m/s²)² ((rad/s)²); only what is ``excited`` is known."""
    excited: Array
    """(4, s) directions of (1, n/g) that the recording excites, dimensionless."""
    unobservable: int
    """Dimensions of the sensors' 4 m changes that no recording shows: those of a common bias and any linear map."""
    residual_rms: float
    """Root mean square of the parity vector's elements after the fit, block means, m/s² (rad/s)."""
    blocks: int
    """Number of blocks of the recording; ``used`` of them, in ``groups`` independent stretches."""
    used: int
    groups: int
    left_out: dict[str, int]
    """Blocks not used, by reason."""
    saturated: tuple[str, ...]
    """Channels that ran into the end of their range."""
    clipped: dict[str, float]
    """Share of the samples in which each of them stood there, by name."""
    moving: bool
    """Too much motion to tell: something would be called changed if nothing moved, and lever arms, delays between
    channels or vibration could explain it."""
    chi2_unmoved: float
    """χ² if motion did nothing to sound sensors, and ``p_value_unmoved`` of it."""
    p_value_unmoved: float
    suspects: tuple[Candidate, ...]
    """The candidates if motion did not affect sound sensors; empty unless ``moving``."""
    motion_share: float
    """Share of the observed variance that motion accounts for, 0 to 1."""
    block_seconds: float | None
    duration: float | None
    """s"""
    course: Array
    """(groups, m) mean over every group of each sensor's trace in parity, V·Vᵀa, m/s² (rad/s)."""
    course_sigma: Array
    """(m,) scatter of the groups about the fit."""
    course_time: Array
    """(groups,) middle of each group, s since the start; blocks where no rate is known."""
    faults: tuple[CourseFault, ...] = ()
    """Sensors that fail within the recording or all through it, the earliest first."""
    before: "ParityResult | None" = None
    """The part before the first fault, and ``after`` the part after it, without a sensor that says nothing any more;
    None without a fault, and where the part is too short."""
    after: "ParityResult | None" = None
    course_fine: Array | None = None
    """(n, m) course of V·Vᵀa over the whole recording, m/s² (rad/s)."""
    course_fine_time: Array | None = None
    """(n,) middle of each, s since the start; rows where no rate is known."""
    course_fine_sigma: Array | None = None
    """(m,) one sigma of a point of it while the sensors are sound, m/s² (rad/s)."""

    def sensor(self, name: str) -> SensorParity:
        """The sensor called ``name``; KeyError if there is none."""
        for sensor in self.sensors:
            if sensor.name == name:
                return sensor
        raise KeyError(name)
