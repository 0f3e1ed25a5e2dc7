"""PX4: ``corrected = (raw − CAL_ACC0_OFF)·CAL_ACC0_SCALE``, and of gyros ``raw − CAL_GYRO0_OFF``.

Source: PX4-Autopilot, src/lib/sensor_calibration/Accelerometer.hpp and Gyroscope.hpp. The file is QGroundControl's:
vehicle, component, name, value and type (9: float) between tabs.
"""

from collections.abc import Iterator

from service.reports.onboard.given import Given, commented, heading, number, unmixed
from service.reports.onboard.left import left_of

FLOAT = 9
"""MAV_PARAM_TYPE_REAL32."""
DEVICE = "PX4 uses them where CAL_ACC0_ID and CAL_GYRO0_ID are the ids of these sensors, which no file can know."


def written(given: Given) -> str:
    """The file."""
    notes = [*heading(given, "PX4"), *left_of(given), DEVICE]
    rows = [f"1\t1\t{name}\t{number(value)}\t{FLOAT}" for name, value in _parameters(given)]
    return "\n".join([*commented(iter(notes)), *rows, ""])


def _parameters(given: Given) -> Iterator[tuple[str, float]]:
    if given.accelerometers is not None:
        offset, scale = unmixed(given.accelerometers)
        for axis, value in zip("XYZ", offset, strict=True):
            yield f"CAL_ACC0_{axis}OFF", float(value)
        for axis, value in zip("XYZ", scale, strict=True):
            yield f"CAL_ACC0_{axis}SCALE", float(value)
    if given.gyros is not None:
        for axis, value in zip("XYZ", given.gyros.offset, strict=True):
            yield f"CAL_GYRO0_{axis}OFF", float(value)
