"""Channels at the end of their range: told by readings that are the same to the last digit, and put right.

A clipped sensor reads exactly its limit in every row whose input lies beyond it. So readings that are all one and the
same extreme are suspected: the sensor's other rows alone say, by a linear fit, what it should have read there. Where
that is beyond the limit by more than chance, the sensor is clipped. Far beyond it no small effect about the fitted
baseline describes that any more, since the clipped rows have spoiled the fit: so they take no part in it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import fdtrc

from estimator.applied_vector import stand_geometry
from estimator.causes.contract import Cause
from estimator.session import TWO_AXIS_STAND, Array, CalibrationSession

FEWEST = 2
"""Rows at one extreme; a single one is as well a reading that does not belong to the rest."""

SPARE = 3
"""Degrees of freedom that the sensor's other rows must leave: fewer hardly tell their own scatter."""

LEVEL = 1e-6
"""p-value below which a sensor is clipped, shared among sensors and sides: its readings are left out, which must not
happen by chance once in the life of a fleet."""

SEEN = 1e-6
"""Share of the strongest direction above which the other rows see one: rounding lies far below."""

SHORT = 3.0
"""Standard errors by which a clipped row may be expected short of the limit: noise alone does so at the margin."""

EXACT = 1e-9
"""Least scatter of the readings relative to their range: simulated readings may have none."""

FREE = 1e3
"""Standard error given to a clipped reading, in ranges of the sensor's readings: it takes no part any more."""


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
    """In standard errors."""

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
    """The sensors clipped in a session on a stand, and the session put right."""
    cause = next((c for c in catalogue if c.clips), None)
    if session.programme != TWO_AXIS_STAND or cause is None:
        return [], session
    clips = [clip for i in range(len(session.sensors)) for clip in clips_of(session, i, cause)]
    for clip in clips:
        session = clip.put_right(session)
    return clips, session


def clips_of(session: CalibrationSession, i: int, cause: Cause) -> list[Clip]:
    """The sides on which sensor i is clipped."""
    u = session.readings[:, i]
    ends = {side: np.flatnonzero(u == side * (side * u).max()) for side in (1.0, -1.0)}
    tied = {side: rows for side, rows in ends.items() if FEWEST <= len(rows) < len(u)}
    if not tied:
        return []
    left_out = np.concatenate(list(tied.values()))
    expected, covariance, freedom = predicted(session, i, left_out)
    if freedom < SPARE:
        return []
    clips, start = [], 0
    for side, rows in tied.items():
        own = slice(start, start := start + len(rows))
        strength, p_value = significance(side * (expected[own] - u[rows]), covariance[own, own], freedom)
        if p_value < LEVEL / (2 * len(session.sensors)):
            clips.append(Clip(cause, i, side, tuple(map(int, rows)), expected[own], p_value, strength))
    return clips


def predicted(session: CalibrationSession, i: int, left_out: Array) -> tuple[Array, Array, int]:
    """Readings (k,) that sensor i should have in rows ``left_out`` (k,) by its others, reading units; with their
    covariance (k, k) and the degrees of freedom.

    u = c₀ + c·n + c₂·a², a along the nominal axis, fitted by least squares; no freedom where the others leave it open.
    """
    n = stand_geometry(session).n[:, i]
    size = float(np.linalg.norm(n[0]))
    along = n @ session.sensors[i].nominal_axis
    terms = np.column_stack([np.ones(len(n)), n / size, (along / size) ** 2])
    kept = np.setdiff1d(np.arange(len(n)), left_out)
    _, values, turn = np.linalg.svd(terms[kept], full_matrices=False)
    seen = turn[values > SEEN * values[0]]
    freedom = len(kept) - len(seen)
    if freedom < SPARE or np.abs(terms[left_out] - terms[left_out] @ seen.T @ seen).max() > SEEN:
        return np.zeros(len(left_out)), np.zeros((len(left_out),) * 2), 0
    basis = terms @ seen.T
    coefficients, *_ = np.linalg.lstsq(basis[kept], session.readings[kept, i], rcond=None)
    rest = session.readings[kept, i] - basis[kept] @ coefficients
    variance = float(rest @ rest) / freedom + (EXACT * np.ptp(session.readings[:, i])) ** 2
    lean = basis[left_out] @ np.linalg.inv(basis[kept].T @ basis[kept]) @ basis[left_out].T
    return basis[left_out] @ coefficients, variance * (np.eye(len(left_out)) + lean), freedom


def significance(beyond: Array, covariance: Array, freedom: int) -> tuple[float, float]:
    """Strength, standard errors, and p-value of readings ``beyond`` (k,) a limit, reading units, with their covariance
    (k, k); p = 1 where one of them stays short of it."""
    if np.any(beyond < -SHORT * np.sqrt(np.diagonal(covariance))) or beyond.sum() <= 0:
        return 0.0, 1.0
    square = float(beyond @ np.linalg.solve(covariance, beyond))
    return float(np.sqrt(square)), float(fdtrc(len(beyond), freedom, square / len(beyond)))
