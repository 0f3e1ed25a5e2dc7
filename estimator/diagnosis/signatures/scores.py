"""The score of every signature that could explain the residuals.

Theory
------
A signature's trace X (whitened, baseline projected out) has the score T = |X̂'z|², X̂ its orthonormal basis: χ² with q
degrees of freedom without the effect, noncentral with the squared strength with it. Directions of a signature that
the session hardly shows are left out of q. Signatures of one cause (places, nonlinear parameters) share its prior
evenly; the evidence of a shape against no effect is the local empirical Bayes factor

    ln B = ½(T − q) − ½ q ln(T/q)            (Liang et al. 2008, (11), known variance)

which charges every free amplitude for what it could have fitted. Unknown noise turns T into the χ² of the same tail
probability as its F.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtrc

from estimator.causes.contract import Setting, Shape, Signature
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.signatures.scatter import ReadingScatter, equivalent_chi2
from estimator.diagnosis.signatures.traces import INVISIBLE, Group, Scored, Traces
from estimator.session import Array

FAINT = 0.02
"""Share of the strongest direction's trace above which a direction of a signature counts as an amplitude of its own:
a weaker one would cost a degree of freedom for an amplitude that the session hardly shows."""

LARGEST = 0.3
"""Largest part of the applied vector that an effect on a stand may be: beyond it linear signatures no longer hold, and
a record error or a clipped channel, both put right before, is the likelier explanation."""

WORTH = 1e-3
"""p-value below which a signature is looked at as an explanation: is its amplitude within reason, is it a rival?
It screens and names nothing: a name needs `LEVEL` over the whole catalogue."""

ALONE = 1e-4
"""p-value, all places of a cause together, at which it shows in the session by itself: the family-wise level over a
catalogue of some forty. What is only seen because the sensor changed since the history is a change, and no such cause.
"""

TOO_FAINT = 4.0
"""Standard errors that an effect of the size fitted leaves in the session's own rows below which it need not show."""

OCCAM = 0.7
"""ln evidence that every amplitude beyond the first costs, a factor of two: it balances simple causes against richer
ones that contain them, so that alternatives stay few (docs/diagnosis/study.md, alternatives)."""


@dataclass(frozen=True, eq=False)
class Projected:
    """Residuals with the traces of earlier findings projected out. n rows, f directions."""

    residuals: WhitenedResiduals
    attributed: Array
    """(n, f) orthonormal traces of the findings."""
    z: Array
    """(n,) standard errors: what the findings leave."""

    @classmethod
    def of(cls, residuals: WhitenedResiduals, attributed: Array) -> "Projected":
        """``attributed`` (n, f) orthonormal traces of the findings, dimensionless."""
        return cls(residuals, attributed, residuals.z - attributed @ (attributed.T @ residuals.z))

    @property
    def scatter(self) -> ReadingScatter:
        """The same of the readings alone."""
        r = self.residuals
        freedom = r.row_freedom - (self.attributed[: r.rows] ** 2).sum(axis=-1)
        return ReadingScatter(r.baseline, self.z[: r.rows], freedom, r.sensor_of_row[: r.rows])


def score(residuals: WhitenedResiduals, traces: Sequence[Traces], attributed: Array) -> list[Scored]:
    """Score every shape on what the findings leave: ``attributed`` (n, f) orthonormal traces, dimensionless."""
    projected = Projected.of(residuals, attributed)
    return [scored for t in traces for scored in _score(projected, t)]


def rescored(residuals: WhitenedResiduals, scored: Scored, attributed: Array) -> Scored:
    """One shape scored anew on what other findings leave: ``attributed`` (n, f) orthonormal traces, dimensionless."""
    raw = np.linalg.norm(residuals.whitened(scored.shape.columns), axis=0)
    alone = Traces(scored.cause, (scored.shape,), (scored.lasting,), scored.trace[None], raw[None], scored.places)
    again = next(iter(_score(Projected.of(residuals, attributed), alone)), None)
    if again is None:
        return replace(scored, statistic=0.0, log_evidence=-float(np.log(scored.places)), p_value=1.0)
    return again


