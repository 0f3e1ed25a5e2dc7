"""Small array helpers that several rooms share."""

from typing import TYPE_CHECKING

import numpy as np

from estimator.on_demand import function_on_demand
from estimator.session import Array

if TYPE_CHECKING:
    from scipy.linalg import eigh as patient_eigh
else:
    patient_eigh = function_on_demand("scipy.linalg", "eigh")


def unit(vector: Array) -> Array:
    """Vectors (n, 3), leading axes free, of any unit scaled to length one: the same shape, dimensionless."""
    return vector / np.linalg.norm(vector, axis=-1, keepdims=True)


def tangents(axis: Array) -> Array:
    """Two unit vectors orthogonal to each axis and to each other.

    Parameters
    ----------
    axis : (n, 3) unit vectors, leading axes free, dimensionless.

    Returns
    -------
    (n, 3, 2), dimensionless; columns p and o with p × o = axis.
    """
    helper = np.eye(3)[np.abs(axis).argmin(axis=-1)]
    frame = np.empty((*axis.shape, 2))
    p = helper - axis * (axis * helper).sum(axis=-1, keepdims=True)
    p /= np.sqrt((p * p).sum(axis=-1, keepdims=True))
    frame[..., 0] = p
    frame[..., 1] = axis[..., [1, 2, 0]] * p[..., [2, 0, 1]] - axis[..., [2, 0, 1]] * p[..., [1, 2, 0]]
    return frame


def in_frame(covariance: Array, basis: Array, frame: Array) -> Array:
    """A covariance of turns along one pair of tangents, along another pair.

    A turn c along the tangents T moves the axis by T·c, so the covariance in space is T·C·Tᵀ, and along the frame F it
    is (FᵀT)·C·(FᵀT)ᵀ. Of two axes an angle ε apart this is right to second order in ε (JCGM 102, 6.2). Tangents of
    nearly equal axes may differ by a third of a turn: see `tangents`.

    Parameters
    ----------
    covariance : (2, 2) of turns along ``basis``, rad²; leading axes free.
    basis, frame : (3, 2) orthonormal columns, dimensionless; leading axes free.

    Returns
    -------
    (2, 2), rad².
    """
    turn = np.swapaxes(frame, -1, -2) @ basis
    return np.asarray(turn @ covariance @ np.swapaxes(turn, -1, -2))


def nearest_turn(vectors: Array, others: Array) -> Array:
    """(3, 3) rotation R, dimensionless, for which R·v come nearest to the others; both (n, 3), leading axes free, any
    one unit.

    Kabsch (1976). `scipy.spatial.transform.Rotation.align_vectors` solves the same, but its way through a quaternion
    changes the last digits (2e-15), and with them stored calibrations.
    """
    left, _, right = np.linalg.svd(np.swapaxes(others, -1, -2) @ vectors)
    left[..., 2] *= np.linalg.det(left @ right)[..., None]
    return np.asarray(left @ right)


def crossed(vectors: Array) -> Array:
    """(n, 3, 3) base vector × v of vectors v (n, 3), leading axes free, in their unit: a column for x, y and z."""
    x, y, z = (vectors[..., k] for k in range(3))
    columns = np.zeros((*vectors.shape, 3))
    columns[..., 1, 0], columns[..., 2, 0] = -z, y
    columns[..., 0, 1], columns[..., 2, 1] = z, -x
    columns[..., 0, 2], columns[..., 1, 2] = -y, x
    return columns


def eigh(matrix: Array) -> tuple[Array, Array]:
    """(…, n) eigenvalues, rising, and (…, n, n) eigenvectors of symmetric matrices of any unit.

    Divide and conquer, LAPACK's fastest, gives up on some finite matrices with many equal eigenvalues (two among some
    thousand courses of a sensor); QR does not.
    """
    try:
        values, vectors = np.linalg.eigh(matrix)
    except np.linalg.LinAlgError:
        n = matrix.shape[-1]
        solved = [patient_eigh(symmetric, driver="ev") for symmetric in matrix.reshape(-1, n, n)]
        values = np.stack([v for v, _ in solved]).reshape(matrix.shape[:-1])
        vectors = np.stack([w for _, w in solved]).reshape(matrix.shape)
    return values, vectors
