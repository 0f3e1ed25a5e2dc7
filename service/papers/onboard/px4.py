"""PX4: ``corrected = (raw − CAL_ACC0_OFF)·CAL_ACC0_SCALE``, and of gyros ``raw − CAL_GYRO0_OFF``.

Source: PX4-Autopilot, src/lib/sensor_calibration/Accelerometer.hpp and Gyroscope.hpp. The file is QGroundControl's:
vehicle, component, name, value and type (9: float) between tabs.
"""

from service.papers.onboard.given import ExportInput, Names, commented, heading, left_of, number, parameters

NAMES = Names("CAL_ACC0_{}OFF", "CAL_ACC0_{}SCALE", "CAL_GYRO0_{}OFF")
FLOAT = 9
"""MAV_PARAM_TYPE_REAL32."""
DEVICE = "PX4 uses them where CAL_ACC0_ID and CAL_GYRO0_ID are the ids of these sensors, which no file can know."


def written(given: ExportInput) -> str:
    """The file."""
    rows = [f"1\t1\t{name}\t{number(value)}\t{FLOAT}" for name, value in parameters(given, NAMES)]
    notes = [*heading(given, "PX4"), *left_of(given), DEVICE]
    return "\n".join([*commented(iter(notes)), *rows, ""])