def _score(projected: Projected, traces: Traces) -> Iterable[Scored]:
    """The visible shapes of one cause whose amplitude is within reason."""
    columns = traces.columns - projected.attributed @ (projected.attributed.T @ traces.columns)
    norms = np.linalg.norm(columns, axis=1)
    shown = norms > np.maximum(INVISIBLE * traces.raw, 1e-300)
    basis, size, turn = orthonormal(columns * np.where(shown, 1 / np.where(shown, norms, 1.0), 0.0)[:, None, :])
    visible = (shown & (traces.raw > 0)).any(axis=-1)
    live = (size > FAINT * size[:, :1]) & visible[:, None]
    along = np.where(live, projected.z @ basis, 0.0)
    freedom = live.sum(axis=-1)
    inverse = np.where(live, 1 / np.where(live, size, 1.0), 0.0)
    amplitude = (turn.swapaxes(-1, -2) @ (along * inverse)[..., None])[..., 0] / np.where(shown, norms, np.inf)
    energy, rest = projected.scatter.without(traces.shapes, basis * live[:, None, :], along)
    statistic = equivalent_chi2((along**2).sum(axis=-1), freedom, energy, rest)
    p_value = np.where(freedom > 0, chdtrc(np.maximum(freedom, 1), statistic), 1.0)
    places = max(traces.places, 1)
    for s in np.flatnonzero(visible):
        shape, t, q, p = traces.shapes[s], float(statistic[s]), int(freedom[s]), float(p_value[s])
        if p < WORTH and not within_reason(projected.residuals.baseline.setting, traces.cause, shape, amplitude[s]):
            continue
        if p < WORTH and not shows_itself(projected, traces, int(s), columns[s] * shown[s] @ np.diag(amplitude[s])):
            continue
        log_evidence = bayes_factor(t, q) - float(np.log(places))
        yield Scored(traces.cause, shape, traces.lasting[s], traces.columns[s], t, q, log_evidence, p, places)


def shows_itself(projected: Projected, traces: Traces, s: int, fitted: Array) -> bool:
    """Whether shape s of a cause that acts within the session shows there, and not only in what changed since the
    history.

    ``fitted`` (n, q) standard errors: every column at its fitted amplitude. What is too faint there to show is asked
    nothing, unless the sensor's change was left open, which explains any change by itself.
    """
    residuals, rows = projected.residuals, projected.residuals.rows
    if residuals.change is None or traces.cause.between or traces.cause.nameless:
        return True
    own = fitted[:rows, traces.raw[s] > 0]
    if (traces.raw[s] > 0).all() and float((own.sum(axis=1) ** 2).sum()) < TOO_FAINT**2:
        return True
    basis, size, _ = np.linalg.svd(own, full_matrices=False)
    basis = basis[:, size > 1e-9 * max(size[0], 1e-300)]
    return tail(projected, traces.shapes[s], basis) * max(traces.places, 1) < ALONE


def tail(projected: Projected, shape: Shape, basis: Array) -> float:
    """p-value of what a shape explains through ``basis`` (n, q), orthonormal, or through its part in N readings."""
    along = basis.T @ projected.z[: len(basis)]
    energy, rest = projected.scatter.without([shape], basis[None], along[None])
    q = np.array([max(basis.shape[1], 1)])
    statistic = equivalent_chi2((along**2).sum(keepdims=True), q, energy, rest)
    return float(chdtrc(q, statistic)[0])


def within_reason(setting: Setting, cause: Signature, shape: Shape, amplitude: Array) -> bool:
    """Whether the amplitude (q,), in the cause's SI units, that fits best is one that the cause can have.

    On a stand no effect may be a large part of the applied vector: what the baseline absorbs almost wholly would else
    explain a small residual by an enormous effect.
    """
    if cause.bounded and not cause.plausible(shape, float(amplitude[0])):
        return False
    if setting.beta is None:
        return True
    size = np.abs(shape.columns @ amplitude).max(axis=0)
    return bool(np.all(size < LARGEST * setting.norm))


def orthonormal(columns: Array) -> tuple[Array, Array, Array]:
    """Singular value decomposition of dimensionless (S, n, q): bases (S, n, q), sizes (S, q) and turns (S, q, q)."""
    if columns.shape[-1] == 1:
        size = np.linalg.norm(columns, axis=1)
        return columns, size, np.ones((len(columns), 1, 1))
    return np.linalg.svd(columns, full_matrices=False)


def bayes_factor(statistic: float, q: int) -> float:
    """ln of the local empirical Bayes factor of an effect with q amplitudes against none, less Occam's penalty."""
    if q == 0:
        return 0.0
    statistic = max(statistic, q)
    return 0.5 * (statistic - q) - 0.5 * q * float(np.log(statistic / q)) - OCCAM * (q - 1)


def ranked(scored: Sequence[Scored]) -> list[tuple[Scored, float]]:
    """The best shape of every (cause, sensors) with the ln evidence of all its shapes, strongest first."""
    groups: dict[Group, list[Scored]] = {}
    for s in scored:
        groups.setdefault(s.group, []).append(s)
    best = [
        (max(members, key=lambda s: s.log_evidence), float(np.logaddexp.reduce([s.log_evidence for s in members])))
        for members in groups.values()
    ]
    return sorted(best, key=lambda pair: -round(pair[1], 6))
