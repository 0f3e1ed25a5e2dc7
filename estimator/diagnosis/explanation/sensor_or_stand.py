"""Stand or sensor? Where a finding's signature lives: in the range of the axes, or in parity space.

An error of the applied vector moves all sensors as some vector would: it lies in the range of H (m×3, the axes) and
leaves nothing in parity space. A fault of one sensor cannot hide there: it leaves its share in both.

Sensor by sensor the baseline absorbs its own share of an effect, and what it leaves of a stand error is no vector any
more. So *before* is taken at the parameters of the extended model: what that leaves, plus the whole effect.
"""

import numpy as np

from estimator.diagnosis.explanation.rivals import amplitude
from estimator.diagnosis.results import ParitySplit
from estimator.diagnosis.selection.search_state import Found, Search
from estimator.diagnosis.signatures.scores import Scored
from estimator.session import Array


def parity_split(state: Search, found: Found) -> ParitySplit | None:
    """χ² in parity space and in the range of the axes, with the effect left in and taken out.

    None for three sensors, which have no parity.
    """
    kinds = state.baseline.setting.kinds
    m = len(kinds)
    if m <= 3 or len(set(kinds)) > 1:
        return None
    taken = state.taken()
    after = state.evidence.z - taken @ (taken.T @ state.evidence.z)
    effect = state.evidence.raw(found.best.shape.columns) @ amplitude(state, found)
    before = after.copy()
    before[: len(effect)] += effect
    own = signature_share(state, found.best)
    parity_before, range_before = energies(state, before)
    parity_after, range_after = energies(state, after)
    return ParitySplit(
        signature_in_parity=own,
        parity_before=parity_before,
        parity_after=parity_after,
        range_before=range_before,
        range_after=range_after,
    )


def energies(state: Search, z: Array) -> tuple[float, float]:
    """Squared norm of whitened reading rows in parity space and in the range of the axes."""
    R, m = state.baseline.residual.shape
    rows = z[: R * m].reshape(R, m)
    weighted = state.evidence.whiten.weight[:, :, None] * state.baseline.parameters.axis
    basis, _ = np.linalg.qr(weighted)
    inside = (np.swapaxes(basis, -1, -2) @ rows[..., None])[..., 0]
    within = float((inside**2).sum())
    return float((rows**2).sum()) - within, within


def signature_share(state: Search, scored: Scored) -> float:
    """Share of the signature's own energy, before any fit, that lies in parity space: 0 for a pure stand error."""
    columns = scored.shape.columns * state.evidence.whiten.weight[..., None]
    R, m, q = columns.shape
    parity, within = np.sum([energies(state, columns[..., k].reshape(R * m)) for k in range(q)], axis=0)
    return float(parity / max(parity + within, 1e-300))
