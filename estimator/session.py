"""The measured session: what a calibration was done with and what was read. Units and frames: see the package page."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from estimator.codec import Document

Array = NDArray[Any]
"""Array of any number type; shapes and units stand where an array is declared."""

ACCELEROMETER, GYROSCOPE = "accelerometer", "gyroscope"
"""Kinds of sensor, and of block, as session files name them."""

TWO_AXIS_STAND = "two-axis-stand"
ARBITRARY_ORIENTATIONS = "arbitrary-orientations"
ROTATION_ALIGNMENT = "rotation-alignment"
RATE_TABLE = "rate-table"
IN_SERVICE = "in-service"
THERMAL = "thermal"
CALIBRATIONS = (TWO_AXIS_STAND, ARBITRARY_ORIENTATIONS)
"""Programmes that calibrate every sensor of a block."""
CORRECTED = (*CALIBRATIONS, THERMAL)
"""Programmes whose result firmware can correct readings by."""
DIAGNOSED = (*CALIBRATIONS, ROTATION_ALIGNMENT)
"""Programmes in which causes are looked for: in alignments lever arms alone."""
PROGRAMMES = (TWO_AXIS_STAND, ARBITRARY_ORIENTATIONS, ROTATION_ALIGNMENT, RATE_TABLE, IN_SERVICE, THERMAL)
"""All, as session files name them."""
AS_FOUND, AS_LEFT = "as-found", "as-left"
STAGES = (AS_FOUND, AS_LEFT)
"""Stages of a session: before and after a unit was worked on."""
MEASURED, SIMULATED = "measured", "simulated"
ORIGINS = (MEASURED, SIMULATED)
"""Origins of the readings."""
FREE_RUNNING, RESET = "free-running", "reset"
COUNTERS = (FREE_RUNNING, RESET)
"""Ways of counting pulses: the difference of two readings of a counter that runs on, or from zero every time."""
QUANTISATION = {FREE_RUNNING: 1 / 6, RESET: 1 / 12}
"""Variance of one count, pulses²: a reading is rounded, which is uniform (1/12); a difference holds two of them."""


CORRECTED_SAMPLES, LEFT_OUT, NOTED = "corrected", "left-out", "noted"
"""Actions on a thing that the screening of a raw file found."""


@dataclass(frozen=True)
class ScreenFinding:
    """One thing that the screening of a raw file found (`estimator.screening`)."""

    kind: str
    """One of `estimator.screening.KINDS`."""
    sensors: tuple[str, ...]
    """Names of the sensors; empty where it is the clock's."""
    rows: int
    """Number of rows that it touches."""
    first_row: int | None
    """First row, counted from 1; None where it concerns the whole file."""
    last_row: int | None
    action: str
    """``corrected``, ``left-out`` or ``noted``."""
    message: str
    """The finding in a sentence, for people."""


def comparable(programme: str) -> tuple[str, ...]:
    """Programmes whose results are of the same parameters, so that one is judged against the other."""
    return CALIBRATIONS if programme in CALIBRATIONS else (programme,)


@dataclass(frozen=True, eq=False)
class Sensor:
    """One accelerometer or gyro as its maker describes it."""

    name: str
    kind: str
    nominal_axis: Array
    """(3,) unit vector, block axes."""
    nominal_scale: float
    """Reading unit per m/s² or rad/s; for a pulse gyro (session.count_time set) pulses per rad."""
    reading_unit: str
    bias_repeatability: float = 0.0
    """One sigma of the bias from position to position, m/s² or rad/s."""
    nominal_offset: float | None = None
    """Reading that stands for zero, reading units; taken off before the model, so the bias is counted from it.
    None when not stated: then the bias holds the whole offset."""
    position: Array | None = None
    """(3,) where it sits, m, block axes, from any one origin; None when not stated."""


