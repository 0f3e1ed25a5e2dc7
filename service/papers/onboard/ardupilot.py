"""ArduPilot: ``corrected = (raw − INS_ACCOFFS)·INS_ACCSCAL``, and of gyros ``raw − INS_GYROFFS``.

Source: ardupilot, libraries/AP_InertialSensor/AP_InertialSensor_Backend.cpp. One parameter a line, name and value.
"""

from service.papers.onboard.given import ExportInput, Names, commented, heading, left_of, number, parameters

NAMES = Names("INS_ACCOFFS_{}", "INS_ACCSCAL_{}", "INS_GYROFFS_{}")
LEARNED = "INS_GYR_CAL = 0 keeps the gyro offsets; else ArduPilot measures them anew at every start."


def written(given: ExportInput) -> str:
    """The file."""
    rows = [f"{name},{number(value)}" for name, value in parameters(given, NAMES)]
    notes = [*heading(given, "ArduPilot"), *left_of(given), LEARNED]
    return "\n".join([*commented(iter(notes)), *rows, ""])
