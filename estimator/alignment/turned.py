"""What single accelerometers do while the table turns: lever arms, what else would look like them, how sure that is.

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
from estimator.least_squares import Fit, least_squares
from estimator.session import Array
from estimator.significance import p_value

RIVALS = ("vibration", "wobble", "delay or rate")
"""In the order of `rival_columns`."""


@dataclass(frozen=True, eq=False)
class Weighed:
    """One sensor's pieces in standard errors. N pieces."""

    values: Array
    """(N,)."""
    root: Array
    """(N, N) lower triangular, m/s²; what divides columns and values."""

    def fit(self, columns: Array) -> Fit:
        """The regression of the values on columns (N, q), in any unit."""
        return least_squares(solve_triangular(self.root, columns, lower=True), self.values)


@dataclass(frozen=True, eq=False)
class Felt:
    """What the turns do to one accelerometer."""

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
    """By how much χ² drops with the lever arm, with each rival instead, and with all rivals beside it (``beyond``), and
    for how many columns."""

    def p_value(self, model: str, excess: float = 1.0) -> float:
        """Probability of such a drop where there is none; ``excess``: by which the noise is larger than reckoned."""
        chi2, columns = self.drop[model]
        if columns == 0 or self.freedom <= 0:
            return 1.0
        return float(p_value(chi2 / excess, columns, self.freedom))

    def worth(self, model: str, pieces: int) -> float:
        """Drop of χ² less the price of the columns (BIC), twice the natural logarithm of the evidence."""
        chi2, columns = self.drop[model]
        return chi2 - columns * float(np.log(pieces))


def rival_columns(found: Pieces) -> dict[str, Array]:
    """(N, q) of every rival, each in units of its own."""
    turns = found.turns
    return {
        "vibration": np.column_stack([turns, found.levers[:, 0]]),
        "wobble": np.column_stack([turns[:, None] * found.level[:, 1:], found.twice]),
        "delay or rate": np.column_stack([found.bent, found.rate]),
    }


def weighed(found: Pieces, i: int, lean: float, ratio: float = 1.0) -> Weighed:
    """Sensor i's pieces in standard errors.

    Parameters
    ----------
    lean : one sigma of what the axis' lean adds, m/s² (horizontal share of the axis · g · wobble).
    ratio : variance of a piece of a turn over that at rest.
    """
    white = found.density[i] / found.time * np.where(found.turn >= 0, ratio, 1.0)
    _, p, q = least_squares(found.level, found.values[:, i]).value
    V = np.diag(white + found.bend**2 * (p**2 + q**2))
    for number in range(found.stop.max() + 1):
        V[np.ix_(found.stop == number, found.stop == number)] += lean**2
    for number in range(found.turn.max() + 1):
        own = np.flatnonzero(found.turn == number)
        V[np.ix_(own, own)] += lean**2 * found.level[own, 1:] @ found.level[own, 1:].T
    root = np.linalg.cholesky(V)
    return Weighed(solve_triangular(root, found.values[:, i], lower=True), root)


def felt(found: Pieces, i: int, axis: Array, lean: float) -> Felt | None:
    """What the turns do to accelerometer i with input axis (3,); None where the axis is upright.

    lean : one sigma of gravity's part across the axis from stop to stop, m/s²: g · wobble.
    """
    share = float(np.hypot(*axis[:2]))
    if share < UPRIGHT:
        return None
    rivals = rival_columns(found)
    base, lever = found.level, np.column_stack([found.level, found.levers])
    every = np.column_stack([lever, *rivals.values()])
    ratio, freedom = _noise_ratio(found, i, share * lean, every, lever)
    own = weighed(found, i, share * lean, ratio)
    without, with_lever, whole = own.fit(base), own.fit(lever), own.fit(every)
    drop = {"lever arm": drop_of(without, with_lever)}
    drop["beyond"] = drop_of(with_lever, whole)
    for name, columns in rivals.items():
        instead = own.fit(np.column_stack([base, columns]))
        both = own.fit(np.column_stack([lever, columns]))
        drop[name] = drop_of(without, instead)
        drop[f"lever arm beside {name}"] = drop_of(instead, both)
    excess = max(float(with_lever.chi2) / max(with_lever.freedom, 1), 1.0)
    return Felt(i, with_lever.value[3:], with_lever.covariance[3:, 3:], ratio, freedom, excess, drop)


def drop_of(less: Fit, more: Fit) -> tuple[float, int]:
    """By how much χ² drops with further columns, and how many of them count."""
    return float(less.chi2 - more.chi2), more.rank - less.rank


def _noise_ratio(found: Pieces, i: int, lean: float, every: Array, lever: Array) -> tuple[float, float]:
    """Variance of sensor i's turning pieces over that at rest, 1 at least, and its degrees of freedom.

    What the columns ``every`` (N, q) leave says it, or, where pieces are few, what ``lever`` (N, 5) leaves.
    """
    moving = found.turn >= 0
    columns = every if moving.sum() >= 2 * every.shape[1] else lever
    own = weighed(found, i, lean)
    scaled = solve_triangular(own.root, columns, lower=True)
    fit = least_squares(scaled, own.values)
    left = (own.values - scaled @ fit.value)[moving]
    freedom = float(moving.sum() - fit.rank)
    if freedom < 1:
        return 1.0, 0.0
    same = found.turn[moving][1:] == found.turn[moving][:-1]
    square = float(left @ left)
    related = float((left[1:] * left[:-1])[same].sum()) / square if square else 0.0
    lasting = (1 + related) / (1 - related) if 0 < related < 1 else 1.0
    return max(square / freedom * lasting, 1.0), freedom / lasting
