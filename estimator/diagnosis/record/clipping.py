"""Channels at the end of their range: recognised by readings that are the same to the last digit, and corrected.

A clipped sensor reads exactly its limit in every row whose input lies beyond it. So readings that are all one and the
same extreme are suspected, and of a raw log rows in which a good part of the samples is: everything else in the session
says what the sensor should have read there. Where that is beyond the limit by more than chance, the sensor is clipped.
Far beyond it no small effect about the fitted baseline describes that any more, since the clipped rows have spoiled
the fit: so they take no part in it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby, pairwise

import numpy as np

from estimator.calibration.calibrate import averaged
from estimator.causes.contract import Cause
from estimator.content import remembered
from estimator.diagnosis.record.expected import (
    Expected,
    explained,
    in_orientations,
    on_stand,
    who_may_misfit,
)
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import FREE, baseline_of
from estimator.session import ACCELEROMETER, TWO_AXIS_STAND, Array, CalibrationSession

FEWEST = 2
"""Rows at one extreme; a single one is as well a reading that does not belong to the rest."""

CUT = 0.05
"""Part of a row's samples at the end of the channel's range from which its mean is spoiled: it is then short by 2 % of
the noise of a sample, which a rest of a thousand samples hardly shows."""

LEVEL = 1e-6
"""p-value below which a sensor is clipped, shared among sensors and sides: its readings are left out, which must not
happen by chance once in the life of a fleet."""

UPPER, LOWER = 1.0, -1.0
"""Sides of the range."""


@dataclass(frozen=True, eq=False)
class Suspect:
    """Rows in which one sensor may stand at one end of its range."""

    sensor: int
    side: float
    rows: Array
    """(k,) numbers of the rows."""


@dataclass(frozen=True, eq=False)
class Clip:
    """One sensor clipped on one side."""

    cause: Cause
    sensor: int
    side: float
    """+1 or −1."""
    rows: tuple[int, ...]
    expected: Array
    """(k,) readings to expect in those rows, reading units."""
    p_value: float
    strength: float
    """Strength in standard errors."""

    def put_right(self, session: CalibrationSession) -> CalibrationSession:
        """The session with the clipped readings replaced by what the other rows predict, and left without weight.

        Where the file states no noise, they cannot be left without weight.
        """
        readings, errors = session.readings.copy(), session.standard_errors.copy()
        at = np.array(self.rows), self.sensor
        known = np.isfinite(errors[at])
        errors[at] = np.where(known, FREE * np.ptp(readings[:, self.sensor]), errors[at])
        readings[at] = self.expected
        return replace(session, readings=readings, standard_errors=errors)


def unclipped(session: CalibrationSession, catalogue: Sequence[Cause]) -> tuple[list[Clip], CalibrationSession]:
    """The sensors clipped in an averaged session, and the corrected session."""
    cause = next((c for c in catalogue if c.clips), None)
    if cause is None:
        return [], session
    clips = clips_among(session, list(suspected(session)), cause)
    if not clips and session.programme != TWO_AXIS_STAND:
        clips = clipped_once(session, cause)
    for clip in clips:
        session = clip.put_right(session)
    return clips, session


def clips_among(session: CalibrationSession, suspects: Sequence[Suspect], cause: Cause) -> list[Clip]:
    """The suspects that are clipped; no suspect takes part in predicting the readings of the others."""
    clips = []
    for suspect, expected in zip(suspects, expectations(session, suspects), strict=True):
        if expected is None or (len(suspect.rows) < FEWEST and not expected.believed):
            continue
        strength, p_value = expected.significance(session.readings[suspect.rows, suspect.sensor], suspect.side)
        if p_value < LEVEL / (2 * len(session.sensors)):
            rows = tuple(map(int, suspect.rows))
            clips.append(Clip(cause, suspect.sensor, suspect.side, rows, expected.value, p_value, strength))
    return clips


def clipped_once(session: CalibrationSession, cause: Cause) -> list[Clip]:
    """The sensor that is clipped in a single row, or in one on each side, where the readings do not fit together with
    it and do without: so much beyond its limit a row spoils the orientations that the linear search starts from."""
    if explained(session):
        return []
    ends = [(UPPER, np.argmax), (LOWER, np.argmin)]
    alone = who_may_misfit(session)
    channels = [[Suspect(i, side, np.array([last(session.readings[:, i])])) for side, last in ends] for i in alone]
    by_channel = [clips_among(session, suspects, cause) for suspects in channels]
    return max(by_channel, key=lambda clips: sum(clip.strength**2 for clip in clips), default=[])


def suspected(session: CalibrationSession) -> Iterator[Suspect]:
    """Both sides of every sensor that has several rows at one end of its range. Gyros at rest in unknown orientations
    are left out: nothing predicts their readings.
    """
    for i, sensor in enumerate(session.sensors):
        if session.programme != TWO_AXIS_STAND and sensor.kind != ACCELEROMETER:
            continue
        sides = [(side, np.flatnonzero(at_end(session, i, k, side))) for k, side in enumerate((UPPER, LOWER))]
        if any(len(rows) >= FEWEST for _, rows in sides):
            yield from (Suspect(i, side, rows) for side, rows in sides if 0 < len(rows) < len(session.readings))


def at_end(session: CalibrationSession, i: int, k: int, side: float) -> Array:
    """(R,) bool: rows of sensor i that stand at its k-th end, on a side."""
    if session.at_ends is not None:
        return np.asarray(session.at_ends[:, i, k] >= CUT)
    u = side * session.readings[:, i]
    return np.asarray(u == u.max())


def expectations(session: CalibrationSession, suspects: Sequence[Suspect]) -> list[Expected | None]:
    """The expected readings in the rows of every suspect, in order; none of these rows takes part."""
    if session.programme != TWO_AXIS_STAND:
        return in_orientations(session, [(s.sensor, s.rows) for s in suspects]) if suspects else []
    results: list[Expected | None] = []
    for i, of_sensor in groupby(suspects, key=lambda s: s.sensor):
        sides = list(of_sensor)
        together = on_stand(session, (i, np.concatenate([s.rows for s in sides])))
        ends = np.cumsum([0, *(len(s.rows) for s in sides)])
        results += [None if together is None else together.of(slice(a, b)) for a, b in pairwise(ends)]
    return results


@remembered
def earlier_baseline(session: CalibrationSession, catalogue: tuple[Cause, ...]) -> Baseline:
    """The baseline of an earlier session, without its clipped readings.

    Raises
    ------
    ScheduleError : the session cannot be calibrated at all.
    """
    return baseline_of(unclipped(averaged(session), catalogue)[1])
