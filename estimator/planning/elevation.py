"""The elevation of the head: the paper's formula, and the conditioning of what the sensors are solved from.

Source: analytic alignment paper, (6), and its measure ρ = |λ_max|/|λ_min| (Faddeev). The paper takes ρ of the matrices
of (18) and (20), which depends on the unit of length and whose first one is singular; here it is that of each sensor's
own information about (ln K, b/g, c·g, two turns of the axis), which depends on neither. With equal steps and N ≥ 5 it
does not depend on N.
"""

from dataclasses import replace

import numpy as np

from estimator.applied_vector import stand_geometry
from estimator.forward import jacobian
from estimator.parameters import nominal
from estimator.session import CalibrationSession, StandErrors

ROUNDING = 1e-14
"""Ratio of eigenvalues below which the smaller one is zero: rounding of doubles."""


def optimal_elevation(sigma: StandErrors, positions: int) -> float:
    """(6): α_opt in rad for stand errors of one sigma and N positions a run; 45° for a perfect stand.

    It minimises the stand's share of scale and axis errors summed over an orthogonal triad. The paper's weight of
    D_θy belongs to an estimator that does not join the two runs; `plan` asks the Jacobians instead.
    """
    lifted, across = sigma.theta_x**2 + sigma.alpha**2, sigma.theta_y**2
    above, below = lifted + sigma.beta**2 / positions, 2 * lifted + across
    return float(np.arctan((above / below) ** 0.25)) if below > 0 else np.pi / 4


def gyro_errors(sigma: StandErrors, latitude: float) -> StandErrors:
    """(31): the stand's errors, one sigma, as they act on gyros, so that the accelerometers' formulas hold for χ.

    The latitude's error (rad) adds to δα as a raise of the head; θ_y is replaced by the gyros' tilt across the head,
    which levelling and meridian share by the components of the Earth's rate at ``latitude`` (rad).
    """
    across = np.hypot(sigma.theta_y * np.sin(latitude), sigma.meridian * np.cos(latitude))
    return replace(sigma, alpha=float(np.hypot(sigma.alpha, sigma.latitude)), theta_y=float(across))


def conditioning(schedule: CalibrationSession) -> float:
    """ρ of the worst conditioned sensor: largest over smallest eigenvalue of its information, stand perfect.

    Infinite where the schedule leaves a direction without a trace.
    """
    geometry = stand_geometry(schedule)
    relative = jacobian(nominal(schedule.sensors), geometry.n, geometry.norm) / geometry.norm[:, None]
    values = np.linalg.eigvalsh(np.einsum("rmi,rmj->mij", relative, relative))
    ratio = values[:, 0] / values[:, -1]
    return float(1 / ratio.min()) if ratio.min() > ROUNDING else float("inf")
