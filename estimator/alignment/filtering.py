"""The alignment filter run over a path: prior, measurements, and what the session adds to the prior."""

from dataclasses import dataclass, field

import numpy as np

from estimator.alignment.noise import TINY, FilterNoise
from estimator.alignment.sins import (
    ALL,
    LEVER,
    PHI,
    STOP,
    TAU,
    InertialModel,
    Path,
    V,
    dynamics,
    process_noise,
    transition,
)
from estimator.results import ARCSEC
from estimator.session import Array


@dataclass(frozen=True, eq=False)
class KalmanState:
    """Estimate of n states with its covariance, each state in its own unit."""

    x: Array
    """(n,) estimate."""
    P: Array
    """(n, n) covariance of the estimate."""


@dataclass(frozen=True, eq=False)
class Innovation:
    """Innovation of a measurement of k components, each in its own unit."""

    value: Array
    """(k,) ν."""
    covariance: Array
    """(k, k) S, the expected covariance of ν."""

    @property
    def chi2(self) -> float:
        """νᵀS⁻¹ν."""
        return float(self.value @ np.linalg.solve(self.covariance, self.value))


def predict(state: KalmanState, Phi: Array, Q: Array) -> KalmanState:
    """One step ahead: x = Φx, P = ΦPΦᵀ + Q; Phi and Q (n, n), each row and column per the unit of its state."""
    return KalmanState(Phi @ state.x, Phi @ state.P @ Phi.T + Q)


def correct(state: KalmanState, z: Array, H: Array, R: Array) -> tuple[KalmanState, Innovation]:
    """A measurement z = Hx + noise of covariance R: the corrected state and the innovation.

    z : (k,), of any units, per which H (k, n) and R (k, k) are.
    """
    S = H @ state.P @ H.T + R
    K = np.linalg.solve(S, H @ state.P).T
    innovation = Innovation(z - H @ state.x, S)
    rest = np.eye(len(state.x)) - K @ H
    P = rest @ state.P @ rest.T + K @ R @ K.T
    return KalmanState(state.x + K @ innovation.value, 0.5 * (P + P.T)), innovation


DEGREE = np.pi / 180
"""rad."""
PRIOR = np.array(
    [TINY] * 2 + [0.2 * DEGREE] * 2 + [10 * DEGREE] + [10 * DEGREE / 3600] * 3 + [0.1] * 2
    + [0.2 * DEGREE] * 2 + [1e-2] + [10 * DEGREE] * 3 + [0.0] * 3 + [0.0] * 4
)  # fmt: skip
"""(23,) one sigma of every state before the session, SI: wide of what coarse alignment leaves. The deviation of a stop
is drawn when the stop begins; the lever arms' covariance is in the setting."""
USEFUL = np.array(
    [1e-2] * 2 + [60 * ARCSEC] * 2 + [1 * DEGREE] + [1 * DEGREE / 3600] * 3 + [3e-3] * 2
    + [60 * ARCSEC] * 2 + [1e-3] + [60 * ARCSEC] * 3
)  # fmt: skip
"""(16,) sigma of every state, SI, from which a session counts as not telling it: 60″, 1°, 1 °/h, 0.3 mg, 60″, 0.1 %.
What is known no better is of no use for a health check of such sensors."""
TABLE_SIGMA = 1.0 * ARCSEC
"""rad, where the session states none: wobble of the turn axis and error of the table's angle from stop to stop. What
good turntables reach; E between stops is known no better than that (docs/methods/alignment.md)."""
REST_SIGMA = 0.1 * ARCSEC
"""rad by which a table that stands still may sway about each axis: below what is asked of E, and not zero, so that the
end of a stop does not repeat its beginning exactly."""


@dataclass(frozen=True, eq=False)
class FilterSetting:
    """Settings of the filter, apart from the path."""

    latitude: float
    gravity: float
    noise: FilterNoise
    wobble: float
    """One sigma of the turn axis' direction from stop to stop, per axis, rad."""
    table: float
    """One sigma of the table's angle at a stop, rad."""
    levers: Array = field(default_factory=lambda: np.zeros((4, 4)))
    """(4, 4) covariance of the lever arms' coefficients before the session, m²; zero where they are known."""


