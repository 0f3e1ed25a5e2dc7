"""Every signature that could explain the left-over, with its score.

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
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc, chdtri, fdtrc

from estimator.causes import Shape, Signature
from estimator.diagnosis.evidence import Evidence
from estimator.session import Array

FAINT = 0.02
"""A direction of a signature counts when its trace is above this share of the strongest direction's."""

INVISIBLE = 1e-3
"""Share of a signature that must be left by the baseline for it to be visible at all."""


@dataclass(frozen=True, eq=False)
class Traces:
    """The traces of all shapes of one cause. S shapes, n data rows, q amplitudes."""

    cause: Signature
    shapes: tuple[Shape, ...]
    lasting: tuple[bool, ...]
    """(S,)"""
    columns: Array
    """(S, n, q)"""
    raw: Array
    """(S,) largest norm of a column before the baseline absorbed its share."""


@dataclass(frozen=True, eq=False)
class Scored:
    """One shape's score after earlier findings were taken out."""

    cause: Signature
    shape: Shape
    lasting: bool
    columns: Array
    """(n, q) trace."""
    statistic: float
    """Equivalent χ²."""
    freedom: int
    evidence: float
    """ln Bayes factor, the share of the cause's prior included."""
    p_value: float
    """Of this shape alone."""
    places: int
    """Number of shapes the cause was tried with."""

    @property
    def group(self) -> tuple[str, tuple[int, ...]]:
        """What is named: the cause and its sensors."""
        return self.cause.identifier, self.shape.sensors

    @property
    def strength(self) -> float:
        return float(np.sqrt(self.statistic))


def traces_of(evidence: Evidence, causes: Iterable[Signature]) -> list[Traces]:
    """Traces of every available cause, in their order."""
    setting = evidence.baseline.setting
    found = []
    for cause in causes:
        if not cause.available(setting) or (cause.between and evidence.between is None):
            continue
        shapes = tuple(cause.shapes(setting))
        if shapes:
            found.append(_traces(evidence, cause, shapes))
    return found


def _traces(evidence: Evidence, cause: Signature, shapes: tuple[Shape, ...]) -> Traces:
    """Traces of one cause: lasting and new where there is history, new alone for what moved since."""
    q = shapes[0].columns.shape[-1]
    stacked = np.concatenate([s.columns for s in shapes], axis=-1)
    versions = [False] if cause.between else [True] if evidence.between is None else [True, False]
    columns = []
    for lasting in versions:
        trace = evidence.trace(stacked, lasting=lasting)
        columns.append(np.moveaxis(trace.reshape(len(trace), len(shapes), q), 1, 0))
    white = np.linalg.norm(evidence.raw(stacked), axis=0).reshape(len(shapes), q).max(axis=-1)
    return Traces(
        cause,
        shapes * len(versions),
        tuple(v for v in versions for _ in shapes),
        np.concatenate(columns),
        np.tile(white, len(versions)),
    )


def score(evidence: Evidence, traces: Sequence[Traces], taken: Array) -> list[Scored]:
    """Score every shape on what the findings so far leave.

    ``taken`` (n, f) orthonormal traces of the findings so far.
    """
    z = evidence.z - taken @ (taken.T @ evidence.z)
    return [scored for t in traces for scored in _score(evidence, t, taken, z)]


def _score(evidence: Evidence, traces: Traces, taken: Array, z: Array) -> Iterable[Scored]:
    columns = traces.columns - taken @ (taken.T @ traces.columns)
    norms = np.maximum(np.linalg.norm(columns, axis=1, keepdims=True), 1e-300)
    basis, size = orthonormal(columns / norms)
    visible = (traces.raw > 0) & (norms[:, 0, :].max(axis=-1) > INVISIBLE * traces.raw)
    live = (size > FAINT * size[:, :1]) & visible[:, None]
    power = ((z @ basis) ** 2 * live).sum(axis=-1)
    freedom = live.sum(axis=-1)
    places = int(visible.sum())
    for s in np.flatnonzero(visible):
        shape, q = traces.shapes[s], int(freedom[s])
        statistic = equivalent(evidence, shape, float(power[s]), q, z)
        yield Scored(
            traces.cause,
            shape,
            traces.lasting[s],
            traces.columns[s],
            statistic,
            q,
            bayes_factor(statistic, q) - float(np.log(places)),
            float(chdtrc(q, statistic)) if q else 1.0,
            places,
        )


def orthonormal(columns: Array) -> tuple[Array, Array]:
    """Orthonormal bases (S, n, q) and sizes (S, q) of (S, n, q)."""
    if columns.shape[-1] == 1:
        return columns, np.ones((len(columns), 1))
    basis, size, _ = np.linalg.svd(columns, full_matrices=False)
    return basis, size


def bayes_factor(statistic: float, q: int) -> float:
    """ln of the local empirical Bayes factor of an effect with q amplitudes against none."""
    if q == 0 or statistic <= q:
        return 0.0
    return 0.5 * (statistic - q) - 0.5 * q * float(np.log(statistic / q))


def equivalent(evidence: Evidence, shape: Shape, power: float, q: int, z: Array) -> float:
    """χ² of a signature that is as unlikely as the power it takes out.

    Where the noise of its sensors is estimated from these very residuals, F = (T/q)/((f − T)/(f − q)) takes the place
    of T, carried over to χ² at the same tail probability.
    """
    unstated = evidence.baseline.unstated
    sensors = list(shape.sensors) or list(range(len(unstated)))
    if q == 0 or not unstated[sensors].any():
        return power
    owned = np.isin(evidence.owner(), sensors)
    total = float((z[owned] ** 2).sum())
    freedom = evidence.freedom * len(sensors) / len(unstated) + float(owned[evidence.readings :].sum())
    if freedom <= q + 1:
        return 0.0
    rest = max(total - power, 1e-6 * max(total, 1e-300))
    tail = float(fdtrc(q, freedom - q, power / q / (rest / (freedom - q))))
    return float(chdtri(q, max(tail, 1e-290)))


def ranked(scored: Sequence[Scored]) -> list[tuple[Scored, float]]:
    """The best shape of every (cause, sensors) with the ln evidence of all its shapes, strongest first."""
    groups: dict[tuple[str, tuple[int, ...]], list[Scored]] = {}
    for s in scored:
        groups.setdefault(s.group, []).append(s)
    best = [
        (max(members, key=lambda s: s.evidence), float(np.logaddexp.reduce([s.evidence for s in members])))
        for members in groups.values()
    ]
    return sorted(best, key=lambda pair: -round(pair[1], 6))
