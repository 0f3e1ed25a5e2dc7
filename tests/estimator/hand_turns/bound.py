"""The Cramér–Rao bound of gyros turned by hand, by brute force.

Every unknown is written out: gyros, accelerometers, the first attitude and the rate at every single sample. Readings
are made by a plain loop of rotations, their derivatives are differences, the information is one dense matrix. Nothing
of the estimator's vectors, weights or eliminations is used.
"""

import numpy as np
from scipy.spatial.transform import Rotation

GRAVITY = 9.81


def readings(x, m, turns, step):
    """Everything that is read of unknowns x: gyros (m, 4), accelerometers (3, 4), first up (2), rates (turns, n, 3).

    Rests: three accelerometers and m gyros; turns: m gyros a sample.
    """
    gyros, accelerometers = x[: 4 * m].reshape(m, 4), x[4 * m : 4 * m + 12].reshape(3, 4)
    tilt, rates = x[4 * m + 12 : 4 * m + 14], x[4 * m + 14 :].reshape(*turns, 3)
    up = Rotation.from_rotvec([*tilt, 0.0]).apply([0.0, 0.0, 1.0])
    out = []
    for k in range(len(rates) + 1):
        out += [accelerometers[:, :3] @ (GRAVITY * up) + accelerometers[:, 3], gyros[:, 3]]
        if k < len(rates):
            out.append((rates[k] @ gyros[:, :3].T + gyros[:, 3]).ravel())
            for rate in rates[k]:
                up = Rotation.from_rotvec(step * rate).inv().apply(up)
    return np.concatenate(out)


def covariance(x, m, turns, step, sigma):
    """(4 m, 4 m) bound of the gyros' S and β, sensor after sensor; frame: no net turn of the accelerometers' axes.

    sigma : of every reading, in order.
    """
    columns = []
    for i in range(len(x)):
        h = np.zeros_like(x)
        h[i] = 1e-5
        columns.append((readings(x + h, m, turns, step) - readings(x - h, m, turns, step)) / 2e-5 / sigma)
    J = np.column_stack(columns)
    frame = np.zeros((3, len(x)))  # Σ e_i × a_i of nominal axes e along x, y, z
    for i in range(3):
        at = 4 * m + 4 * i
        frame[:, at : at + 3] = np.cross(np.eye(3)[i], np.eye(3)).T
    kept = np.linalg.svd(frame)[2][3:].T
    F = (J @ kept).T @ (J @ kept)
    scale = 1 / np.sqrt(np.diagonal(F))
    inverse = scale[:, None] * np.linalg.inv(F * np.outer(scale, scale)) * scale
    return (kept @ inverse @ kept.T)[: 4 * m, : 4 * m]