@dataclass(frozen=True, eq=False)
class Measured:
    """The measurements of every step. K steps."""

    velocity: Array
    """(K, 2) m/s."""
    turned: Array
    """(K, 3) φ since the first stop as the turntable shows it, rad; looked at where a stop begins or ends."""


@dataclass(frozen=True, eq=False)
class Filtered:
    """The filter's estimates. K steps, n states."""

    estimates: Array
    """(K, n) SI."""
    sigmas: Array
    """(K, n) SI, one sigma."""
    innovations: Array
    """(K, 2) innovations of the velocity, m/s."""
    innovation_sigmas: Array
    """(K, 2) m/s."""
    last: KalmanState
    chi2: float
    """Sum over all innovations."""
    measured: int
    """Number of measured components."""


def run(path: Path, setting: FilterSetting, measured: Measured, model: InertialModel) -> Filtered:
    """The filter from the first step to the last."""
    n = model.size
    F = dynamics(path, setting.latitude, setting.gravity)
    Phi = transition(F, path.step)
    Q = process_noise(path, Phi, setting.noise.accelerometer, setting.noise.gyro)
    Phi, Q = drawn_anew(path, Phi, Q, setting)
    Phi, Q = Phi[:, :n, :n], Q[:, :n, :n]
    H, R = velocity_measurement(n, setting)
    H_table, R_table = table_measurement()
    shown = path.begins | path.ends
    state = KalmanState(np.zeros(n), prior(model, setting))
    compared = path.rate_known | (model is not InertialModel.TURNTABLE) | (not setting.levers.any())
    estimates, sigmas = np.empty((2, len(Phi), n))
    innovations, innovation_sigmas = np.empty((2, len(Phi), 2))
    chi2, count = 0.0, 0
    for k in range(len(Phi)):
        ahead = predict(state, Phi[k], Q[k])
        corrected, innovation = correct(ahead, measured.velocity[k], H, R)
        innovations[k], innovation_sigmas[k] = innovation.value, np.sqrt(np.diag(innovation.covariance))
        state = corrected if compared[k] else ahead
        if compared[k]:
            chi2, count = chi2 + innovation.chi2, count + 2
        if model is InertialModel.TURNTABLE and shown[k]:
            state, innovation = correct(state, measured.turned[k], H_table, R_table)
            chi2, count = chi2 + innovation.chi2, count + 3
        estimates[k], sigmas[k] = state.x, np.sqrt(np.diag(state.P))
    return Filtered(estimates, sigmas, innovations, innovation_sigmas, state, chi2, count)


def prior(model: InertialModel, setting: FilterSetting) -> Array:
    """(n, n) covariance of a model's states before the session, SI."""
    P = np.diag(PRIOR**2)
    P[LEVER, LEVER] = setting.levers
    return P[: model.size, : model.size]


def velocity_measurement(n: int, setting: FilterSetting) -> tuple[Array, Array]:
    """H (2, n), dimensionless, and R (2, 2), (m/s)², of the computed horizontal velocity."""
    H = np.zeros((2, n))
    H[:, V] = np.eye(2)
    return H, max(setting.noise.velocity, TINY) ** 2 * np.eye(2)


def table_measurement() -> tuple[Array, Array]:
    """H (3, 23), dimensionless, and R (3, 3), rad², of the turntable's direction at a stop, y = φ + τ + ς."""
    H = np.zeros((3, ALL))
    H[:, PHI], H[:, TAU], H[:, STOP] = np.eye(3), np.eye(3), np.eye(3)
    return H, REST_SIGMA**2 * np.eye(3)


def drawn_anew(path: Path, Phi: Array, Q: Array, setting: FilterSetting) -> tuple[Array, Array]:
    """Φ and Q (K, 23, 23), SI, under which ς (rad) is drawn anew where a stop begins."""
    Phi, Q = Phi.copy(), Q.copy()
    Phi[path.begins, STOP, STOP] = 0.0
    Q[path.begins, STOP, STOP] = np.diag([setting.wobble, setting.wobble, setting.table]) ** 2
    return Phi, Q


def relative(P: Array) -> Array:
    """A covariance (n, n), SI, over what is of use, dimensionless: a state is observable below 1. ς is left out."""
    useful = USEFUL[: len(P)]
    return P[: len(useful), : len(useful)] / np.outer(useful, useful)
