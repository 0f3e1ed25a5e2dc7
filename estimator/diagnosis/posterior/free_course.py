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
        """The course of the products ``gram`` (m, w, m, w) and ``along`` (m, w) of every sensor's waves."""
        m, w = along.shape
        apart = np.linalg.solve(gram.reshape(m * w, m * w) + RIDGE * np.eye(m * w), along.ravel()).reshape(m, w)
        left, size, right = np.linalg.svd(apart, full_matrices=False)
        start = right[0] * np.sqrt(w), left[:, 0] * size[0] / np.sqrt(w)
        return max((cls._at(gram, along, g, start) for g in SIZES), key=_evidence)

    @classmethod
    def _at(cls, gram: Array, along: Array, g: float, start: tuple[Array, Array]) -> "FreeCourse":
        """The likeliest at one g; ``gram`` (m, w, m, w) and ``along`` (m, w)."""
        (v, beta), (m, w) = start, along.shape
        for _ in range(TURNS):
            beta = np.linalg.solve(of_sizes(gram, v) + np.eye(m) / g, along @ v)
            v = np.linalg.solve(of_waves(gram, beta) + np.eye(w), beta @ along)
        c = np.outer(beta, v)
        explained = float((along * c).sum() - 0.5 * (c * np.tensordot(gram, c, 2)).sum())
        both = np.einsum("ijkl,j,k->il", gram, v, beta)
        joint = np.block([[g * of_sizes(gram, v), np.sqrt(g) * both], [np.sqrt(g) * both.T, of_waves(gram, beta)]])
        whole = float(np.linalg.slogdet(np.eye(m + w) + joint)[1])
        given = float(np.linalg.slogdet(np.eye(m) + g * of_sizes(gram, v))[1])
        prior = 0.5 * float(v @ v)
        value = explained - prior - 0.5 * float(beta @ beta) / g - 0.5 * whole
        return cls(v, beta, value, float(np.exp(min(prior + 0.5 * (whole - given), MOST))))


def of_sizes(gram: Array, v: Array) -> Array:
    """(m, m) information of the sizes given the waves v (w,), of ``gram`` (m, w, m, w)."""
    return np.asarray(np.tensordot(np.tensordot(gram, v, (3, 0)), v, (1, 0)))


def of_waves(gram: Array, beta: Array) -> Array:
    """(w, w) information of the waves given the sizes β (m,)."""
    return np.asarray(np.tensordot(beta, np.tensordot(gram, beta, (2, 0)), (0, 0)))


def _evidence(course: FreeCourse) -> float:
    return course.log_evidence
