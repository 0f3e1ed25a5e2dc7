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
from scipy.special import chdtrc, chdtri, fdtrc

from estimator.causes import Shape, Signature
from estimator.diagnosis.evidence import Evidence
from estimator.session import Array

FAINT = 0.02
"""A direction of a signature counts when its trace is above this share of the strongest direction's."""

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
            found.extend(_all_traces(evidence, cause, shapes))
    return found


def _all_traces(evidence: Evidence, cause: Signature, shapes: tuple[Shape, ...]) -> list[Traces]:
    """Traces of one cause. With history: as lasting since then, as new, and with the sensor's own move left open."""
    if cause.between or cause.nameless or evidence.between is None:
        return [_version(evidence, cause, shapes, lasting=not cause.between)]
    lasting = _version(evidence, cause, shapes, lasting=True)
    versions = [lasting, _version(evidence, cause, shapes, lasting=False), freed(evidence, lasting)]
    return [v for v in versions if v is not None]


def _version(evidence: Evidence, cause: Signature, shapes: tuple[Shape, ...], *, lasting: bool) -> Traces:
    """Traces of all shapes of a cause that either lasts since the history or is new."""
    q = shapes[0].columns.shape[-1]
    stacked = np.concatenate([s.columns for s in shapes], axis=-1)
    trace = evidence.trace(stacked, lasting=lasting)
    columns = np.moveaxis(trace.reshape(len(trace), len(shapes), q), 1, 0)
    raw = np.linalg.norm(evidence.raw(stacked), axis=0).reshape(len(shapes), q)
    return Traces(cause, shapes, (lasting,) * len(shapes), columns, raw.max(axis=-1))


def freed(evidence: Evidence, traces: Traces) -> Traces | None:
    """The same with the sensor's move since the history left open; None for causes of no sensor.

    An effect that some of the history had too, at other temperatures or positions, moves the sensor's parameters by
    an amount that only a diagnosis of every earlier session would tell.
    """
    assert evidence.between is not None
    if not traces.shapes[0].sensors:
        return None
    S, n, _ = traces.columns.shape
    own = np.zeros((S, n, 5))
    for k, shape in enumerate(traces.shapes):
        rows = evidence.readings + 5 * shape.sensors[0]
        own[k, rows : rows + 5] = np.eye(5)
    blank = np.zeros((*traces.shapes[0].columns.shape[:2], 5))
    shapes = tuple(Shape(s.sensors, np.concatenate([s.columns, blank], axis=-1), s.nonlinear) for s in traces.shapes)
    return Traces(traces.cause, shapes, traces.lasting, np.concatenate([traces.columns, own], axis=-1), traces.raw)


def score(evidence: Evidence, traces: Sequence[Traces], taken: Array) -> list[Scored]:
    """Score every shape on what the findings so far leave.

    ``taken`` (n, f) orthonormal traces of the findings so far.
    """
    z = evidence.z - taken @ (taken.T @ evidence.z)
    return [scored for t in traces for scored in _score(evidence, t, taken, z)]


def rescored(evidence: Evidence, scored: Scored, taken: Array) -> Scored:
    """One shape scored anew on what other findings leave."""
    raw = np.linalg.norm(evidence.raw(scored.shape.columns), axis=0).max()
    alone = Traces(scored.cause, (scored.shape,), (scored.lasting,), scored.columns[None], np.array([raw]))
    z = evidence.z - taken @ (taken.T @ evidence.z)
    again = next(iter(_score(evidence, alone, taken, z)), None)
    if again is None:
        return replace(scored, statistic=0.0, evidence=-float(np.log(scored.places)), p_value=1.0)
    return replace(again, evidence=again.evidence - float(np.log(scored.places)), places=scored.places)


def _score(evidence: Evidence, traces: Traces, taken: Array, z: Array) -> Iterable[Scored]:
    columns = traces.columns - taken @ (taken.T @ traces.columns)
    norms = np.maximum(np.linalg.norm(columns, axis=1, keepdims=True), 1e-300)
    basis, size = orthonormal(columns / norms)
    amplitudes = max(len(traces.cause.units), 1) if traces.cause.units else columns.shape[-1]
    visible = (traces.raw > 0) & (norms[:, 0, :amplitudes].max(axis=-1) > INVISIBLE * traces.raw)
    live = (size > FAINT * size[:, :1]) & visible[:, None]
    power = ((z @ basis) ** 2 * live).sum(axis=-1)
    freedom = live.sum(axis=-1)
    places, used = int(visible.sum()), (taken**2).sum(axis=1)
    for s in np.flatnonzero(visible):
        if not possible(traces, int(s), columns[s], z):
            continue
        shape, q = traces.shapes[s], int(freedom[s])
        statistic = equivalent(evidence, shape, float(power[s]), q, z, used)
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


def possible(traces: Traces, s: int, columns: Array, z: Array) -> bool:
    """Whether the amplitude that fits best is one that the cause can have; asked of single amplitudes only."""
    size = float((columns[:, 0] ** 2).sum())
    if not traces.cause.bounded or size == 0:
        return True
    return traces.cause.plausible(traces.shapes[s], float(columns[:, 0] @ z) / size)


def orthonormal(columns: Array) -> tuple[Array, Array]:
    """Orthonormal bases (S, n, q) and sizes (S, q) of (S, n, q)."""
    if columns.shape[-1] == 1:
        return columns, np.ones((len(columns), 1))
    basis, size, _ = np.linalg.svd(columns, full_matrices=False)
    return basis, size


def bayes_factor(statistic: float, q: int) -> float:
    """ln of the local empirical Bayes factor of an effect with q amplitudes against none, less Occam's due."""
    if q == 0 or statistic <= q:
        return 0.0
    return 0.5 * (statistic - q) - 0.5 * q * float(np.log(statistic / q)) - OCCAM * (q - 1)


def equivalent(evidence: Evidence, shape: Shape, power: float, q: int, z: Array, used: Array) -> float:
    """χ² of a signature that is as unlikely as the power it takes out.

    Where the noise of its sensors is estimated from these very residuals, F = (T/q)/((f − T)/(f − q)) takes the place
    of T, carried over to χ² at the same tail probability. ``used`` (n,) is the share of every row that the findings so
    far have taken out of z.
    """
    unstated = evidence.baseline.unstated
    sensors = list(shape.sensors) or list(range(len(unstated)))
    if q == 0 or not unstated[sensors].any():
        return power
    owned = np.isin(evidence.owner(), sensors)
    total = float((z[owned] ** 2).sum())
    freedom = evidence.freedom * len(sensors) / len(unstated) + float(owned[evidence.readings :].sum())
    freedom -= float(used[owned].sum())
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
