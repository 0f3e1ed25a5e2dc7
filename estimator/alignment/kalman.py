"""The discrete Kalman filter: prediction, and correction in Joseph's form, which keeps P symmetric and positive."""

from dataclasses import dataclass

import numpy as np

from estimator.session import Array


@dataclass(frozen=True, eq=False)
class KalmanState:
    """What a filter knows of n states, each in its own unit."""

    x: Array
    """(n,) estimate."""
    P: Array
    """(n, n) its covariance."""


@dataclass(frozen=True, eq=False)
class Innovation:
    """What a measurement of k components, each in its own unit, said beyond what was expected."""

    value: Array
    """(k,) ν."""
    covariance: Array
    """(k, k) S, that ν should have."""

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
