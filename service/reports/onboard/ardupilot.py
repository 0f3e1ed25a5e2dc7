"""ArduPilot: ``corrected = (raw − INS_ACCOFFS)·INS_ACCSCAL``, and of gyros ``raw − INS_GYROFFS``.

Source: ardupilot, libraries/AP_InertialSensor/AP_InertialSensor_Backend.cpp. One parameter a line, name and value.
"""

from collections.abc import Iterator

from service.reports.onboard.given import Given, commented, heading, number, unmixed
from service.reports.onboard.left import left_of

LEARNED = "INS_GYR_CAL = 0 keeps the gyro offsets; else ArduPilot measures them anew at every start."


def written(given: Given) -> str:
    """The file."""
    notes = [*heading(given, "ArduPilot"), *left_of(given), LEARNED]
    rows = [f"{name},{number(value)}" for name, value in _parameters(given)]
    return "\n".join([*commented(iter(notes)), *rows, ""])


def _parameters(given: Given) -> Iterator[tuple[str, float]]:
    if given.accelerometers is not None:
        offset, scale = unmixed(given.accelerometers)
        for axis, value in zip("XYZ", offset, strict=True):
            yield f"INS_ACCOFFS_{axis}", float(value)
        for axis, value in zip("XYZ", scale, strict=True):
            yield f"INS_ACCSCAL_{axis}", float(value)
    if given.gyros is not None:
        for axis, value in zip("XYZ", given.gyros.offset, strict=True):
            yield f"INS_GYROFFS_{axis}", float(value)
