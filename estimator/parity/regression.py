"""Θ, the sensors' changes as parity sees them, with a covariance that holds whatever the colour of the noise.

Regression. p = Vᵀa of every block on z = Qᵀ(1, n/g), where Q (4, s) spans what the recording excites: the mean of
(1, n/g), and those directions of n that change. A recording at one orientation has s = 1.

Noise. Sensors are noisy independently of one another, each in its own way. Each group of `blocks` has its part D_k in
the error of Θ, known from its residuals (cluster-robust, Bell and McCaffrey 2002); brought back to the sensors by V,
the parts give each sensor an (s, s) covariance Ω_i: with P = V·Vᵀ, E[Σ D_ki D_kiᵀ] = Σ_j P_ij²·Ω_j. Where sensors
cannot be distinguished in parity (P∘P singular) it does not matter how noise is shared out. Few groups make Ω
uncertain, so each is drawn towards their mean. Noise so slow that neighbouring groups still agree makes this too small:
it is enlarged by (1 + ρ)/(1 − ρ), ρ the correlation of neighbouring groups of all sensors together.

Reference. Its error looks exactly like a change of the sensors: its covariance goes through the signatures. So does
the repeatability of the zero from one use to the next, where the file states it.
"""

from dataclasses import dataclass, replace

import numpy as np

from estimator.arrays import eigh
from estimator.errors import ScheduleError, problem_at
from estimator.message import say_count
from estimator.parity.blocks import FEWEST_GROUPS, BlockSelection
from estimator.parity.reference import ParityReference
from estimator.session import Array

EXCITED = 0.02
"""g (of the largest vector); a direction of n that changes less than this, root mean square, is not regressed on."""

LEAST_FREEDOM = 0.05
"""Share of a direction that must lie outside a group; below it the group's residuals say nothing of it."""

SLOWEST = 0.9
"""Largest correlation of neighbouring groups that is believed."""

LEAST_DOF = (4.0, 2.0, 16.0)
"""Least degrees of freedom of the noise, however slow it is: d times the first and the second number, but at most the
third; more sensors determine it better.
"""

APART = 0.01
"""Relative eigenvalue of P∘P below which sensors are not distinguished; it matters as much as its square root."""

DRAWN = 6.0
"""Groups' worth of belief that all sensors are equally noisy."""


@dataclass(frozen=True, eq=False)
class ParityChange:
    """The sensors' change since the reference, in parity space. d = m − 3, s excited directions, q = s·d."""

    reference: ParityReference
    norm: float
    """g, m/s²; for gyros the root mean square rate."""
    excited: Array
    """(4, s) Q, orthonormal columns, dimensionless."""
    theta: Array
    """(s, d) Θ, m/s² (rad/s)."""
    noise: Array
    """(q, q) covariance of θ.ravel() from the recording's noise, (m/s²)² ((rad/s)²)."""
    known: Array
    """(q, q) covariance of θ.ravel() from reference calibration and stated repeatability, (m/s²)² ((rad/s)²)."""
    motion: Array
    """(q, q) covariance of θ.ravel() from the effects of motion on sound sensors (`freed`), (m/s²)² ((rad/s)²); zero
    where nothing was allowed for.
    """
    dof: float
    """Groups less what was fitted to each sensor."""
    residual_rms: float
    """Root mean square of the parity vector's elements after the fit, block means, m/s² (rad/s)."""
    quadratic: Array
    """(m, s) regression of a² on z: the trace of a change of c, (m/s²)²."""
    course: Array
    """(groups, m) means over the groups of V·p, m/s² (rad/s)."""
    course_sigma: Array
    """(m,) scatter of the groups' means about the fit, m/s² (rad/s)."""

    @property
    def covariance(self) -> Array:
        """(q, q) covariance of θ.ravel(), (m/s²)² ((rad/s)²)."""
        return self.noise + self.known + self.motion

    @property
    def complete(self) -> bool:
        """Whether bias and scale can be distinguished: all four of (1, n) are excited."""
        return self.excited.shape[1] == 4

    def signature(self, sensor: int, rows: Array) -> Array:
        """(q, k) signature of a change of one sensor, m/s² (rad/s) per unit of it, from k columns of its row of ΔA,
        rows (4, k).
        """
        z = self.excited.T @ rows
        return np.einsum("sk,d->sdk", z, self.reference.parity[sensor]).reshape(-1, rows.shape[1])


