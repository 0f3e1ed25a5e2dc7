"""Expected readings of a sensor in some rows, by all data but those readings.

On a stand the applied vectors are known, so a sensor's other rows say it by a linear fit. In arbitrary orientations
the whole session is fitted without those readings: the other sensors and the sensor's other rows say it together.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.applied_vector import gravity, stand_geometry
from estimator.calibration.free import accelerometer_rows, agreed, solve
from estimator.calibration.free.excess import UNLIKELY
from estimator.calibration.free.model import linearise
from estimator.calibration.free.model import predicted as readings_of
from estimator.calibration.free.solve import Solution
from estimator.least_squares import least_squares
from estimator.session import ACCELEROMETER, Array, CalibrationSession
from estimator.significance import p_value

SPARE = 3
"""Degrees of freedom that the other readings must leave: fewer hardly tell their own scatter."""

SEEN = 1e-6
"""Share of the strongest direction above which the other rows see one: rounding lies far below."""

EXACT = 1e-9
"""Least scatter of the readings relative to their range: simulated readings may have none."""

UNWEIGHTED = 1e3
"""Standard error of a reading that takes no part, relative to g: as if it were not there, and still finite."""

SHORT = 3.0
"""Standard errors by which a clipped row may be expected short of the limit: noise alone does so at the margin."""

Cells = tuple[int, Array]
"""A sensor, and rows (k,) of it."""


HALVED = 12
"""Accelerometers, of whom each half (two triads) can be tested alone."""


@dataclass(frozen=True, eq=False)
class Expected:
    """The expected readings of a sensor in k rows."""

    value: Array
    """(k,) reading units."""
    covariance: Array
    """(k, k) covariance of the readings to be seen there, reading units squared."""
    freedom: float
    """Degrees of freedom that the covariance is known with; infinite where the stated noise is believed."""

    @property
    def believed(self) -> bool:
        """Whether the stated noise explains all readings that take part."""
        return bool(np.isinf(self.freedom))

    def of(self, rows: slice) -> "Expected":
        """The expected readings in some of the rows."""
        return Expected(self.value[rows], self.covariance[rows, rows], self.freedom)

    def significance(self, read: Array, side: float) -> tuple[float, float]:
        """Strength, standard errors, and p-value of being expected beyond what was read (k,), reading units, on a side.

        p = 1 where a row is expected plainly short of it.
        """
        beyond = side * (self.value - read)
        if np.any(beyond < -SHORT * np.sqrt(np.diagonal(self.covariance))) or beyond.sum() <= 0:
            return 0.0, 1.0
        square, k = float(beyond @ np.linalg.solve(self.covariance, beyond)), len(beyond)
        return float(np.sqrt(square)), float(p_value(square, k, self.freedom))


def on_stand(session: CalibrationSession, cells: Cells) -> Expected | None:
    """The expected readings by the sensor's other rows; None where they leave them open.

    u = c₀ + c·n + c₂·a², a along the nominal axis, fitted by least squares.
    """
    i, omitted = cells
    n = stand_geometry(session).n[:, i]
    size = float(np.linalg.norm(n[0]))
    along = n @ session.sensors[i].nominal_axis
    terms = np.column_stack([np.ones(len(n)), n / size, (along / size) ** 2])
    remaining = np.setdiff1d(np.arange(len(n)), omitted)
    _, values, turn = np.linalg.svd(terms[remaining], full_matrices=False)
    seen = turn[values > SEEN * values[0]]
    freedom = len(remaining) - len(seen)
    if freedom < SPARE or np.abs(terms[omitted] - terms[omitted] @ seen.T @ seen).max() > SEEN:
        return None
    basis = terms @ seen.T
    fit = least_squares(basis[remaining], session.readings[remaining, i])
    variance = float(fit.chi2) / freedom + (EXACT * np.ptp(session.readings[:, i])) ** 2
    lean = basis[omitted] @ fit.covariance @ basis[omitted].T
    return Expected(basis[omitted] @ fit.value, variance * (np.eye(len(omitted)) + lean), freedom)


def explained(session: CalibrationSession) -> bool:
    """Whether accelerometers in orientations fit together within their stated noise, or state none to judge by."""
    felt = np.array([s.kind == ACCELEROMETER for s in session.sensors])
    return not felt.any() or fits(session, felt)


def who_may_misfit(session: CalibrationSession) -> list[int]:
    """Accelerometers one of which alone may be what does not fit: those of halves, and of these of triads, without
    which the others fit together. Readings that do not fit without all of a group do not without one of it.

    A half is every second triad. Sensors one by one would not do: every second one of a board of triads may lie in a
    plane.
    """
    felt = np.array([s.kind == ACCELEROMETER for s in session.sensors])
    if felt.sum() < HALVED:
        return np.flatnonzero(felt).tolist()
    triad, found = (np.cumsum(felt) - 1) // 3, list[int]()
    for half in (felt & (triad % 2 == k) for k in range(2)):
        groups = [half & (triad == k) for k in np.unique(triad[half])] if fits(session, felt & ~half) else []
        found += [i for group in groups if fits(session, felt & ~group) for i in np.flatnonzero(group).tolist()]
    return found


def fits(session: CalibrationSession, felt: Array) -> bool:
    """Whether some accelerometers (m,) bool fit together within their stated noise, or state none to judge by."""
    prepared, stated = accelerometer_rows(session, felt, gravity(session.site))
    if not stated or np.linalg.matrix_rank(prepared.nominal_axes, tol=SEEN) < 3:
        return True
    return agreed(prepared, lambda solution: bool(p_value(solution.chi2, solution.dof) >= UNLIKELY))


def in_orientations(session: CalibrationSession, cells: Sequence[Cells]) -> list[Expected | None]:
    """The expected readings of accelerometers, one for each of ``cells``, by a fit without these; None where it leaves
    them open.

    With F the information of parameters and orientations together, h the derivative of one reading by both and σ its
    noise, the covariance of two predictions is h'F⁻¹h, and σ² on its diagonal. Where the stated noise does not explain
    the other readings, it is enlarged to what they show.
    """
    felt = np.array([s.kind == ACCELEROMETER for s in session.sensors])
    g, place = gravity(session.site), np.cumsum(felt) - 1
    prepared, stated = accelerometer_rows(session, felt, g)
    sigma = prepared.sigma.copy()
    for i, rows in cells:
        sigma[rows, place[i]] = UNWEIGHTED
    solution = solve(prepared.weighted(sigma), True, None)
    spare = solution.dof
    believed = stated and spare > 0 and p_value(solution.chi2, spare) >= UNLIKELY
    if not solution.converged or (spare < SPARE and not believed):
        return [None] * len(cells)
    growth = 1.0 if believed else solution.chi2 / spare
    expected: list[Expected | None] = []
    for i, rows in cells:
        sigma_of_cells = prepared.sigma[rows, place[i]]
        covariance = _covariance(solution, int(place[i]), rows)
        if covariance is None:
            expected.append(None)
            continue
        unit, offset = g * session.sensors[i].nominal_scale, session.sensors[i].nominal_offset or 0.0
        value = readings_of(solution.unknowns)[rows, place[i]] * unit + offset
        full = growth * (covariance + np.diag(sigma_of_cells**2)) + EXACT**2 * np.eye(len(rows))
        expected.append(Expected(value, full * unit**2, np.inf if believed else spare))
    return expected


def _covariance(solution: Solution, i: int, rows: Array) -> Array | None:
    """(k, k) covariance of the predictions of sensor i in ``rows`` (k,), relative to g; None where the fit leaves one
    open.
    """
    linear, known = linearise(solution.rows, solution.unknowns), solution.knowledge
    sigma = solution.rows.sigma[rows, i]
    local, shared = linear.local[rows, i] * sigma[:, None], linear.shared[rows, i] * sigma[:, None]
    through = np.einsum("ka,kab->kb", shared, linear.inverse[rows])
    h = -np.einsum("kb,kpb->kp", through, linear.coupling[rows])
    h[:, 5 * i : 5 * i + 5] += local
    if np.abs(h @ known.unseen).max(initial=0.0) > SEEN:
        return None
    return np.asarray(h @ known.covariance @ h.T + np.diag(np.einsum("kb,kb->k", through, shared)))
