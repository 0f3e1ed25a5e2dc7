"""Starting points of the search: linear estimates, good to a few per cent, with or without stated directions.

Without directions: the readings lie on an ellipsoid in a three-dimensional affine subspace of the m readings. The
subspace is found by principal components, the ellipsoid by linear least squares about a sphere (the least change of
the sphere that explains the readings, so that too few or too plain orientations still give a start), and the rotation
that is left by orthogonal Procrustes against the nominal axes.
Source: the ellipsoid fit is the classical multi-position calibration.
"""

import numpy as np

from estimator.arrays import eigh, unit
from estimator.calibration.free.model import ModelRows, Unknowns, cost
from estimator.session import Array

PLAIN = 0.02
"""Singular values below this part of the largest carry noise rather than shape. A choice: below the nonlinearity and
misalignment of a real block, above the noise of a poor one."""

SLIGHT = (0.05, 0.005, 0.0005)
"""Singular values of the quadric below this part of the largest carry noise; tried in turn, and below it the sphere's
shape is kept. Few orientations need a small one when they are precise and a large one when they are plain.
"""

LEAST_GAIN = 1e-6
"""Least gain relative to nominal; a sensor below it is dead, and its scale's logarithm must stay finite."""

TINY = float(np.finfo(float).tiny)
"""Keeps a division by nothing finite."""

FLAT = 1e-3
"""Ratio of the quadric's eigenvalues below which it is no ellipsoid: semi-axes of 1 : 30."""


def start(rows: ModelRows) -> Unknowns:
    """The start that fits best, out of `starts`."""
    return starts(rows)[0]


def starts(rows: ModelRows) -> list[Unknowns]:
    """Parameters and orientations from different linear estimates, the one that fits best first."""
    linear_starts = [with_directions(rows)] if rows.held else from_shape(rows)
    return sorted((oriented(rows, *linear) for linear in linear_starts), key=lambda unknowns: cost(rows, unknowns))


def oriented(rows: ModelRows, sensitivity: Array, offset: Array) -> Unknowns:
    """Unknowns with sensitivity (m, 3) and offset (m,), in nominal scale times g, and the best orientations."""
    gain = np.maximum(np.linalg.norm(sensitivity, axis=1), LEAST_GAIN)
    directions = unit((rows.y - offset) @ np.linalg.pinv(sensitivity).T)
    if rows.held:
        directions = np.where(rows.prior[:, None] > 0, rows.directions, directions)
    return Unknowns(np.log(gain), offset, np.zeros_like(gain), sensitivity / gain[:, None], directions)


def with_directions(rows: ModelRows) -> tuple[Array, Array]:
    """Sensitivity (m, 3) and offset (m,), relative, by least squares on the stated directions, about nominal values."""
    stated = rows.prior > 0
    design = np.column_stack([rows.directions[stated], np.ones(int(stated.sum()))])
    expected = rows.directions[stated] @ rows.nominal_axes.T
    change = np.linalg.pinv(design, rcond=PLAIN) @ (rows.y[stated] - expected)
    return rows.nominal_axes + change[:3].T, change[3]


def from_shape(rows: ModelRows) -> list[tuple[Array, Array]]:
    """Sensitivity (m, 3) and offset (m,), relative, from the ellipsoids the readings may lie on: one a `SLIGHT`, those
    once that tell the same of the shape."""
    centre = rows.y.mean(axis=0)
    basis = subspace(rows.y - centre, rows.nominal_axes)
    inward = np.linalg.pinv(rows.nominal_axes) @ basis
    points = (rows.y - centre) @ basis @ inward.T
    to_readings = basis @ np.linalg.inv(inward)
    starts = []
    for middle, root in ellipsoids(points):
        shaped = to_readings @ root
        U, _, Vt = np.linalg.svd(shaped.T @ rows.nominal_axes)
        starts.append((shaped @ U @ Vt, centre + to_readings @ middle))
    return starts


def subspace(centred: Array, nominal_axes: Array) -> Array:
    """(m, 3) orthonormal basis, no unit, of how readings (R, m) vary; of nominal axes (m, 3) where that is plain."""
    _, spread, Vt = np.linalg.svd(centred, full_matrices=False)
    if len(spread) >= 3 and spread[2] > PLAIN * spread[0]:
        return Vt[:3].T
    return np.linalg.qr(nominal_axes)[0]


def ellipsoids(points: Array) -> list[tuple[Array, Array]]:
    """Centre (3,) and shape L (3, 3) of points (R, 3) ≈ centre + L·d, d unit vectors, L symmetric; one a `SLIGHT`.

    All relative to nominal scale times g.
    First the best sphere; then, in its units, vᵀ(I + Q)v + q·v = 1 with the least Q and q.
    """
    design = np.column_stack([2 * points, np.ones(len(points))])
    sphere = np.linalg.pinv(design, rcond=PLAIN) @ (points**2).sum(axis=1)
    middle = sphere[:3]
    radius = np.sqrt(max(float(np.mean(((points - middle) ** 2).sum(axis=1))), TINY))
    v = (points - middle) / radius
    x, y, z = v.T
    quadric = np.column_stack([x * x, y * y, z * z, 2 * x * y, 2 * x * z, 2 * y * z, v])
    U, spread, Vt = np.linalg.svd(quadric, full_matrices=False)
    along = U.T @ (1.0 - (v**2).sum(axis=1))
    shown = dict.fromkeys(tuple((spread > slight * spread[0]).tolist()) for slight in SLIGHT)
    solved = along / np.maximum(spread, TINY)
    return [ellipsoid(middle, radius, Vt.T @ np.where(mask, solved, 0.0)) for mask in shown]


def ellipsoid(middle: Array, radius: float, quadric: Array) -> tuple[Array, Array]:
    """Centre (3,) and shape (3, 3) of a ``quadric`` (9,) about a sphere; the sphere where it is no ellipsoid.

    middle (3,) and radius, like the result, relative to nominal scale times g; the quadric in units of the sphere.
    """
    Q = np.eye(3) + quadric[[0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(3, 3)
    values, vectors = eigh(Q)
    if values[0] < FLAT * values[-1]:
        return middle, radius * np.eye(3)
    offset = -0.5 * np.linalg.solve(Q, quadric[6:])
    size = 1.0 + offset @ Q @ offset
    return middle + radius * offset, radius * (vectors * np.sqrt(size / values)) @ vectors.T
