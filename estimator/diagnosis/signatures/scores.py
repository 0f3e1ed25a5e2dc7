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

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np
from scipy.special import chdtrc, erfc

from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.signatures.directions import ALIKE, whitening
from estimator.diagnosis.signatures.products import Products, Projected, RemainingProducts
from estimator.diagnosis.signatures.scatter import in_unknown_noise, reference_scatter
from estimator.diagnosis.signatures.traces import INVISIBLE, Group, Scored, Traces, sensors_of
from estimator.session import Array
from estimator.significance import equivalent_chi2

FAINT = 0.02
"""Share of the strongest direction's trace above which a direction of a signature counts as an amplitude of its own:
a weaker one would cost a degree of freedom for an amplitude that the session hardly shows."""

LARGEST = 0.3
"""Largest part of the applied vector that an effect on a stand may be: beyond it linear signatures no longer hold, and
a record error or a clipped channel, both corrected before, is the likelier explanation."""

WORTH = 1e-3
"""p-value below which a signature is looked at as an explanation: is its amplitude within reason, is it a rival?
It screens and names nothing: a name needs `LEVEL` over the whole catalogue."""

ALONE = 1e-4
"""p-value, all places of a cause together, at which it shows in the session by itself: the family-wise level over a
catalogue of some forty. What is only seen because the sensor changed since the history is a change, and no such cause.
"""

CONTRARY = 4.0
"""Standard errors by which the session's own rows must differ from the size fitted for an effect that they do not show
by themselves to be ruled out."""

OCCAM = 0.7
"""ln evidence that every amplitude beyond the first costs, a factor of two: it balances simple causes against richer
ones that contain them, so that alternatives stay few (docs/diagnosis/study.md, alternatives)."""


@dataclass(frozen=True, eq=False)
class ScoreFit:
    """S signatures of q amplitudes, each fitted alone to what the findings leave. K parts of the rows."""

    products: Products | RemainingProducts
    """Products with the findings projected out."""
    value: Array
    """(S, q) amplitudes, in the causes' SI units."""
    power: Array
    """(S,) squared length of the residuals along each signature, dimensionless."""
    freedom: Array
    """(S,) int, directions of each signature that count as amplitudes."""
    directions: Array
    """(S, q, q) amplitudes of orthonormal directions of each signature; zero where one does not count."""

    @classmethod
    def of(
        cls, products: Products | RemainingProducts, shown: Array, faint: float, group: Array | None = None
    ) -> "ScoreFit":
        """``shown`` (S, q) bool: columns that count; ``faint``: share of the strongest direction that one must have;
        ``group`` (S,) int: of which signatures all columns but the first are the same, those of one number."""
        whole, along = products.whole
        norms = np.sqrt(np.maximum(np.diagonal(whole, axis1=1, axis2=2), 0.0))
        unit = np.where(shown, 1 / np.where(shown & (norms > 0), norms, 1.0), 0.0)
        alike = whole * unit[:, :, None] * unit[:, None, :]
        turn, live = whitening(alike, shown, faint, group)
        directions = unit[:, :, None] * turn
        length = (along[:, None, :] @ directions)[:, 0]
        value = (directions @ length[..., None])[..., 0]
        return cls(products, value, (length**2).sum(axis=1), live, directions)

    def at(self, chosen: Array) -> "ScoreFit":
        """Some of the signatures, (S,) bool."""
        parts = (self.value, self.power, self.freedom, self.directions)
        return ScoreFit(self.products.at(chosen), *(x[chosen] for x in parts))

    def tested(self, projected: Projected, sensor: Array) -> tuple[Array, Array]:
        """(S,) equivalent χ² and (S,) p-value of signatures that are blamed on ``sensor`` (S,) int, −1 for none."""
        baseline = projected.residuals.baseline
        unknown = in_unknown_noise(baseline, sensor)
        energy, freedom = np.full(len(sensor), np.nan), np.full(len(sensor), np.nan)
        if unknown.any():
            remaining = self.at(unknown).remaining_of_sensors(projected)
            energy[unknown], freedom[unknown] = reference_scatter(baseline, sensor[unknown], *remaining)
        statistic = equivalent_chi2(self.power, self.freedom, energy, freedom)
        return statistic, np.where(self.freedom > 0, tail_of(np.maximum(self.freedom, 1), statistic), 1.0)

    def remaining_of_sensors(self, projected: Projected) -> tuple[Array, Array]:
        """(S, m) energy, dimensionless, and (S, m) degrees of freedom that each signature leaves of every sensor."""
        m, parts = len(projected.energy), self.products.parts
        square, moved = parts.square[:m], self.value[..., None]
        fitted = (np.swapaxes(moved, 1, 2) @ (square @ moved - 2 * parts.along[:m, ..., None]))[..., 0, 0]
        used = (self.directions * (square @ self.directions)).sum(axis=(-2, -1))
        return np.maximum(projected.energy + fitted.T, 0.0), projected.freedom - used.T


