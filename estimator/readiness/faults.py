"""Faults of a record that leave no judgement possible, or only a weaker one."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from estimator.applied_vector import STANDARD_GRAVITY
from estimator.codec import Document
from estimator.readiness.series import Series, at_input, series_of, times_of
from estimator.session import ACCELEROMETER, Array, CalibrationSession

FEWEST = 12
"""Means from which a course with three unknowns and a noise of its own is fitted: three for each."""
RESTING = (0.5, 1.5)
"""g that a resting block can show, whatever its biases; what lies outside is a matter of units."""
TURNING = np.radians(30.0)
"""rad/s above which a gyro does not rest: beyond the zero of any gyro that is calibrated."""
CODES = 3
"""Different values up to which a channel's noise does not carry the mean from code to code."""
GAP = 5.0
"""Times the usual time between rows from which there is a gap, if it is longer than a mean as well."""


class FaultKind(StrEnum):
    """Kind of fault of a record."""

    NO_TIME = "no-time"
    CLOCK_BACK = "clock-back"
    CLOCK_STANDS = "clock-stands"
    NOT_FINITE = "not-finite"
    FEW = "few-rows"
    POSITIONS = "positions"
    STUCK = "stuck"
    COARSE = "coarse"
    UNITS = "units"
    TURNING = "turning"
    NOT_JUDGED = "not-judged"
    GAP = "gap"
    ALONE = "alone"


HARMLESS = frozenset({FaultKind.GAP, FaultKind.ALONE})
"""Faults that are reported, but leave the record to be judged."""


@dataclass(frozen=True)
class RecordFault(Document, order=("kind", "sensors", "amount", "blocks")):
    """One thing wrong with a record."""

    kind: FaultKind
    sensors: tuple[str, ...] = ()
    amount: float = 0.0
    """Rows, a row's number, s, g or rad/s, as the kind has it."""

    @property
    def blocks(self) -> bool:
        """Whether no judgement is possible."""
        return self.kind not in HARMLESS


def clock_faults(session: CalibrationSession) -> tuple[RecordFault, ...]:
    """Faults in the times of the rows."""
    time = times_of(session)
    if not np.isfinite(session.readings).all():
        return (RecordFault(FaultKind.NOT_FINITE, amount=1 + float(np.argwhere(~np.isfinite(session.readings))[0, 0])),)
    if len(session.readings) < FEWEST:
        return (RecordFault(FaultKind.FEW, amount=len(session.readings)),)
    if time is None:
        return (RecordFault(FaultKind.NO_TIME),)
    steps = np.diff(time)
    if (steps < 0).any():
        return (RecordFault(FaultKind.CLOCK_BACK, amount=float(np.argmax(steps < 0)) + 2),)
    if np.median(steps) <= 0:
        return (RecordFault(FaultKind.CLOCK_STANDS),)
    return ()


def content_faults(session: CalibrationSession, series: Series, allowed: Array) -> tuple[RecordFault, ...]:
    """Faults in readings that a block at rest cannot have; ``allowed`` (m,) drift, m/s² or rad/s."""
    names = tuple(sensor.name for sensor in session.sensors)
    codes = [np.unique(channel) for channel in at_input(session).T]
    stuck = tuple(name for name, levels in zip(names, codes, strict=True) if len(levels) == 1)
    coarse = tuple(
        name
        for name, levels, most in zip(names, codes, allowed, strict=True)
        if 1 < len(levels) <= CODES and np.diff(levels).max() > most
    )
    faults = [
        RecordFault(kind, levels) for kind, levels in ((FaultKind.STUCK, stuck), (FaultKind.COARSE, coarse)) if levels
    ]
    if not np.isfinite(allowed).any():
        faults.append(RecordFault(FaultKind.NOT_JUDGED))
    faults += _rest_faults(session, series)
    informed = len(series.time) - len(np.unique(series.place))
    if informed < FEWEST - 1:
        kind = FaultKind.POSITIONS if len(np.unique(series.place)) > 1 else FaultKind.FEW
        faults.append(
            RecordFault(kind, amount=len(np.unique(series.place)) if kind is FaultKind.POSITIONS else len(series.time))
        )
    return (*faults, *_notes(session, series))


def _rest_faults(session: CalibrationSession, series: Series) -> list[RecordFault]:
    felt = np.array([sensor.kind == ACCELEROMETER for sensor in session.sensors])
    faults = []
    if felt.any():
        force = np.abs(force_of(session, series))
        magnitude = float(np.linalg.norm(force) if np.ndim(force) == 1 and len(force) == 3 else force.max())
        least = RESTING[0] if is_spatial(session) else 0.0
        if not least <= magnitude / STANDARD_GRAVITY <= RESTING[1]:
            faults.append(RecordFault(FaultKind.UNITS, _named(session, felt), magnitude / STANDARD_GRAVITY))
    rates = np.abs(np.median(series.value[:, ~felt], axis=0))
    if (rates > TURNING).any():
        faults.append(RecordFault(FaultKind.TURNING, _named(session, ~felt), float(rates.max())))
    return faults


def _notes(session: CalibrationSession, series: Series) -> list[RecordFault]:
    faults = [RecordFault(FaultKind.ALONE, (session.sensors[0].name,))] if len(session.sensors) == 1 else []
    pauses = series.edges[1:, 0] - series.edges[:-1, 1]
    usual = np.median(np.diff(series.time))
    if len(pauses) and pauses.max() > GAP * usual:
        faults.append(RecordFault(FaultKind.GAP, amount=float(pauses.max())))
    return faults


def _named(session: CalibrationSession, chosen: Array) -> tuple[str, ...]:
    return tuple(sensor.name for sensor, is_chosen in zip(session.sensors, chosen, strict=True) if is_chosen)


def is_spatial(session: CalibrationSession) -> bool:
    """Whether the accelerometers span all three directions."""
    axes = [sensor.nominal_axis for sensor in session.sensors if sensor.kind == ACCELEROMETER]
    return len(axes) >= 3 and int(np.linalg.matrix_rank(np.array(axes), tol=0.05)) == 3


def force_of(session: CalibrationSession, series: Series) -> Array:
    """(3,) specific force of the last position, m/s², block axes; (k,) of the k accelerometers where it is not felt
    in all directions."""
    felt = [i for i, sensor in enumerate(session.sensors) if sensor.kind == ACCELEROMETER]
    value = np.median(series.value[series.place == series.place[-1]][:, felt], axis=0)
    if not is_spatial(session):
        return np.asarray(value)
    axes = np.stack([session.sensors[i].nominal_axis for i in felt])
    return np.asarray(np.linalg.lstsq(axes, value, rcond=None)[0])


def readable(session: CalibrationSession) -> tuple[Series | None, tuple[RecordFault, ...]]:
    """The means of a record, or why there are none."""
    faults = clock_faults(session)
    time = times_of(session)
    return (None, faults) if faults or time is None else (series_of(session, time), ())
