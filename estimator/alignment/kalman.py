"""The discrete Kalman filter: prediction, and correction in Joseph's form, which keeps P symmetric and positive."""

from dataclasses import dataclass

import numpy as np

from estimator.session import Array


@dataclass(frozen=True, eq=False)
class KalmanState:
    """An estimate (n,) and its covariance (n, n)."""

    x: Array
    P: Array


@dataclass(frozen=True, eq=False)
class Innovation:
    """What a measurement said beyond what was expected, (k,), and the covariance that this should have, (k, k)."""

    value: Array
    covariance: Array

    @property
    def chi2(self) -> float:
        """νᵀS⁻¹ν."""
        return float(self.value @ np.linalg.solve(self.covariance, self.value))


def predict(state: KalmanState, Phi: Array, Q: Array) -> KalmanState:
    """One step ahead: x = Φx, P = ΦPΦᵀ + Q."""
    return KalmanState(Phi @ state.x, Phi @ state.P @ Phi.T + Q)


def correct(state: KalmanState, z: Array, H: Array, R: Array) -> tuple[KalmanState, Innovation]:
    """A measurement z = Hx + noise of covariance R: the corrected state and the innovation."""
    S = H @ state.P @ H.T + R
    K = np.linalg.solve(S, H @ state.P).T
    innovation = Innovation(z - H @ state.x, S)
    rest = np.eye(len(state.x)) - K @ H
    P = rest @ state.P @ rest.T + K @ R @ K.T
    return KalmanState(state.x + K @ innovation.value, 0.5 * (P + P.T)), innovation
