"""Inner products of whitened rows, part by part: all that a score needs of a signature.

Theory
------
Rows fall into parts: the readings of each sensor, the priors, the change since the history. Let X be a signature's
trace, z the residuals and A the orthonormal basis of the findings' traces. The findings leave X̂ = X − A·c of it and
ẑ = z − A·a, with c = A'X and a = A'z over all rows. In every part, with its own G = X'X, b = X'z, C = A'X, D = A'A,

    X̂'X̂ = G − c'C − C'c + c'Dc,      X̂'ẑ = b − C'a − c'(A'ẑ)

and over all parts ΣG − c'c and Σb − c'a, since ΣC = c, ΣD = 1 and ΣA'ẑ = 0. G and b are the same in the whole search;
only C is taken anew, where all signatures of a kind are one product. The parts are worked out only of those signatures
of which somebody asks for them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array


def inner(residuals: WhitenedResiduals, first: Array, right: Array) -> Array:
    """(K, a, b) left'right of rows (n, a) and (n, b), any unit, in each of m + 2 parts: m sensors, priors, change."""
    R, m = residuals.baseline.residual.shape
    readings = first[: R * m].reshape(R, m, -1).transpose(1, 2, 0) @ right[: R * m].reshape(R, m, -1).transpose(1, 0, 2)
    rest = [first[rows].T @ right[rows] for rows in (slice(R * m, residuals.rows), slice(residuals.rows, None))]
    return np.concatenate([readings, np.stack(rest)])


@dataclass(frozen=True, eq=False)
class Nuisance:
    """Columns beside those of S traces, the same for many of them, which show in the last P rows only."""

    columns: Array
    """(m, P, w) standard errors per unit."""
    number: Array
    """(S,) int, which of the m each trace has."""

    @property
    def rows(self) -> int:
        """P."""
        return self.columns.shape[1]

    @property
    def width(self) -> int:
        """w."""
        return self.columns.shape[2]

    @property
    def each(self) -> Array:
        """(S, P, w) standard errors per unit: those of every trace."""
        return np.asarray(self.columns[self.number])

    def at(self, chosen: Array | Sequence[int]) -> "Nuisance":
        """The columns beside some of the traces, by number or (S,) bool."""
        return Nuisance(self.columns, self.number[chosen])


@dataclass(frozen=True, eq=False)
class Products:
    """Products of S traces of q amplitudes in K parts, in units of the squared standard error per unit amplitude."""

    square: Array
    """(K, S, q, q) X'X."""
    along: Array
    """(K, S, q) X'z."""

    @classmethod
    def of(cls, residuals: WhitenedResiduals, columns: Array) -> "Products":
        """The products of traces ``columns`` (S, n, q), standard errors per unit amplitude."""
        R, m = residuals.baseline.residual.shape
        S, n, q = columns.shape
        by_sensor = columns[:, : R * m].reshape(S, R, m, q)
        rest = [columns[:, rows] for rows in (slice(R * m, residuals.rows), slice(residuals.rows, None))]
        square = [
            np.einsum("srmp,srmq->mspq", by_sensor, by_sensor),
            *(np.einsum("snp,snq->spq", x, x)[None] for x in rest),
        ]
        rows = columns.swapaxes(0, 1).reshape(n, S * q)
        along = inner(residuals, residuals.z[:, None], rows).reshape(m + 2, S, q)
        return cls(np.concatenate(square), along)

    @cached_property
    def whole(self) -> tuple[Array, Array]:
        """(S, q, q) X'X and (S, q) X'z over all parts."""
        return self.square.sum(axis=0), self.along.sum(axis=0)

    @property
    def parts(self) -> "Products":
        """Themselves."""
        return self

    @classmethod
    def together(cls, parts: Sequence["Products"]) -> "Products":
        """Joins the products of several traces of equally many amplitudes."""
        return cls(*(np.concatenate(x, axis=1) for x in zip(*((p.square, p.along) for p in parts), strict=True)))

    def continued(self, change: Array, z: Array) -> "Products":
        """The products with further columns that show in the last part alone, where all columns are ``change`` (S, P, q
        + …), standard errors per unit, of P rows with the residuals ``z`` (P,).
        """
        K, S, q = self.along.shape
        square, along = np.zeros((K, S, *change.shape[2:] * 2)), np.zeros((K, S, change.shape[2]))
        square[:-1, :, :q, :q], along[:-1, :, :q] = self.square[:-1], self.along[:-1]
        square[-1], along[-1] = np.swapaxes(change, 1, 2) @ change, z @ change
        return Products(square, along)

    def at(self, chosen: Array | Sequence[int]) -> "Products":
        """The products of some of the traces, by number or (S,) bool."""
        return Products(self.square[:, chosen], self.along[:, chosen])