@dataclass(frozen=True)
class Site:
    """Place where the session was measured."""

    latitude: float | None = None
    """Geodetic latitude, rad."""
    height: float = 0.0
    """Height above the ellipsoid, m."""
    gravity: float | None = None
    """Measured gravity, m/s²; used instead of the formula when stated."""


@dataclass(frozen=True)
class StandErrors:
    """One-sigma errors of a stand, rad (count_time: s). All but beta are constant over a session."""

    theta_x: float = 0.0
    theta_y: float = 0.0
    alpha: float = 0.0
    beta: float = 0.0
    """Drawn anew at every row."""
    latitude: float = 0.0
    meridian: float = 0.0
    count_time: float = 0.0
    wobble: float | None = None
    """Direction of a turntable's axis, drawn anew at every stop, per axis; None when not stated."""


@dataclass(frozen=True)
class Stand:
    """A two-axis stand and how it was set."""

    id: str
    alpha: float | None = None
    """Elevation of the head's axis above the horizon, rad."""
    chi: float | None = None
    """Elevation of the head's axis above the plane orthogonal to the Earth's axis, rad (gyros)."""
    sigma: StandErrors = field(default_factory=StandErrors)


@dataclass(frozen=True)
class SetAside(Document):
    """A grossly wrong reading of a session, or a stretch of them, that takes no part in any fit."""

    sensor: str
    row: int
    """Row, counted from 1, in the order measured."""
    last_row: int
    """Last row of a stretch; otherwise the same row."""
    reading: float
    """Reading as the file states it, reading units."""
    expected: float
    """Reading expected from everything else in the session, reading units; in the first row of a stretch. NaN where it
    cannot be predicted.
    """
    size: float
    """Reading less expected, at the input: m/s² (rad/s)."""
    sigma: float
    """One sigma of the size, m/s² (rad/s)."""
    slip: str
    """Likely kind of slip: ``zero``, ``sign``, ``decimal-point``, ``neighbour-column``, ``row-before``, ``unplugged``,
    ``stuck`` or ``unknown``.
    """
    suspects: tuple[str, ...] = ()
    """Sensors that may be wrong, ``sensor`` among them, where the row cannot tell which is; the whole row then takes no
    part.
    """

    @property
    def strength(self) -> float:
        """Size in standard errors."""
        return abs(self.size) / self.sigma


@dataclass(frozen=True, eq=False)
class RawRests:
    """A raw log of N samples and where in it the rests lie whose means the R rows of an averaged session are."""

    readings: Array
    """(N, m) as in `CalibrationSession`."""
    time: Array | None
    """(N,) s since the start."""
    rate: float
    """Hz"""
    start: NDArray[np.intp]
    """(R,) first sample of each rest."""
    stop: NDArray[np.intp]
    """(R,) one past its last."""


