"""Has anything changed, and which sensor? χ² over all of parity, and the likelihood ratio of every single sensor.

Detection takes half of the stated false-alarm rate for χ² of all q numbers, which sees any change, and half for the
best single hypothesis (Bonferroni over sensors × kinds), which sees one sensor's change when q is large. Because the
noise comes from the recording itself, χ² and the ratios are compared with distributions that are wider by what a
variance from few groups adds.

Isolation. Hypotheses with different numbers of unknowns are compared by the probability of their ratios. A rival whose
score is less than Δ below the best stays a candidate; Δ is such that the true sensor loses by more than Δ with at most
1 % probability, however alike two sensors look (a score difference of sensors at distance D is normal with mean −D²
and variance 4D², whose tail beyond Δ is largest at D = √Δ).
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve, solve_triangular
from scipy.special import ndtri

from estimator.parity.isolation import Rivals, log_tail, shortfall
from estimator.parity.regression import ParityChange
from estimator.parity.results import AXIS, BIAS, KINDS, SCALE, SEVERAL, Candidate, SensorParity, Sight
from estimator.session import Array
from estimator.significance import critical_chi2, p_value

ELEMENTS = {BIAS: [1], SCALE: [0], AXIS: [3, 4], SEVERAL: [1, 0, 3, 4]}
"""Columns of `Reference.signatures` that a kind of change moves."""

WRONG_SENSOR = 0.01
"""Chance that the true sensor is passed over; the level of the detection, once more."""
POWER = 0.95
"""Power with which a change of the stated size is found: a parameter passes if it would be found 19 times in 20."""
UNSEEN = 1e-6
"""A signature of less than this share of a plain one leaves no trace."""


@dataclass(frozen=True, eq=False)
class ParityHypothesis:
    """One sensor changed in one way. q numbers of parity, k of the change."""

    sensor: int
    kind: str
    whitened: Array
    """(q, k) signature, in standard errors per unit of the change."""
    basis: Array
    """(q, r) orthonormal basis of it, dimensionless."""
    ratio: float
    """Fall of χ², dimensionless."""
    score: float
    """−2 ln of the probability of the ratio by chance."""
    p_value: float


class ParityEvidence:
    """A change, whitened, with all hypotheses tried."""

    def __init__(self, change: ParityChange) -> None:
        """``seen`` (q,) is Θ in standard errors; ``all`` every sensor × kind."""
        self.change = change
        root = np.linalg.cholesky(change.covariance)
        self.seen = solve_triangular(root, change.theta.ravel(), lower=True)
        self._root = root
        self.own_noise = self.share(change.noise)
        self.chi2 = float(self.seen @ self.seen)
        shown = change.reference.signatures(change.norm)
        columns = np.stack([change.signature(i, rows) for i, rows in enumerate(shown)])
        whitened = [solve_triangular(root, signature, lower=True) for signature in columns]
        self.all = [
            self._tried(i, kind, signature[:, ELEMENTS[kind]]) for i, signature in enumerate(whitened) for kind in KINDS
        ]
        self._single = [h for h in self.all if h.kind != SEVERAL]

    def share(self, part: Array) -> float:
        """Average share of a part of the covariance (q, q), (m/s²)² ((rad/s)²), in the whole, 0 to 1."""
        return float(np.trace(cho_solve((self._root, True), part))) / len(part)

    @property
    def dof(self) -> float:
        """Degrees of freedom of the noise; larger where the reference's error, which is known, is most of the
        uncertainty.
        """
        return self.change.dof / max(self.own_noise, 1e-3)

    def _tried(self, sensor: int, kind: str, whitened: Array) -> ParityHypothesis:
        """The hypothesis with its ratio and p-value; whitened (q, k), standard errors per unit of the change."""
        U, sizes, _ = np.linalg.svd(whitened, full_matrices=False)
        basis = U[:, sizes > UNSEEN * max(sizes[0], np.finfo(float).tiny)]
        ratio = float(((basis.T @ self.seen) ** 2).sum())
        k = max(basis.shape[1], 1)
        p, score = tail(ratio, k, self.dof)
        return ParityHypothesis(sensor, kind, whitened, basis, ratio, score, p)

    def p_value(self, chi2: float, dof: int) -> float:
        """Probability of χ² this large over ``dof`` numbers, the uncertainty of the noise included."""
        scale, effective = self.moments(dof)
        return float(p_value(chi2 / scale, effective))

    def moments(self, q: int) -> tuple[float, float]:
        """χ² of q numbers as scale·χ²(dof): s numbers a sensor, with a covariance from few groups (Hotelling).

        F of s and ν − s + 1 degrees of freedom has a variance from four of the latter on; ν is s + 4 at least.
        """
        s = self.change.excited.shape[1]
        nu = max(self.dof, s + 4.0)
        second = nu - s + 1
        factor = s * nu / second
        parts = q / s
        spread = 2 * second**2 * (s + second - 2) / (s * (second - 2) ** 2 * (second - 4))  # variance of F
        mean, variance = parts * (factor * second / (second - 2)), parts * (factor**2 * spread)
        return variance / (2 * mean), 2 * mean**2 / variance

    def detected(self, false_alarm: float) -> bool:
        """Whether any change is detected."""
        best = min(h.p_value for h in self.all) * len(self.all)
        return bool(min(self.p_value(self.chi2, len(self.seen)), best) < false_alarm / 2)

    def candidates(self) -> list[ParityHypothesis]:
        """Hypotheses no worse than Δ below the best, best first; of a sensor ``several`` only where nothing simpler."""
        ranked = sorted(self.all, key=lambda h: -h.score)
        near = [h for h in ranked if h.score > ranked[0].score - self.margin]
        plain = {h.sensor for h in near if h.kind != SEVERAL}
        return [h for h in near if h.kind != SEVERAL or h.sensor not in plain]

    @property
    def margin(self) -> float:
        """Δ"""
        rivals = max(len(self.change.reference.names) - 1, 1)
        return float(ndtri(WRONG_SENSOR / rivals)) ** 2

    def explained(self, best: ParityHypothesis) -> bool:
        """Whether the best hypothesis leaves noise only."""
        remaining = len(self.seen) - best.basis.shape[1]
        return remaining < 1 or self.p_value(self.chi2 - best.ratio, remaining) > WRONG_SENSOR

    def candidate(self, h: ParityHypothesis) -> Candidate:
        """A hypothesis with its amplitude."""
        inverse = np.linalg.pinv(h.whitened, rcond=UNSEEN)
        return Candidate(
            sensor=self.change.reference.names[h.sensor],
            kind=h.kind,
            amplitude=tuple((inverse @ self.seen).tolist()),
            sigma=tuple(np.sqrt((inverse**2).sum(axis=1)).tolist()),
            ratio=h.ratio,
            p_value=h.p_value,
        )

    def sensor(self, index: int, false_alarm: float, isolated: list[ParityHypothesis]) -> SensorParity:
        """Changes of one sensor that the recording shows, and those that it could have shown."""
        reference = self.change.reference
        hypotheses = {h.kind: h for h in self.all if h.sensor == index}
        bias, scale, axis = (self.sight(hypotheses[kind], false_alarm, isolated) for kind in (BIAS, SCALE, AXIS))
        return SensorParity(reference.names[index], float(reference.visible[index]), bias, scale, axis)

    def sight(self, h: ParityHypothesis, false_alarm: float, isolated: list[ParityHypothesis]) -> Sight:
        """Estimate and limits of one kind of change of one sensor, beside the change of an isolated one."""
        nuisance = self.nuisance_basis(h, isolated)
        whitened = h.whitened - nuisance @ (nuisance.T @ h.whitened)
        sizes = np.linalg.svd(whitened, compute_uv=False)
        if sizes[-1] <= UNSEEN * self.plain(h):
            return Sight(None, None, None, None)
        inverse = np.linalg.pinv(whitened)
        covariance = inverse @ inverse.T
        sigma = float(1 / sizes[-1])
        detectable = sigma * self.wanted(whitened.shape[1], false_alarm)
        isolable = self.rivals(h, false_alarm).least_size(h.whitened, h.sensor)
        return Sight(
            change=tuple((inverse @ self.seen).tolist()),
            covariance=tuple(map(tuple, covariance.tolist())),
            detectable=float(detectable),
            isolable=None if isolable is None else max(isolable, float(detectable)),
        )

    def nuisance_basis(self, h: ParityHypothesis, isolated: list[ParityHypothesis]) -> Array:
        """(q, r) orthonormal, dimensionless: the isolated sensor's change beside a hypothesis, less its own."""
        if not isolated or any(h is hypothesis for hypothesis in isolated):
            return np.empty((len(self.seen), 0))
        best = isolated[0]
        if (h.sensor, best.kind) != (best.sensor, SEVERAL):
            return best.basis
        rest = [o.whitened for o in self._single if o.sensor == h.sensor and o.kind != h.kind]
        U, sizes, _ = np.linalg.svd(np.hstack(rest), full_matrices=False)
        return np.asarray(U[:, sizes > UNSEEN * sizes[0]])

    def plain(self, h: ParityHypothesis) -> float:
        """Size of the sensor's largest signature, any kind scaled to the size of the applied vector."""
        combined = [o for o in self.all if o.sensor == h.sensor and o.kind == SEVERAL]
        return float(np.linalg.svd(combined[0].whitened, compute_uv=False)[0])

    def rivals(self, h: ParityHypothesis, false_alarm: float) -> Rivals:
        """The hypotheses that a change of the kind of ``h`` must be distinguished from."""
        bases = np.zeros((len(self.all), len(self.seen), 4))
        for basis, tried in zip(bases, self.all, strict=True):
            basis[:, : tried.basis.shape[1]] = tried.basis
        return Rivals(
            bases=bases,
            count=np.array([tried.basis.shape[1] for tried in self.all]),
            sensor=np.array([tried.sensor for tried in self.all]),
            margin=self.margin,
            threshold=self.threshold(h.whitened.shape[1], false_alarm),
            dof=self.dof,
            lost=1.0 - POWER - WRONG_SENSOR,
        )

    def threshold(self, k: int, false_alarm: float) -> float:
        """Sigmas from which a change of k numbers is detected."""
        return float(np.sqrt(critical_chi2(false_alarm / 2 / len(self.all), k, self.dof)))

    def wanted(self, k: int, false_alarm: float) -> float:
        """Sigmas of a change of k numbers that are detected with the power."""
        threshold = self.threshold(k, false_alarm)
        return threshold + float(ndtri(POWER)) * shortfall(threshold, self.dof)


def tail(ratio: float, k: int, dof: float) -> tuple[float, float]:
    """Probability of a ratio of k numbers by chance, noise known to ``dof``, and −2 ln of it for certain noise."""
    return float(p_value(ratio, k, dof)), -2.0 * float(log_tail(np.maximum(np.array(ratio), np.finfo(float).tiny), k))
