"""The publications' own calibrations of their sensors, in the form of `Triad`; sources in docs/recordings.md."""

import numpy as np

from benchmarks.recordings.triad import Triad

NONE = np.zeros(3)


def xsens() -> Triad:
    """Data sheet of the Xsens MTi of imu-tk: scale, offset, and misalignment from ideal to raw, to two decimals."""
    misalignment = np.array([[1.00, 0.00, -0.01], [0.01, 1.00, 0.01], [0.02, 0.01, 1.00]])
    return Triad(np.diag([415.0, 413.0, 415.0]) @ misalignment, np.array([33123.0, 33276.0, 32360.0]), NONE)


MPU_SCALE_PERCENT = np.array(
    [[0.363, 0.315, 0.647], [0.471, 0.482, 0.932], [0.382, 0.355, 0.78], [0.263, 0.448, 0.721], [0.251, 0.286, 0.804]]
)
"""(5, 3) sx, sy, sz"""
MPU_ANGLES_DEG = np.array(
    [
        [0.02, 0.317, 0.123],
        [-0.01, 0.145, -0.284],
        [-0.012, 0.282, 0.26],
        [-0.028, -0.104, -0.009],
        [0.0, 0.191, 0.056],
    ]
)
"""(5, 3) m_xy, m_xz, m_yz"""
MPU_BIAS = np.array(
    [[0.103, 0.097, 0.344], [0.09, 0.07, 0.338], [0.096, 0.008, -0.045], [0.065, 0.092, -0.009], [0.07, 0.036, 0.182]]
)
"""(5, 3) m/s²"""


def mpu9150(number: int) -> Triad:
    """One of the five MPU-9150, counted from 0: measured = M·a + b, M upper triangular."""
    xy, xz, yz = np.radians(MPU_ANGLES_DEG[number])
    M = np.eye(3) + np.diag(MPU_SCALE_PERCENT[number] / 100) + np.array([[0, xy, xz], [0, 0, yz], [0, 0, 0]])
    return Triad(M, MPU_BIAS[number], NONE)


def ferraris() -> Triad:
    """imucal's own result on its example: raw = K·R·a + b."""
    K = np.diag([208.54567263762615, 208.0011341167055, 214.78455364603022])
    R = np.array(
        [
            [0.9999125214309234, 0.007122056140390757, -0.011145662922687352],
            [-0.007947378455060604, 0.9996887358297629, 0.023648903373787954],
            [0.021342900724016442, -0.010781879507682177, 0.9997140749549175],
        ]
    )
    return Triad(K @ R, np.array([-6.018868019671572, -48.287874016760156, -28.96636637224333]), NONE)