def has_nuisance(raw: Array) -> bool:
    """Whether signatures are one amplitude beside columns left open; ``raw`` (S, q) as in `Traces`."""
    return raw.shape[1] > 1 and bool((raw[:, 0] > 0).any()) and not raw[:, 1:].any()


def tail_of(freedom: Array, statistic: Array) -> Array:
    """(S,) p-values of χ² (S,) with degrees of ``freedom`` (S,) int; of one degree it is the normal distribution's."""
    tails, single = np.empty(len(statistic)), freedom == 1
    tails[single], tails[~single] = erfc(np.sqrt(statistic[single] / 2)), chdtrc(freedom[~single], statistic[~single])
    return tails


@dataclass(frozen=True, eq=False)
class Scores:
    """The visible shapes of some causes whose amplitude is within reason, in the order of the causes. k shapes."""

    traces: tuple[Traces, ...]
    cause: Array
    """(k,) int, which of the traces."""
    shape: Array
    """(k,) int, which of their shapes."""
    sensor: Array
    """(k,) int, that it is blamed on; −1 for none."""
    statistic: Array
    """(k,) equivalent χ²."""
    freedom: Array
    """(k,) int, its degrees of freedom."""
    p_value: Array
    """(k,) p-value of this shape alone."""
    log_evidence: Array
    """(k,) ln Bayes factor, the share of the cause's prior included."""

    def scored(self, k: int) -> Scored:
        """The k-th shape with its score."""
        traces, s = self.traces[self.cause[k]], int(self.shape[k])
        shape, trace = traces.whole(s)
        return Scored(
            traces.cause,
            shape,
            traces.lasting[s],
            trace,
            float(self.statistic[k]),
            int(self.freedom[k]),
            float(self.log_evidence[k]),
            float(self.p_value[k]),
            max(traces.places, 1),
            traces.shared,
        )

    def group(self, k: int) -> Group:
        """The group of the k-th shape: its cause and the number of its sensor."""
        return self.traces[self.cause[k]].cause.identifier, (() if self.sensor[k] < 0 else (int(self.sensor[k]),))

    def ranked(self) -> list[tuple[int, float]]:
        """The best shape of every (cause, sensors) with the ln evidence of all its shapes, strongest first."""
        if not len(self.cause):
            return []
        names = [t.cause.identifier for t in self.traces]
        number = np.array([names.index(name) for name in names])
        group = number[self.cause] * (self.sensor.max() + 2) + self.sensor + 1
        order = np.argsort(group, kind="stable")
        first = np.flatnonzero(np.diff(group[order], prepend=-1))
        together = np.logaddexp.reduceat(self.log_evidence[order], first)
        best = np.lexsort((-self.log_evidence, group))[first]
        oldest = order[first]
        pairs = sorted(zip((-np.round(together, 6)).tolist(), oldest.tolist(), range(len(first)), strict=True))
        return [(int(best[g]), float(together[g])) for _, _, g in pairs]


def score(residuals: WhitenedResiduals, traces: Sequence[Traces], attributed: Array) -> list[Scored]:
    """Score every shape on what the findings leave: ``attributed`` (n, f) orthonormal traces, dimensionless."""
    results = scores(residuals, traces, attributed)
    return [results.scored(k) for k in range(len(results.cause))]


def scores(residuals: WhitenedResiduals, traces: Sequence[Traces], attributed: Array) -> Scores:
    """The scores of every shape as arrays; causes of equally many amplitudes are scored as one."""
    projected = Projected.of(residuals, attributed)
    by_width = sorted((k for k, t in enumerate(traces) if t.shapes), key=lambda k: traces[k].width)
    parts = [
        _scored(projected, traces, list(members)) for _, members in groupby(by_width, key=lambda k: traces[k].width)
    ]
    if not parts:
        return Scores(tuple(traces), *(np.zeros(0, dtype=int) for _ in range(7)))
    columns = [np.concatenate(x) for x in zip(*parts, strict=True)]
    order = np.argsort(columns[0], kind="stable")
    return Scores(tuple(traces), *(x[order] for x in columns))


def _scored(projected: Projected, traces: Sequence[Traces], chosen: Sequence[int]) -> tuple[Array, ...]:
    """The columns of `Scores` of some of the traces, of equally many amplitudes."""
    selected = [traces[k] for k in chosen]
    cause = np.repeat(chosen, [len(t.shapes) for t in selected])
    shape, sensor = (
        np.concatenate([np.arange(len(t.shapes)) for t in selected]),
        np.concatenate([t.sensor for t in selected]),
    )
    raw = np.concatenate([t.raw for t in selected])
    products = projected([t.products for t in selected], [t.columns for t in selected], [t.nuisance for t in selected])
    norms = np.sqrt(np.maximum(np.diagonal(products.whole[0], axis1=1, axis2=2), 0.0))
    shown = norms > np.maximum(INVISIBLE * raw, 1e-300)
    fit = ScoreFit.of(products, shown, FAINT, sensor if has_nuisance(raw) else None)
    statistic, p_value = fit.tested(projected, sensor)
    visible = (shown & (raw > 0)).any(axis=1)
    tested = np.flatnonzero(visible & (p_value < WORTH))
    for k in np.unique(cause[tested]):
        of_cause = tested[cause[tested] == k]
        visible[of_cause] = within_reason(projected, traces[k], shape[of_cause], fit.value[of_cause])
    tested = tested[visible[tested]]
    visible[tested] = is_visible_within(
        projected, [traces[k] for k in cause[tested]], fit.at(tested), raw[tested], sensor[tested]
    )
    places = np.array([max(t.places, 1) for t in selected])[np.searchsorted(chosen, cause)]
    log_evidence = bayes_factor(statistic, fit.freedom) - np.log(places)
    columns = (cause, shape, sensor, statistic, fit.freedom, p_value, log_evidence)
    return tuple(x[visible] for x in columns)


