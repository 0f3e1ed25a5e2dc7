"""ROS 2: parameters of a node that corrects `sensor_msgs/Imu`, ``corrected = SM·raw − bias``, as imu_calib does.

Source: imu_calib, src/accel_calib.cpp (SM row by row). `covariance` is that of SM and bias, 12 by 12 row by row: with
v = (raw, −1) as its lever, J = [I ⊗ rawᵀ, −I], the calibration's part of `linear_acceleration_covariance` is J·C·Jᵀ.
"""

from collections.abc import Iterator

import yaml

from estimator.codec import json_numbers
from estimator.nominal_vector import NominalVector
from service.papers.onboard.given import ExportInput, commented, heading

NODE = "imu_calibration"
RULE = "corrected = SM * raw - bias; covariance: of SM row by row and bias, 12 by 12, row by row"


def written(given: ExportInput) -> str:
    """The file."""
    kinds = {"linear_acceleration": given.accelerometers, "angular_velocity": given.gyros}
    found = {name: _numbers(vector) for name, vector in kinds.items() if vector is not None}
    text = yaml.safe_dump({NODE: {"ros__parameters": found}}, sort_keys=False, default_flow_style=None, width=10_000)
    return "\n".join([*commented(_notes(given)), text])


def _notes(given: ExportInput) -> Iterator[str]:
    yield from heading(given, "ROS 2")
    yield RULE


def _numbers(vector: NominalVector) -> dict[str, list[float]]:
    return {
        "SM": vector.correction.ravel().tolist(),
        "bias": vector.bias.tolist(),
        "covariance": json_numbers(vector.covariance.ravel()),
    }
