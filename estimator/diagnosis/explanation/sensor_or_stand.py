"""Stand or sensor? Where a finding's signature lives: in the range of the axes, or in parity space.

An error of the applied vector moves all sensors as some vector would: it lies in the range of H (m×3, the axes) and
leaves nothing in parity space. A fault of one sensor cannot hide there: it leaves its share in both.

Sensor by sensor the baseline absorbs its own share of an effect, and what it leaves of a stand error is no vector any
more. So *before* is taken at the parameters of the extended model: what that leaves, plus the whole effect.
"""

import numpy as np

from estimator.diagnosis.explanation.extended_model import joint_amplitude
from estimator.diagnosis.posterior.explained import Detection, ExplainedSession
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.results import ParitySplit
from estimator.session import Array


def parity_split(state: ExplainedSession, detection: Detection) -> ParitySplit | None:
    """χ² in parity space and in the range of the axes, with the effect left in and taken out.

    None for three sensors, which have no parity.
    """
    kinds = state.baseline.setting.kinds
    if len(kinds) <= 3 or len(set(kinds)) > 1:
        return None
    amplitude, _ = joint_amplitude(state, detection)
    effect = state.residuals.whitened(detection.best.shape.columns) @ amplitude
    after = state.remaining
    before = after.copy()
    before[: len(effect)] += effect
    parity_before, range_before = energies(state.residuals, before)
    parity_after, range_after = energies(state.residuals, after)
    share = signature_share(state.residuals, detection.best.shape.columns)
    return ParitySplit(share, parity_before, parity_after, range_before, range_after)


def energies(residuals: WhitenedResiduals, z: Array) -> tuple[float, float]:
    """Squared norm of whitened rows z (n,), standard errors, in parity space and in the range of the axes."""
    R, m = residuals.baseline.residual.shape
    rows = z[: R * m].reshape(R, m)
    weighted = residuals.whiten.weight[:, :, None] * residuals.baseline.parameters.axis
    basis, _ = np.linalg.qr(weighted)
    inside = (np.swapaxes(basis, -1, -2) @ rows[..., None])[..., 0]
    within = float((inside**2).sum())
    return float((rows**2).sum()) - within, within


def signature_share(residuals: WhitenedResiduals, columns: Array) -> float:
    """Share of the energy of a signature (R, m, q), m/s² (rad/s), that lies in parity space before any fit.

    0 for a pure stand error.
    """
    weighted = columns * residuals.whiten.weight[..., None]
    R, m, q = weighted.shape
    parity, within = np.sum([energies(residuals, weighted[..., k].reshape(R * m)) for k in range(q)], axis=0)
    return float(parity / max(parity + within, 1e-300))
