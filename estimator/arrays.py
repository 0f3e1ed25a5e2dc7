"""Small array helpers that several rooms share."""

import numpy as np

from estimator.session import Array


def unit(vector: Array) -> Array:
    """(..., 3) vectors scaled to length one."""
    return vector / np.linalg.norm(vector, axis=-1, keepdims=True)


def tangents(axis: Array) -> Array:
    """Two unit vectors orthogonal to each axis and to each other.

    Parameters
    ----------
    axis : (..., 3) unit vectors.

    Returns
    -------
    (..., 3, 2), columns p and o with p × o = axis.
    """
    helper = np.zeros_like(axis)
    np.put_along_axis(helper, np.abs(axis).argmin(axis=-1)[..., None], 1.0, axis=-1)
    p = helper - axis * (axis * helper).sum(axis=-1, keepdims=True)
    p = p / np.sqrt((p * p).sum(axis=-1, keepdims=True))
    o = axis[..., [1, 2, 0]] * p[..., [2, 0, 1]] - axis[..., [2, 0, 1]] * p[..., [1, 2, 0]]
    return np.stack([p, o], axis=-1)
