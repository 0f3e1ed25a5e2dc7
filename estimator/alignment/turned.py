"""Response of single accelerometers to the turns of the table: lever arms, rival explanations, and their certainty.

Of every accelerometer the pieces of stops and turns are regressed on k + p·cos θ + q·sin θ − c·⟨ω²⟩ + d·⟨α⟩ by
generalised least squares. Noise: white, of the density found at the stops; the axis' lean, drawn anew at every stop and
in every turn; the angle, where the rate bends within rows. While the table turns the sensors may be noisier: the
scatter of the turns' own pieces says by how much, neighbours that resemble one another included. Every test of turns is
an F test on their degrees of freedom.

Rivals
------
What else acts while the table turns has columns of its own, and each is fitted in the lever arm's place:

vibration    1 and ω²       a bearing's vibration, rectified: at rest none, and how it grows with the rate is not known
wobble       cos θ, sin θ while turning, cos 2θ, sin 2θ      the axis leans otherwise, or goes round, while it turns
delay, rate  ω·cos θ, ω·sin θ, ω       readings later than the gyros'; a coupling with the rate itself

The centrifugal part of a lever arm alone is what vibration does too; starting and stopping (α) tell them apart.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular

from estimator.alignment.levers import UPRIGHT
from estimator.alignment.pieces import Pieces
from estimator.least_squares import LeastSquaresFit, least_squares
from estimator.session import Array
from estimator.significance import p_value

RIVALS = ("vibration", "wobble", "delay or rate")
"""Names of the rivals, in the order of `rival_columns`."""


@dataclass(frozen=True, eq=False)
class Whitened:
    """One sensor's pieces in standard errors. N pieces."""

    values: Array
    """(N,)."""
    root: Array
    """(N, N) lower triangular, m/s²; what divides columns and values."""

    def fit(self, columns: Array) -> LeastSquaresFit:
        """The regression of the values on columns (N, q), in any unit."""
        return least_squares(solve_triangular(self.root, columns, lower=True), self.values)


@dataclass(frozen=True, eq=False)
class LeverResponse:
    """Response of one accelerometer to the turns."""

    sensor: int
    """Place among the accelerometers."""
    lever: Array
    """(2,) c and d, m."""
    covariance: Array
    """(2, 2) m²."""
    noise_ratio: float
    """Variance of a piece while the table turns over that at rest, 1 at least."""
    freedom: float
    """Degrees of freedom of the noise while turning."""
    excess: float
    """χ² of a degree of freedom that the lever arm leaves, 1 at least."""
    drop: dict[str, tuple[float, int]]
    """Drop of χ² with the lever arm, with each rival in its place, and with all rivals beside it (``beyond``), and the
    number of columns of each.
    """

    def p_value(self, model: str, excess: float = 1.0) -> float:
        """Probability of such a drop where there is none; ``excess``: by which the noise is larger than assumed."""
        chi2, columns = self.drop[model]
        if columns == 0 or self.freedom <= 0:
            return 1.0
        return float(p_value(chi2 / excess, columns, self.freedom))

    def worth(self, model: str, pieces: int) -> float:
        """Drop of χ² less the price of the columns (BIC), twice the natural logarithm of the evidence."""
        chi2, columns = self.drop[model]
        return chi2 - columns * float(np.log(pieces))


def rival_columns(pieces: Pieces) -> dict[str, Array]:
    """(N, q) columns of every rival, each in units of its own."""
    turns = pieces.turns
    return {
        "vibration": np.column_stack([turns, pieces.levers[:, 0]]),
        "wobble": np.column_stack([turns[:, None] * pieces.level[:, 1:], pieces.twice]),
        "delay or rate": np.column_stack([pieces.bent, pieces.rate]),
    }


def whitened(pieces: Pieces, i: int, lean: float, ratio: float = 1.0) -> Whitened:
    """Sensor i's pieces in standard errors.

    Parameters
    ----------
    lean : one sigma of what the axis' lean adds, m/s² (horizontal share of the axis · g · wobble).
    ratio : variance of a piece of a turn over that at rest.
    """
    white = pieces.density[i] / pieces.time * np.where(pieces.turn >= 0, ratio, 1.0)
    _, p, q = least_squares(pieces.level, pieces.values[:, i]).value
    V = np.diag(white + pieces.bend**2 * (p**2 + q**2))
    for number in range(pieces.stop.max() + 1):
        V[np.ix_(pieces.stop == number, pieces.stop == number)] += lean**2
    for number in range(pieces.turn.max() + 1):
        members = np.flatnonzero(pieces.turn == number)
        V[np.ix_(members, members)] += lean**2 * pieces.level[members, 1:] @ pieces.level[members, 1:].T
    root = np.linalg.cholesky(V)
    return Whitened(solve_triangular(root, pieces.values[:, i], lower=True), root)


def lever_response(pieces: Pieces, i: int, axis: Array, lean: float) -> LeverResponse | None:
    """Fits the response of accelerometer i, with input axis (3,), to the turns; None where the axis is upright.

    lean : one sigma of gravity's part across the axis from stop to stop, m/s²: g · wobble.
    """
    share = float(np.hypot(*axis[:2]))
    if share < UPRIGHT:
        return None
    rivals = rival_columns(pieces)
    base, lever = pieces.level, np.column_stack([pieces.level, pieces.levers])
    every = np.column_stack([lever, *rivals.values()])
    ratio, freedom = _noise_ratio(pieces, i, share * lean, every, lever)
    weighted = whitened(pieces, i, share * lean, ratio)
    without, with_lever, whole = weighted.fit(base), weighted.fit(lever), weighted.fit(every)
    drop = {"lever arm": drop_of(without, with_lever)}
    drop["beyond"] = drop_of(with_lever, whole)
    for name, columns in rivals.items():
        with_rival = weighted.fit(np.column_stack([base, columns]))
        with_rival_and_lever = weighted.fit(np.column_stack([lever, columns]))
        drop[name] = drop_of(without, with_rival)
        drop[f"lever arm beside {name}"] = drop_of(with_rival, with_rival_and_lever)
    excess = max(float(with_lever.chi2) / max(with_lever.freedom, 1), 1.0)
    return LeverResponse(i, with_lever.value[3:], with_lever.covariance[3:, 3:], ratio, freedom, excess, drop)


def drop_of(less: LeastSquaresFit, more: LeastSquaresFit) -> tuple[float, int]:
    """Drop of χ² with further columns, and the number of them that count."""
    return float(less.chi2 - more.chi2), more.rank - less.rank


def _noise_ratio(pieces: Pieces, i: int, lean: float, every: Array, lever: Array) -> tuple[float, float]:
    """Variance of sensor i's turning pieces over that at rest, 1 at least, and its degrees of freedom.

    What the columns ``every`` (N, q) leave says it, or, where pieces are few, what ``lever`` (N, 5) leaves.
    """
    moving = pieces.turn >= 0
    columns = every if moving.sum() >= 2 * every.shape[1] else lever
    weighted = whitened(pieces, i, lean)
    scaled = solve_triangular(weighted.root, columns, lower=True)
    fit = least_squares(scaled, weighted.values)
    residual = (weighted.values - scaled @ fit.value)[moving]
    freedom = float(moving.sum() - fit.rank)
    if freedom < 1:
        return 1.0, 0.0
    same = pieces.turn[moving][1:] == pieces.turn[moving][:-1]
    square = float(residual @ residual)
    related = float((residual[1:] * residual[:-1])[same].sum()) / square if square else 0.0
    inflation = (1 + related) / (1 - related) if 0 < related < 1 else 1.0
    return max(square / freedom * inflation, 1.0), freedom / inflation