def regress(
    selection: BlockSelection, reference: ParityReference, norm: float | None, *, spent: float = 0.0
) -> ParityChange:
    """Θ and its covariance from the used blocks.

    Parameters
    ----------
    norm : g; None takes the root mean square of the measured vector (gyros).
    spent : numbers that were fitted to the blocks before, beside Θ.

    Raises
    ------
    ScheduleError : too few independent stretches to know the noise.
    """
    groups = selection.groups
    if groups < FEWEST_GROUPS:
        held = say_count("{n} separate stretch", "{n} separate stretches", groups)
        raise ScheduleError(
            [
                problem_at(
                    "table", "{groups}; {fewest_groups} or more are needed", groups=held, fewest_groups=FEWEST_GROUPS
                )
            ]
        )
    n = reference.vector(selection.blocks.mean)
    w = selection.blocks.samples / selection.blocks.samples.mean()
    size = norm or max(float(np.sqrt((n**2).sum(axis=1).mean())), np.finfo(float).tiny)
    x = np.column_stack([np.ones(len(n)), n / size])
    Q = excited(x, w, selection, groups)
    z, p = x @ Q, selection.blocks.mean @ reference.parity
    G = (w[:, None] * z).T @ z
    theta = np.linalg.solve(G, (w[:, None] * z).T @ p)
    residual = p - z @ theta
    a2 = np.linalg.solve(G, (w[:, None] * z).T @ (n @ reference.axes.T) ** 2).T
    rho = neighbours(z, w, residual, selection, G)
    slow = (1 + rho) / (1 - rho)
    omega = (
        slow * fitted_too_well(spent, p) * sensor_noise(scores(z, w, residual, selection, G), reference.parity, groups)
    )
    noise = np.einsum("mst,md,me->sdte", omega, reference.parity, reference.parity)
    q = theta.size
    course, about = (group_means(w, part, selection) @ reference.parity.T for part in (p, residual))
    change = ParityChange(
        reference=reference,
        norm=size,
        excited=Q,
        theta=theta,
        noise=noise.reshape(q, q),
        known=np.zeros((q, q)),
        motion=np.zeros((q, q)),
        dof=max(groups / slow - Q.shape[1], min(LEAST_DOF[0] + LEAST_DOF[1] * p.shape[1], LEAST_DOF[2])),
        residual_rms=float(np.sqrt((w[:, None] * residual**2).mean())),
        quadratic=a2,
        course=course,
        course_sigma=about.std(axis=0),
    )
    return replace(change, known=known_covariance(change))


def fitted_too_well(spent: float, p: Array) -> float:
    """Factor by which residuals of p (B, d) understate a variance from which ``spent`` numbers were fitted."""
    return 1.0 / (1.0 - min(spent / p.size, 0.5))


def excited(x: Array, w: Array, selection: BlockSelection, groups: int) -> Array:
    """(4, s) orthonormal: the mean of x, and the directions of n that change, in several groups.

    x (B, 4) and the weights w (B,) of the blocks are dimensionless.
    """
    mean = (w[:, None] * x).sum(axis=0) / w.sum()
    deviations = x[:, 1:] - mean[1:]
    scatter = np.zeros((groups, 3, 3))
    np.add.at(scatter, selection.group, w[:, None, None] * deviations[:, :, None] * deviations[:, None, :])
    moments = scatter.sum(axis=0)
    vectors = eigh(moments)[1]
    along = np.einsum("ik,gij,jk->gk", vectors, scatter, vectors)
    spread = (along.sum(axis=0) - along.max(axis=0)) / w.sum()
    seen = np.zeros((4, int((spread > EXCITED**2).sum())))
    seen[1:] = vectors[:, spread > EXCITED**2]
    return np.linalg.qr(np.column_stack([mean, seen]))[0]


