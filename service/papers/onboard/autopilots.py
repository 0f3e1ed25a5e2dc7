"""Two autopilots, each with the bias and the scale of accelerometers and the bias of gyros.

PX4: ``corrected = (raw − CAL_ACC0_OFF)·CAL_ACC0_SCALE``, and of gyros ``raw − CAL_GYRO0_OFF``.
Source: PX4-Autopilot, src/lib/sensor_calibration/Accelerometer.hpp and Gyroscope.hpp. The file is QGroundControl's:
vehicle, component, name, value and type (9: float) between tabs.

ArduPilot: ``corrected = (raw − INS_ACCOFFS)·INS_ACCSCAL``, and of gyros ``raw − INS_GYROFFS``.
Source: ardupilot, libraries/AP_InertialSensor/AP_InertialSensor_Backend.cpp. One parameter a line, name and value.
"""

from service.papers.onboard.given import ExportInput, Names, commented, heading, left_of, number, parameters

PX4 = Names("CAL_ACC0_{}OFF", "CAL_ACC0_{}SCALE", "CAL_GYRO0_{}OFF")
FLOAT = 9
"""MAV_PARAM_TYPE_REAL32."""
DEVICE = "PX4 uses them where CAL_ACC0_ID and CAL_GYRO0_ID are the ids of these sensors, which no file can know."
ARDUPILOT = Names("INS_ACCOFFS_{}", "INS_ACCSCAL_{}", "INS_GYROFFS_{}")
LEARNED = "INS_GYR_CAL = 0 keeps the gyro offsets; else ArduPilot measures them anew at every start."


def px4(given: ExportInput) -> str:
    """The file for PX4."""
    rows = [f"1\t1\t{name}\t{number(value)}\t{FLOAT}" for name, value in parameters(given, PX4)]
    return "\n".join([*commented([*heading(given, "PX4"), *left_of(given), DEVICE]), *rows, ""])


def ardupilot(given: ExportInput) -> str:
    """The file for ArduPilot."""
    rows = [f"{name},{number(value)}" for name, value in parameters(given, ARDUPILOT)]
    return "\n".join([*commented([*heading(given, "ArduPilot"), *left_of(given), LEARNED]), *rows, ""])
