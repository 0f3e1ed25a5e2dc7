"""Observability of an alignment before it is flown: rank of its Gramian, expected sigmas, and what remains unseen.

Covariance analysis runs the filter without readings: its sigmas depend on the path and the noise alone. The Gramian
O = Σ (H·Φ_k)ᵀR⁻¹(H·Φ_k), Φ_k from the start to step k, leaves out prior and gyro noise; it is counted in units of the
sigmas that are of use, so that a direction with an eigenvalue above 1 could be told at best.

The mounting errors and turns about the vertical
-------------------------------------------------
Measured by velocity alone, E_xz and E_yz are not told, whatever the number of positions and the sense of the turns.
An attitude error that turns with the block, φ = C·(−E_yz, E_xz, 0), has over any turn the rate −C·(E_xz, E_yz, 0)·ω_z
that the mounting errors make, and with ∇ = g·(E_xz, E_yz) its tilt leaves no velocity: f × φ + C∇ = 0. In words: gyros
that are turned as a whole against the accelerometers look like accelerometers with a bias. Only φ_U gives it away, at
the rate Ω·cos L·φ_E, 5e-5 of the error a second, which takes hours to rise above the noise of a good gyro, and which a
small turn of the azimuth gyro's own axis imitates. What velocity tells is ∇ − g·E and the attitude that goes with it;
the ten-state filter takes E for zero, and that is the whole error of equation (5).

The turntable's own direction breaks this: its axis does not move, so what the computed attitude says of it at two stops
shows E at once, and ∇ with it.
"""

from dataclasses import dataclass

import numpy as np

from estimator.alignment.filtering import (
    PRIOR,
    REST_SIGMA,
    USEFUL,
    FilterSetting,
    Measured,
    drawn_anew,
    relative,
    run,
    table_measurement,
    velocity_measurement,
)
from estimator.alignment.simulate import Truth, TurntableProgramme, table_angle, true_attitude, true_motion
from estimator.alignment.sins import ALL, NABLA, PHI, STATES, STOP, InertialModel, Path, dynamics, transition
from estimator.alignment.strapdown import strapdown
from estimator.session import Array

REPORTED = slice(2, 13)
"""φ, ε, ∇, E, κ among the states."""


@dataclass(frozen=True, eq=False)
class Expected:
    """Expected result of a programme. n states reported, at most 11."""

    names: tuple[str, ...]
    sigmas: Array
    """(n,) one sigma at the end, SI."""
    prior: Array
    """(n,) one sigma before, SI."""
    observable: tuple[bool, ...]
    rank: int
    """Number of directions, of n, that are told well enough to be of use."""

    def sigma(self, name: str) -> float:
        """One sigma of a state at the end, SI."""
        return float(self.sigmas[self.names.index(name)])


def planned_path(programme: TurntableProgramme, latitude: float, g: float, heading: float = 0.0) -> Path:
    """The path of a level table run by a programme; g in m/s², angles in rad."""
    stops = np.zeros((len(programme.angles), 2))
    attitude = true_attitude(programme, Truth(heading=heading), stops)
    motion = true_motion(attitude, programme.row, latitude, g)
    _, course = table_angle(programme)
    stop_of_row = np.where(course[1:] % 1 == 0, course[1:], -1).astype(int)
    per_step = max(round(1.0 / programme.row), 1)
    return strapdown(attitude[0], motion, latitude, stop_of_row, per_step).path


def expected(path: Path, setting: FilterSetting, model: InertialModel) -> Expected:
    """Covariance analysis: the filter's sigmas do not depend on what is read."""
    nothing = Measured(np.zeros((len(path.mean), 2)), np.zeros((len(path.mean), 3)))
    last = run(path, setting, nothing, model).last
    names = STATES[: model.size][REPORTED]
    told = relative(last.P)[REPORTED, REPORTED]
    return Expected(
        names=names,
        sigmas=np.sqrt(np.diag(last.P))[REPORTED],
        prior=PRIOR[: model.size][REPORTED],
        observable=tuple(bool(seen) for seen in np.diag(told) < 1),
        rank=int(np.sum(np.linalg.eigvalsh(told) < 1)),
    )


def gramian(path: Path, setting: FilterSetting, model: InertialModel) -> Array:
    """(n, n) observability Gramian of the states but ς at the start, dimensionless, in units of `USEFUL`; no prior and
    no gyro noise.

    Every step's velocity counts with the scatter that white accelerometer noise gives it.
    """
    size = min(model.size, STOP.start)
    F = dynamics(path, setting.latitude, setting.gravity)
    Phi, _ = drawn_anew(path, transition(F, path.step), np.zeros_like(F), setting)
    H, R = velocity_measurement(ALL, setting)
    R = R + path.step * setting.noise.accelerometer[:2, :2]
    H_table, _ = table_measurement()
    R_table = np.diag([setting.wobble, setting.wobble, setting.table]) ** 2 + REST_SIGMA**2 * np.eye(3)
    shown = (path.begins | path.ends) & (model is InertialModel.TURNTABLE)
    so_far, total = np.eye(ALL), np.zeros((ALL, ALL))
    for k in range(len(Phi)):
        so_far = Phi[k] @ so_far
        total += (H @ so_far).T @ np.linalg.solve(R, H @ so_far)
        if shown[k]:
            total += (H_table @ so_far).T @ np.linalg.solve(R_table, H_table @ so_far)
    return total[:size, :size] * np.outer(USEFUL[:size], USEFUL[:size])


def hidden(attitude: Array, E_xz: float, E_yz: float, g: float) -> Array:
    """The state (13,), SI, at attitude C (3, 3) that velocity does not see while the block turns about the vertical.

    Parameters
    ----------
    attitude : C, block → n, Z upright.
    E_xz, E_yz : rad.
    g : m/s².
    """
    state = np.zeros(13)
    state[PHI] = attitude @ np.array([-E_yz, E_xz, 0.0])
    state[NABLA] = g * np.array([E_xz, E_yz])
    state[10:12] = E_xz, E_yz
    return state


def mounting_effect(E_xz: float, E_yz: float, g: float) -> dict[str, float]:
    """Errors of the estimates after a half turn about the vertical by unmodelled mounting errors, equation (5).

    Parameters
    ----------
    E_xz, E_yz : rad.
    g : m/s².

    Returns
    -------
    Estimate minus truth: ``phi_E``, ``phi_N`` rad along the block's x and y before the turn, ``nabla_x``, ``nabla_y``
    m/s². East and north where the block starts with its x axis to the east, as in the paper.
    """
    return {"phi_E": -E_yz, "phi_N": E_xz, "nabla_x": -E_xz * g, "nabla_y": -E_yz * g}