@dataclass(frozen=True, eq=False)
class Projected:
    """Residuals with the traces of earlier findings projected out. n rows, f directions, K parts."""

    residuals: WhitenedResiduals
    attributed: Array
    """(n, f) orthonormal traces of the findings."""
    z: Array
    """(n,) standard errors: what the findings leave."""

    @classmethod
    def of(cls, residuals: WhitenedResiduals, attributed: Array) -> "Projected":
        """``attributed`` (n, f) orthonormal traces of the findings, dimensionless."""
        return cls(residuals, attributed, residuals.z - attributed @ (attributed.T @ residuals.z))

    @cached_property
    def square(self) -> Array:
        """(K, f, f) dimensionless: A'A."""
        return inner(self.residuals, self.attributed, self.attributed)

    @cached_property
    def energy(self) -> Array:
        """(m,) energy that the findings leave of each sensor's readings, dimensionless."""
        m = len(self.residuals.baseline.unstated)
        return (self.z[: self.residuals.baseline.residual.size].reshape(-1, m) ** 2).sum(axis=0)

    @cached_property
    def freedom(self) -> Array:
        """(m,) degrees of freedom of that energy."""
        m = len(self.residuals.baseline.unstated)
        known = self.residuals.row_freedom[: self.residuals.baseline.residual.size].reshape(-1, m).sum(axis=0)
        return np.asarray(known - np.trace(self.square[:m], axis1=1, axis2=2))

    def shared(self, columns: Array, nuisance: Nuisance | None) -> Array:
        """(K, f, S, q + w) A'X of traces, ``columns`` (S, n, q), standard errors per unit."""
        A, (S, n, q) = self.attributed, columns.shape
        products = inner(self.residuals, A, columns.swapaxes(0, 1).reshape(n, S * q))
        products = products.reshape(len(products), A.shape[1], S, q)
        if nuisance is None:
            return products
        extended = np.zeros((*products.shape[:3], q + nuisance.width))
        extended[..., :q] = products
        extended[-1, ..., q:] = (A[n - nuisance.rows :].T @ nuisance.columns)[nuisance.number].swapaxes(0, 1)
        return extended

    @cached_property
    def explained(self) -> Array:
        """(f,) standard errors: A'z, the residuals along the findings."""
        return np.asarray(self.attributed.T @ self.residuals.z)

    @cached_property
    def rest(self) -> Array:
        """(K, f) standard errors: A'ẑ, in each part."""
        return inner(self.residuals, self.attributed, self.z[:, None])[..., 0]

    def __call__(
        self, products: Sequence[Products], columns: Sequence[Array], nuisances: Sequence[Nuisance | None] | None = None
    ) -> "RemainingProducts":
        """Products of traces after projection, from their ``columns`` (S, n, q) each, standard errors per unit."""
        each = [self.shared(x, b) for x, b in zip(columns, nuisances or [None] * len(columns), strict=True)]
        return RemainingProducts(self, tuple(products), np.concatenate(each, axis=2))


@dataclass(frozen=True, eq=False)
class RemainingProducts:
    """Products of S traces of q amplitudes with the findings projected out, worked out only as far as needed."""

    projected: Projected
    before: tuple[Products, ...]
    """Products before projection, each of some of the traces."""
    shared: Array
    """(K, f, S, q) standard errors per unit amplitude: C."""

    @cached_property
    def whole(self) -> tuple[Array, Array]:
        """(S, q, q) X̂'X̂ and (S, q) X̂'ẑ over all parts."""
        square, along = (np.concatenate(x) for x in zip(*(p.whole for p in self.before), strict=True))
        c = self.shared.sum(axis=0)
        across = c.transpose(1, 2, 0)
        return square - across @ np.swapaxes(across, 1, 2), along - across @ self.projected.explained

    @cached_property
    def parts(self) -> Products:
        """The products after projection in every part."""
        before = self.before[0] if len(self.before) == 1 else Products.together(self.before)
        if not self.shared.shape[1]:
            return before
        C, p = self.shared, self.projected
        c = C.sum(axis=0)
        half = C - 0.5 * (p.square @ c.reshape(len(c), -1)).reshape(C.shape)
        cross = c.transpose(1, 2, 0) @ half.swapaxes(1, 2)
        along = before.along - np.einsum("kfsq,f->ksq", C, p.explained) - np.einsum("fsq,kf->ksq", c, p.rest)
        return Products(before.square - cross - np.swapaxes(cross, -1, -2), along)

    def at(self, chosen: Array) -> "RemainingProducts":
        """The products of some of the traces, by rising number or (S,) bool."""
        ends = np.cumsum([0, *(p.along.shape[1] for p in self.before)])
        number = np.arange(ends[-1])[chosen]
        of = np.searchsorted(ends, number, side="right") - 1
        before = [self.before[k].at(number[of == k] - ends[k]) for k in np.unique(of)]
        return RemainingProducts(self.projected, tuple(before), self.shared[:, :, number])
