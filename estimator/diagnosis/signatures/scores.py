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
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtrc

from estimator.causes import Shape, Signature
from estimator.diagnosis.residuals.whitened import Evidence
from estimator.diagnosis.signatures.scatter import Left, equivalent
from estimator.session import Array

FAINT = 0.02
"""A direction of a signature counts when its trace is above this share of the strongest direction's."""

LARGEST = 0.3
"""Largest part of the applied vector that an effect on a stand may be."""

WORTH = 1e-3
"""p-value below which a signature is looked at as an explanation: is its amplitude within reason, is it a rival?"""

OCCAM = 0.7
"""ln evidence that every amplitude beyond the first costs: the simpler of two causes is the likelier one."""

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
    """(S, q) norm of every column before the baseline absorbed its share; 0 for columns that are no amplitude."""
    places: int
    """Number of shapes that are visible at all: what the cause's prior is shared among."""

    def at(self, sensors: tuple[int, ...]) -> "Traces":
        """The shapes on some sensors, and those of no sensor; the prior is still shared among all."""
        own = [k for k, s in enumerate(self.shapes) if s.sensors in ((), sensors)]
        kept = tuple(self.shapes[k] for k in own), tuple(self.lasting[k] for k in own)
        return replace(self, shapes=kept[0], lasting=kept[1], columns=self.columns[own], raw=self.raw[own])


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


def score(evidence: Evidence, traces: Sequence[Traces], taken: Array) -> list[Scored]:
    """Score every shape on what the findings so far leave.

    ``taken`` (n, f) orthonormal traces of the findings so far.
    """
    left = Left.of(evidence, taken)
    return [scored for t in traces for scored in _score(left, t)]


def rescored(evidence: Evidence, scored: Scored, taken: Array) -> Scored:
    """One shape scored anew on what other findings leave."""
    raw = np.linalg.norm(evidence.raw(scored.shape.columns), axis=0)
    alone = Traces(scored.cause, (scored.shape,), (scored.lasting,), scored.columns[None], raw[None], scored.places)
    again = next(iter(_score(Left.of(evidence, taken), alone)), None)
    if again is None:
        return replace(scored, statistic=0.0, evidence=-float(np.log(scored.places)), p_value=1.0)
    return again


def _score(left: Left, traces: Traces) -> Iterable[Scored]:
    columns = traces.columns - left.taken @ (left.taken.T @ traces.columns)
    norms = np.linalg.norm(columns, axis=1)
    shown = norms > np.maximum(INVISIBLE * traces.raw, 1e-300)
    basis, size, turn = orthonormal(columns * np.where(shown, 1 / np.where(shown, norms, 1.0), 0.0)[:, None, :])
    visible = (shown & (traces.raw > 0)).any(axis=-1)
    live = (size > FAINT * size[:, :1]) & visible[:, None]
    along = np.where(live, left.z @ basis, 0.0)
    freedom = live.sum(axis=-1)
    inverse = np.where(live, 1 / np.where(live, size, 1.0), 0.0)
    amplitude = (turn.swapaxes(-1, -2) @ (along * inverse)[..., None])[..., 0] / np.where(shown, norms, np.inf)
    energy, rest = left.scatter(traces.shapes, basis * live[:, None, :], along)
    statistic = equivalent((along**2).sum(axis=-1), freedom, energy, rest)
    p_value = np.where(freedom > 0, chdtrc(np.maximum(freedom, 1), statistic), 1.0)
    places = max(traces.places, 1)
    for s in np.flatnonzero(visible):
        shape, t, q, p = traces.shapes[s], float(statistic[s]), int(freedom[s]), float(p_value[s])
        if p < WORTH and not within_reason(left.evidence, traces.cause, shape, amplitude[s]):
            continue
        if (traces.raw[s] == 0).any() and not seen_within(columns[s][:, traces.raw[s] > 0], left.z, places):
            continue
        weight = bayes_factor(t, q) - float(np.log(places))
        yield Scored(traces.cause, shape, traces.lasting[s], traces.columns[s], t, q, weight, p, places)


def seen_within(columns: Array, z: Array, places: int) -> bool:
    """Whether a cause beside which the sensor's move is left open shows in the session itself: columns (n, q)."""
    basis, size, _ = np.linalg.svd(columns, full_matrices=False)
    live = basis[:, size > 1e-9 * max(size[0], 1e-300)]
    return float(chdtrc(live.shape[1], ((live.T @ z) ** 2).sum())) * places < WORTH


def within_reason(evidence: Evidence, cause: Signature, shape: Shape, amplitude: Array) -> bool:
    """Whether the amplitude (q,) that fits best is one that the cause can have.

    On a stand no effect may be a large part of the applied vector: what the baseline absorbs almost wholly would else
    explain a small left-over by an enormous effect.
    """
    if cause.bounded and not cause.plausible(shape, float(amplitude[0])):
        return False
    setting = evidence.baseline.setting
    if setting.beta is None:
        return True
    size = np.abs(shape.columns @ amplitude).max(axis=0)
    return bool(np.all(size < LARGEST * setting.norm))


def orthonormal(columns: Array) -> tuple[Array, Array, Array]:
    """Singular value decomposition of (S, n, q): bases (S, n, q), sizes (S, q) and turns (S, q, q)."""
    if columns.shape[-1] == 1:
        size = np.linalg.norm(columns, axis=1)
        return columns, size, np.ones((len(columns), 1, 1))
    return np.linalg.svd(columns, full_matrices=False)


def bayes_factor(statistic: float, q: int) -> float:
    """ln of the local empirical Bayes factor of an effect with q amplitudes against none, less Occam's due."""
    if q == 0:
        return 0.0
    statistic = max(statistic, q)
    return 0.5 * (statistic - q) - 0.5 * q * float(np.log(statistic / q)) - OCCAM * (q - 1)


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