@dataclass(frozen=True, eq=False)
class CalibrationSession:
    """One calibration session of one block of one unit. R rows in the order measured, m sensors.

    Made by `estimator.read_session` or `estimator.simulate`; what it holds has been checked.
    """

    unit: str
    block: str
    programme: str
    sensors: tuple[Sensor, ...]
    readings: Array
    """(R, m), reading units; pulse counts for a pulse gyro; one sample a row for a raw log."""
    standard_errors: Array
    """(R, m), one sigma of the averaged reading, reading units; NaN where the file states none."""
    site: Site = field(default_factory=Site)
    stand: Stand | None = None
    mounting: Array = field(default_factory=lambda: np.eye(3))
    """(3, 3) rotation, platform → block."""
    flipped: NDArray[np.bool_] | None = None
    """(R,) True in the flipped run; two-axis stand only."""
    flip_turn: Array = field(default_factory=lambda: np.zeros(3))
    """(3,) rotation vector, rad, block axes: how the block sits turned in the flipped run against the direct one; in no
    file, found by a diagnosis."""
    beta: Array | None = None
    """(R,) rad; two-axis stand only."""
    time: Array | None = None
    """(R,) s since the start."""
    temperature: Array | None = None
    """(R,) °C."""
    vibration: Array | None = None
    """(R, m) variance of the input within the row, (m/s²)² or (rad/s)²."""
    tilt_error: Array | None = None
    """(R,) rad, standard error of the block's mean tilt, each of the two components across gravity; all sensors share
    it, and ``standard_errors`` are without it. None where none is stated."""
    turn_angle: Array | None = None
    """(R,) rad, of a turntable about the block's Z axis at the end of the row, right-handed."""
    turn_rate: Array | None = None
    """(R,) rad/s, of a rate table about the block's Z axis during the row."""
    position: NDArray[np.int64] | None = None
    """(R,) label of the position that a raw sample belongs to; −1 where it belongs to none."""
    directions: Array | None = None
    """(R, 3) unit vectors, block axes: roughly known direction of the specific force; NaN rows where unknown."""
    direction_sigma: float | None = None
    """One sigma of ``directions`` per axis, rad; None when no directions are stated."""
    sample_rate: float | None = None
    """Hz; set for a raw log only."""
    at_ends: Array | None = None
    """(R, m, 2) share, dimensionless, of a row's samples that read the log's very largest and smallest value of their
    channel; None unless the rows were averaged from a raw log."""
    rests: RawRests | None = None
    """The samples that the rows are means of, with those between; in no file. None unless the rows were averaged from
    a raw log that is held as a whole."""
    count_time: float | None = None
    """s; set when gyro readings are pulse counts over that time."""
    counter: str | None = None
    """``free-running`` or ``reset``; None when not stated: the free-running one's larger error is then taken."""
    counts_averaged: Array | None = None
    """(R,) consecutive counts in the mean of a row; None where every row is one count."""
    unit_type: str | None = None
    started_at: str | None = None
    """ISO 8601, with the offset from UTC of the place; None when the file does not say."""
    switched_on: float | None = None
    """s, by the clock of ``time``: when the unit was switched on; None when the file does not say. Where no time is
    recorded the clock begins with the first row."""
    operator: str = ""
    notes: str = ""
    stage: str | None = None
    """``as-found`` or ``as-left``: before or after the unit was worked on; None when the file does not say."""
    origin: str | None = None
    """``simulated``; None when measured, which is what a file without the field says."""
    screening: tuple[ScreenFinding, ...] = ()
    """Findings in the raw rows before they were averaged; samples left out are NaN in ``readings``."""
    unscreened: tuple[str, ...] = ()
    """Kinds that the file declines to be screened for."""
    set_aside: tuple[SetAside, ...] = ()
    """Gross readings; in ``readings`` stands what was expected in their place, without weight; in no file."""

    @property
    def is_raw(self) -> bool:
        """Whether the rows are samples rather than averaged positions."""
        return self.sample_rate is not None

    @property
    def is_simulated(self) -> bool:
        """Whether no hardware was measured."""
        return self.origin == SIMULATED

    @property
    def time_since_power_on(self) -> float | None:
        """s, from switching on to the first row; None when the file does not say."""
        if self.switched_on is None:
            return None
        return (0.0 if self.time is None else float(self.time[0])) - self.switched_on

    @property
    def subjects(self) -> tuple[str, str | None, str]:
        """Serial, type and stand that a lasting effect in the session may belong to; an empty name where there is no
        stand.
        """
        return self.unit, self.unit_type, self.stand.id if self.stand else ""

    @property
    def quantisation(self) -> float | Array:
        """Variance of a row's pulse count, pulses²; a number, or (R, 1) where rows are means of counts.

        Errors of a free-running counter cancel from count to count, so a mean of n in a row has but 1/(6 n²). Those of
        a counter that is reset may all be alike, as at a steady rate without noise: a mean of them is no better than
        one.
        """
        variance = QUANTISATION[self.counter or FREE_RUNNING]
        if self.counts_averaged is None or self.counter == RESET:
            return variance
        return np.asarray(variance / self.counts_averaged[:, None] ** 2)