def rescored(residuals: WhitenedResiduals, scored: Scored, attributed: Array) -> Scored:
    """One shape scored anew on what other findings leave: ``attributed`` (n, f) orthonormal traces, dimensionless."""
    raw = np.linalg.norm(residuals.whitened(scored.shape.columns), axis=0)
    columns = scored.trace[None]
    products = Products.of(residuals, columns)
    whence = (scored.lasting,), sensors_of([scored.shape])
    alone = Traces(
        scored.cause, (scored.shape,), *whence, columns, raw[None], scored.places, products, shared=scored.shared
    )
    again = next(iter(score(residuals, [alone], attributed)), None)
    if again is None:
        return replace(scored, statistic=0.0, log_evidence=-float(np.log(scored.places)), p_value=1.0)
    return again


def is_visible_within(
    projected: Projected, traces: Sequence[Traces], fit: ScoreFit, raw: Array, sensor: Array
) -> Array:
    """(S,) bool: whether shapes of causes that act within the session show there, and not only in what changed since
    the history.

    ``raw`` (S, q) as in `Traces`, ``sensor`` (S,) int. What the session's own rows do not contradict need not show in
    them, unless the sensor's change was left open, which explains any change by itself.
    """
    if projected.residuals.change is None or not len(sensor):
        return np.ones(len(sensor), dtype=bool)
    parts = fit.products.parts
    within = Products(parts.square[:-1], parts.along[:-1])
    amplitude = np.where(raw > 0, fit.value, 0.0)
    rest = ScoreFit.of(within, amplitude != 0, ALIKE)
    missing = np.where(raw > 0, amplitude - rest.value, 0.0)
    contrary = (missing[:, None, :] @ within.whole[0] @ missing[..., None])[:, 0, 0] > CONTRARY**2
    exempt = np.array([t.cause.between or t.cause.nameless or t.shared for t in traces]) | (
        (raw > 0).all(axis=1) & ~contrary
    )
    places = np.array([max(t.places, 1) for t in traces])
    return np.asarray(exempt | (rest.tested(projected, sensor)[1] * places < ALONE))


def tail(projected: Projected, sensor: int, basis: Array) -> float:
    """p-value of what a signature blamed on a sensor (−1 for none) explains through ``basis`` (n, q), orthonormal and
    orthogonal to the findings."""
    remaining = projected([Products.of(projected.residuals, basis[None])], [basis[None]])
    fit = ScoreFit.of(remaining, np.ones((1, basis.shape[1]), dtype=bool), ALIKE)
    return float(fit.tested(projected, np.array([sensor]))[1][0])


def within_reason(projected: Projected, traces: Traces, chosen: Array, amplitude: Array) -> Array:
    """(k,) bool: whether amplitudes (k, q), in the cause's SI units, that fit the shapes ``chosen`` (k,) int best are
    such as the cause can have.

    On a stand no effect may be a large part of the applied vector: what the baseline absorbs almost wholly would else
    explain a small residual by an enormous effect.
    """
    setting, cause = projected.residuals.baseline.setting, traces.cause
    shapes, plausible = [traces.shapes[s] for s in chosen], np.ones(len(chosen), dtype=bool)
    if cause.bounded:
        plausible[:] = [cause.plausible(s, float(a[0])) for s, a in zip(shapes, amplitude, strict=True)]
    if setting.beta is None:
        return plausible
    norm = setting.norm if traces.common else setting.norm[traces.sensor[chosen], None]
    sensor = traces.sensor[chosen].tolist()
    columns = np.stack([s.columns if i < 0 else s.columns[:, i : i + 1] for s, i in zip(shapes, sensor, strict=True)])
    size = np.abs((columns @ amplitude[:, None, : columns.shape[-1], None])[..., 0]).max(axis=1)
    return np.asarray(plausible & (size < LARGEST * norm).all(axis=1))


def bayes_factor(statistic: Array | float, q: Array | int) -> Array:
    """ln of the local empirical Bayes factor of an effect with q amplitudes against none, less Occam's penalty."""
    number = np.maximum(q, 1)
    over = np.maximum(statistic, number) / number
    return np.where(np.equal(q, 0), 0.0, 0.5 * number * (over - 1 - np.log(over)) - OCCAM * (number - 1))
