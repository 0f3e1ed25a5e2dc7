"""Kalibr's model `scale-misalignment`: a_m = M_a·a + b_a and ω_m = M_g·C·ω + b_g, with M_a and M_g lower triangular.

Source: Rehder et al., Extending kalibr (ICRA 2016), and Kalibr's imu.yaml. Kalibr's frame is the one in which M_a is
lower triangular: A = L·Q gives M_a = L, and Q turns block axes into that frame. The gyros' matrix, A_g·Qᵀ = M_g·C, is
taken apart in the same way. The biases, which Kalibr lets wander, stand beside it.
"""

from collections.abc import Iterator

import numpy as np
import yaml

from estimator.session import ACCELEROMETER, GYROSCOPE, Array
from service.papers.onboard.given import ExportInput, commented, heading, noisiest, number

NOISE = "noise densities and random walks that are not here are not decided by this session: add them from a long rest"
OF_REST = "noise densities and random walks are those of the noisiest sensor at rest, m/s^2 and rad/s per sqrt(Hz)"
DENSITIES = (
    ("accelerometer_noise_density", ACCELEROMETER, "white-noise"),
    ("accelerometer_random_walk", ACCELEROMETER, "random-walk"),
    ("gyroscope_noise_density", GYROSCOPE, "white-noise"),
    ("gyroscope_random_walk", GYROSCOPE, "random-walk"),
)
"""Kalibr's names, with the kind of sensor and the term of noise."""
TURNED = "C_imu_block turns block axes into Kalibr's, in which the accelerometers' M is lower triangular"


def written(given: ExportInput) -> str:
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
    found |= _densities(given)
    return "\n".join([*commented(_notes(given)), yaml.safe_dump({"imu0": found}, sort_keys=False, width=10_000)])


def _notes(given: ExportInput) -> Iterator[str]:
    yield from heading(given, "Kalibr")
    yield TURNED
    if _densities(given):
        yield OF_REST
    if len(_densities(given)) < 2 * len(given.vectors):
        yield NOISE


def _densities(given: ExportInput) -> dict[str, float]:
    sizes = ((name, noisiest(given, kind, term)) for name, kind, term in DENSITIES if kind in given.vectors)
    return {name: float(number(size)) for name, size in sizes if size is not None}


def triangular(matrix: Array) -> tuple[Array, Array]:
    """(3, 3) lower triangular with a positive diagonal, and the rotation it stands before; dimensionless."""
    upper_rotation, upper = np.linalg.qr(matrix.T)
    signs = np.sign(np.diag(upper))
    return (upper * signs[:, None]).T, (upper_rotation * signs).T