def scores(z: Array, w: Array, residual: Array, selection: BlockSelection, G: Array) -> Array:
    """(groups, s, d) each group's part in the error of Θ, m/s² (rad/s): residuals freed of what the fit took (CR2).

    Parameters
    ----------
    z : (B, s) regressors, dimensionless.
    w : (B,) weights of the blocks, dimensionless.
    residual : (B, d) p − z·Θ, m/s² (rad/s).
    G : (s, s) zᵀ·diag(w)·z, dimensionless.
    """
    groups, s = selection.groups, z.shape[1]
    root = np.linalg.cholesky(G)
    white = np.linalg.solve(root, z.T).T
    leverage = np.zeros((groups, s, s))
    score = np.zeros((groups, s, residual.shape[1]))
    np.add.at(leverage, selection.group, w[:, None, None] * white[:, :, None] * white[:, None, :])
    np.add.at(score, selection.group, w[:, None, None] * white[:, :, None] * residual[:, None, :])
    values, vectors = eigh(np.eye(s) - leverage)
    freed = (vectors / np.sqrt(np.maximum(values, LEAST_FREEDOM))[:, None, :]) @ np.swapaxes(vectors, 1, 2)
    return np.linalg.solve(root.T, freed @ score)


def group_means(w: Array, rows: Array, selection: BlockSelection) -> Array:
    """(groups, k) means of rows (B, k), unit of the rows; weights w (B,) of the blocks, dimensionless."""
    total = np.zeros((selection.groups, rows.shape[1]))
    np.add.at(total, selection.group, w[:, None] * rows)
    return total / np.bincount(selection.group, weights=w)[:, None]


def neighbours(z: Array, w: Array, residual: Array, selection: BlockSelection, G: Array) -> float:
    """Correlation of the residuals of neighbouring groups, all sensors together, without what the fit adds to it.

    The fit alone makes neighbours differ: by the hat matrix of the groups' means, and by 2ρ/groups as any correlation.
    z (B, s), w (B,), residual (B, d) m/s² (rad/s) and G (s, s): see `scores`.
    """
    size = np.sqrt(np.bincount(selection.group, weights=w))[:, None]
    mean = group_means(w, residual, selection) * size
    fitted = group_means(w, z, selection) * size
    hat = fitted @ np.linalg.solve(G, fitted.T)
    pull = -float(np.trace(hat, offset=1)) / (len(hat) - float(np.trace(hat)))
    correlation = float((mean[1:] * mean[:-1]).sum() / max((mean**2).sum(), np.finfo(float).tiny))
    return float(np.clip(correlation - pull + 2 * max(correlation - pull, 0.0) / selection.groups, 0.0, SLOWEST))


def sensor_noise(moved: Array, V: Array, groups: int) -> Array:
    """(m, s, s) covariance of Θ from each sensor's noise, (m/s²)² ((rad/s)²).

    moved (groups, s, d), m/s² (rad/s), from `scores`; V (m, d), dimensionless.
    """
    D = moved @ V.T
    observed = np.einsum("gsm,gtm->mst", D, D)
    shares = np.linalg.pinv((V @ V.T) ** 2, rcond=APART, hermitian=True)
    omega = np.einsum("mj,jst->mst", shares, observed)
    values, vectors = eigh(omega)
    omega = np.einsum("msk,mk,mtk->mst", vectors, np.maximum(values, 0.0), vectors)
    mean = observed.sum(axis=0) / (V**2).sum()
    weight = (groups * (V**2).sum(axis=1))[:, None, None]
    return (weight * omega + DRAWN * mean) / (weight + DRAWN)


def known_covariance(change: ParityChange) -> Array:
    """(q, q) the reference's error and the zero's repeatability as they show in Θ, (m/s²)² ((rad/s)²)."""
    reference = change.reference
    shown = reference.signatures(change.norm)
    columns = [change.signature(i, rows) for i, rows in enumerate(shown)]
    for i, column in enumerate(columns):
        column[:, 2] = np.outer(change.quadratic[i], reference.parity[i]).ravel()
    J = np.hstack(columns)
    zero = J[:, 1::5] * reference.repeatability
    return J @ reference.covariance @ J.T + zero @ zero.T
