"""Kalibr's model `scale-misalignment`: a_m = M_a·a + b_a and ω_m = M_g·C·ω + b_g, with M_a and M_g lower triangular.

Source: Rehder et al., Extending kalibr (ICRA 2016), and Kalibr's imu.yaml. Kalibr's frame is the one in which M_a is
lower triangular: A = L·Q gives M_a = L, and Q turns block axes into that frame. The gyros' matrix, A_g·Qᵀ = M_g·C, is
taken apart in the same way. The biases, which Kalibr lets wander, stand beside it.
"""

from collections.abc import Iterator

import numpy as np
import yaml

from estimator.session import Array
from service.reports.onboard.given import Given, commented, heading

NOISE = "noise densities and random walks are not part of a calibration: add them from a long record at rest"
TURNED = "C_imu_block turns block axes into Kalibr's, in which the accelerometers' M is lower triangular"


def written(given: Given) -> str:
    """The file."""
    turned, found = np.eye(3), dict[str, object](model="scale-misalignment")
    if given.accelerometers is not None:
        lower, turned = triangular(given.accelerometers.matrix)
        found["accelerometers"] = {"M": lower.tolist(), "b": given.accelerometers.offset.tolist()}
    if given.gyros is not None:
        lower, rotation = triangular(given.gyros.matrix @ turned.T)
        gyros = {"M": lower.tolist(), "C_gyro_i": rotation.tolist(), "A": np.zeros((3, 3)).tolist()}
        found["gyroscopes"] = gyros | {"b": given.gyros.offset.tolist()}
    found["C_imu_block"] = turned.tolist()
    return "\n".join([*commented(_notes(given)), yaml.safe_dump({"imu0": found}, sort_keys=False, width=10_000)])


def _notes(given: Given) -> Iterator[str]:
    yield from heading(given, "Kalibr")
    yield from (TURNED, NOISE)


def triangular(matrix: Array) -> tuple[Array, Array]:
    """(3, 3) lower triangular with a positive diagonal, and the rotation it stands before; dimensionless."""
    upper_rotation, upper = np.linalg.qr(matrix.T)
    signs = np.sign(np.diag(upper))
    return (upper * signs[:, None]).T, (upper_rotation * signs).T
