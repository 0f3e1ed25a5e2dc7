"""A sensor whose range is too small, hidden in a session.

The limit is lowered until what it cuts off is as strong as asked. Readings at a limit are one and the same to the last
digit, as a converter gives them, and there are two of them at least at every end, since one alone is as well a reading
that does not belong to the rest. So on a schedule whose largest inputs lie far apart the weakest clipping is strong.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from estimator.causes.contract import Cause
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.forward import measured
from estimator.hiding.hidden import HiddenCause, TooWeakError, UnhideableError, amplitude_reaching
from estimator.session import Array, CalibrationSession
from estimator.simulate import counts_pulses

DEEPEST = 0.3
"""Share of the largest reading that clipping takes at most: a range so much too small is seen by eye."""
FEWEST_CUT = 2
"""Readings that stand at an end at least: one alone is as well a reading that does not belong to the rest."""


@dataclass(frozen=True, eq=False)
class Range:
    """The range of one sensor, of which one end or both come too soon."""

    seen: WhitenedResiduals
    sensor: int
    side: float
    """+1 or −1: the end that does; 0 both."""

    @cached_property
    def input(self) -> Array:
        """(R,) readings of the sensor, m/s² (rad/s) at the input, its bias included."""
        baseline = self.seen.baseline
        reading = measured(baseline.session)[0][:, self.sensor] / baseline.parameters.scale[self.sensor]
        return np.asarray(reading)

    @cached_property
    def sign(self) -> Array:
        """(R,) the end that each reading is nearer to, dimensionless."""
        return np.sign(self.input) if self.side == 0 else np.full_like(self.input, self.side)

    @cached_property
    def size(self) -> Array:
        """(R,) readings counted towards the end of the range, m/s² (rad/s)."""
        return self.sign * self.input

    @property
    def deepest(self) -> float:
        """Depth below the largest reading that a limit may have at most, m/s² (rad/s)."""
        return float(DEEPEST * self.size.max())

    @cached_property
    def highest(self) -> float:
        """The highest limit that `FEWEST_CUT` readings reach at every end, m/s² (rad/s), not by their noise alone."""
        fitted = self.input - self.seen.baseline.residual[:, self.sensor]
        sides = (self.side,) if self.side else (1.0, -1.0)
        return min(float(np.sort(np.minimum(end * self.input, end * fitted))[-FEWEST_CUT]) for end in sides)

    @cached_property
    def least(self) -> float:
        """Standard errors that a limit takes off there."""
        return self.reached(float(self.size.max()) - self.highest)

    def reached(self, depth: float) -> float:
        """Standard errors that a limit takes off which lies so far below the largest reading, m/s² (rad/s)."""
        return self.strength(-self.sign * np.maximum(self.size - (self.size.max() - depth), 0.0))

    def strength(self, change: Array) -> float:
        """Standard errors of a change (R,) of the readings, m/s² (rad/s) at the input."""
        columns = np.zeros((*self.seen.baseline.residual.shape, 1))
        columns[:, self.sensor, 0] = change
        return float(np.linalg.norm(self.seen.trace(columns)))

    def ended(self, depth: float, cause: Cause) -> tuple[CalibrationSession, HiddenCause]:
        """The session with the limit so far below the largest reading, m/s² (rad/s), at a whole pulse; and the clipping
        that is hidden in it."""
        baseline, i = self.seen.baseline, self.sensor
        session, limit = baseline.session, min(float(self.size.max()) - depth, self.highest)
        pulses = bool(counts_pulses(session)[i])
        unit = float(baseline.parameters.scale[i]) * ((session.count_time or 1.0) if pulses else 1.0)
        end = float(np.round(unit * limit)) if pulses else unit * limit
        clipped = self.sign * end + (session.sensors[i].nominal_offset or 0.0)
        limited = np.where(self.size >= limit, clipped, session.readings[:, i])
        strength = self.strength((limited - session.readings[:, i]) / unit)
        readings = session.readings.copy()
        readings[:, i] = limited
        hidden = HiddenCause(cause.identifier, (i,), (), (end / unit,), (end / unit, self.side), strength)
        return replace(session, readings=readings), hidden


def clipped(
    session: CalibrationSession,
    cause: Cause,
    rng: np.random.Generator,
    *,
    strength: float,
    sensor: int | None,
    exact: bool,
) -> tuple[CalibrationSession, HiddenCause]:
    """The session with a sensor that reads no more than a limit, on both sides or on one.

    Where none can be clipped as weakly, the first that is drawn is clipped as weakly as it can be, unless the strength
    is to be ``exact``.
    """
    seen = WhitenedResiduals.of(baseline_of(session))
    sensors = rng.permutation(session.readings.shape[1]) if sensor is None else [sensor]
    ranges = [Range(seen, int(i), float(side)) for i in sensors for side in rng.permutation((0.0, 1.0, -1.0))]
    able = [candidate for candidate in ranges if candidate.reached(candidate.deepest) >= max(strength, candidate.least)]
    if not able:
        raise UnhideableError(
            f"{cause.identifier} would not reach {strength:g} standard errors with {DEEPEST:.0%} cut off"
        )
    weak = [candidate for candidate in able if candidate.least <= strength]
    if not weak and exact:
        raise too_strong(cause, min(candidate.least for candidate in able))
    chosen = (weak or able)[0]
    depth = amplitude_reaching(chosen.reached, max(strength, chosen.least), chosen.deepest, cause)
    return chosen.ended(depth, cause)


def too_strong(cause: Cause, least: float) -> TooWeakError:
    """The error that nothing as weak can be hidden, with the reason."""
    return TooWeakError(
        f"{cause.identifier} is {least:.4g} standard errors or more here: at its limit a sensor reads the same in "
        "two positions at least, and the largest inputs lie that far apart",
        least,
    )
