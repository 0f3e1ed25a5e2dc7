"""The course without a formula that sensors share: the matrix of their waves, of rank one.

Theory
------
Sensor i shows c_ij of wave j, standard errors; T (n, m·w) are the traces of all waves on all sensors. One course with a
size each is c = β ⊗ v, with v ~ N(0, 1) as the walk has its waves and β ~ N(0, g). With G = T'T and b = T'z,

    L(β, v) = b'c − ½ c'Gc − ½|v|² − ½|β|²/g

is largest by turns in β and in v, either of which is a regression. With J = [1 ⊗ v, β ⊗ 1] and D of the priors the
evidence is that of Laplace, ln B = L − ½ ln|1 + D½ J'GJ D½| (MacKay 2003, 27). What of it is not that of β given v, the
choice of v, is charged as that of one among

    n = exp(½|v|² + ½ ln|1 + D½ J'GJ D½| − ½ ln|1 + g·(1 ⊗ v)'G(1 ⊗ v)|)

shapes.
"""

from dataclasses import dataclass

import numpy as np

from estimator.session import Array

SIZES = 4.0 ** np.arange(1, 9, 2)
"""g: mean square sizes that are tried, the likeliest of which is taken."""

TURNS = 12
"""Most alternations between the two regressions; two courses that differ separate by a factor each time."""

MOST = 30.0
"""ln n at most: beyond it no course is believed, and n would no longer be a number."""

RIDGE = 0.1
"""Prior information of a wave on a sensor where the turns start."""


@dataclass(frozen=True, eq=False)
class FreeCourse:
    """The likeliest course. m sensors, w waves."""

    waves: Array
    """(w,) v."""
    sizes: Array
    """(m,) β, standard errors."""
    log_evidence: float
    """ln B, against no course."""
    tried: float
    """n, the number of shapes that v counts as chosen from."""

    @classmethod
    def of_products(cls, gram: Array, along: Array) -> "FreeCourse":
        """The course of the products ``gram`` (m, w, m, w) and ``along`` (m, w) of every sensor's waves.

        All sizes g are climbed at once, one row of each array.
        """
        (m, w), g = along.shape, SIZES[:, None]
        apart = np.linalg.solve(gram.reshape(m * w, m * w) + RIDGE * np.eye(m * w), along.ravel()).reshape(m, w)
        left, size, right = np.linalg.svd(apart, full_matrices=False)
        v = np.tile(right[0] * np.sqrt(w), (len(g), 1))
        beta = np.tile(left[:, 0] * size[0] / np.sqrt(w), (len(g), 1))
        for _ in range(TURNS):
            beta = np.linalg.solve(of_sizes(gram, v) + np.eye(m) / g[..., None], (v @ along.T)[..., None])[..., 0]
            v = np.linalg.solve(of_waves(gram, beta) + np.eye(w), (beta @ along)[..., None])[..., 0]
        sizes, waves, both = of_sizes(gram, v), of_waves(gram, beta), of_both(gram, v, beta)
        fits = np.einsum("gi,ga,ia->g", beta, v, along) - 0.5 * np.einsum("gi,gij,gj->g", beta, sizes, beta)
        root = np.sqrt(g)[..., None]
        joint = np.block([[root**2 * sizes, root * both], [root * both.swapaxes(1, 2), waves]])
        whole = np.linalg.slogdet(np.eye(m + w) + joint)[1]
        given = np.linalg.slogdet(np.eye(m) + root**2 * sizes)[1]
        prior = 0.5 * (v**2).sum(axis=1)
        value = fits - prior - 0.5 * (beta**2 / g).sum(axis=1) - 0.5 * whole
        best = int(np.argmax(value))
        tried = float(np.exp(min(prior[best] + 0.5 * (whole - given)[best], MOST)))
        return cls(v[best], beta[best], float(value[best]), tried)


def of_sizes(gram: Array, v: Array) -> Array:
    """(G, m, m) information of the sizes given the waves v (G, w), of ``gram`` (m, w, m, w)."""
    return np.asarray((np.tensordot(v, gram, (1, 1)) @ v[:, None, :, None])[..., 0])


def of_waves(gram: Array, beta: Array) -> Array:
    """(G, w, w) information of the waves given the sizes β (G, m)."""
    return np.asarray((np.tensordot(beta, gram, (1, 0)).swapaxes(2, 3) @ beta[:, None, :, None])[..., 0])


def of_both(gram: Array, v: Array, beta: Array) -> Array:
    """(G, m, w) information that sizes and waves have in common."""
    return np.asarray((np.tensordot(v, gram, (1, 1)).swapaxes(2, 3) @ beta[:, None, :, None])[..., 0])
