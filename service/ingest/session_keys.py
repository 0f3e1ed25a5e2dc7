"""Hints for the fields and columns of a session file, one line each, for people who fill one in."""

from estimator.message import say

NEEDED_HERE = "Needed."
KEY_HINTS = {
    "format": "Leave as it is.",
    "unit": "Serial number of the unit.",
    "unit_type": "Name of the unit type.",
    "block": "Kind of the sensors: accelerometer or gyroscope.",
    "programme": "How it was measured.",
    "started_at": "When the first row was measured, with its zone: 2026-03-01T09:00:00Z, or with +03:00 for Moscow.",
    "powered_on_at": "When the unit was switched on, in the same way; empty where nobody knows.",
    "time_since_power_on_s": "Seconds from switching on to the first row, where the moment itself is not given.",
    "stage": "as-found before work on the unit, as-left after it; empty otherwise.",
    "origin": "simulated if no hardware was measured; empty otherwise.",
    "operator": "Who measured.",
    "notes": "Anything worth knowing.",
    "latitude_deg": "Latitude of the stand, degrees.",
    "height_m": "Height above the ellipsoid, metres.",
    "gravity_m_s2": "Gravity at the stand, m/s², where it was measured.",
    "stand.id": "Name or number of the stand.",
    "alpha_deg": "Elevation of the head's axis above the horizon, degrees.",
    "chi_deg": "Elevation of the head's axis above the plane orthogonal to the Earth's axis, degrees.",
    "theta_x": "Levelling error, one sigma, arcsec.",
    "theta_y": "Levelling error, one sigma, arcsec.",
    "alpha": "Error of the elevation, one sigma, arcsec.",
    "beta": "Error of the turn of the head, one sigma, arcsec.",
    "latitude": "Error of the latitude, one sigma, arcsec.",
    "meridian": "Error of the north direction, one sigma, arcsec.",
    "sigma_count_time_s": "Error of the count time, one sigma, seconds.",
    "count_time_s": "Time over which the pulses of a reading are counted, seconds.",
    "counter": "free-running: the difference of two readings of a counter; reset: counted from zero every time.",
    "sample_rate_hz": "Samples a second of a log; without it, rows are averages.",
    "mounting": "Rotation from the platform's axes to the block's: three rows of three numbers.",
    "name": "Name of the sensor, as in the heading of its column of readings.",
    "kind": "accelerometer or gyroscope, where it differs from the block.",
    "nominal_axis": "Input axis in block axes: a unit vector.",
    "nominal_scale": "Nominal scale factor: reading unit per m/s² (gyroscopes: per rad/s, or pulses per rad).",
    "nominal_offset": "Reading at zero input, in the reading unit.",
    "reading_unit": "Unit of the readings, such as V, mA or count.",
    "bias_repeatability_m_s2": "Scatter of the bias from position to position, one sigma, m/s².",
    "bias_repeatability_rad_s": "Scatter of the bias from position to position, one sigma, rad/s.",
    "position_m": "Position of the sensor: three numbers in metres, block axes.",
    "direction_sigma_deg": "Uncertainty of the stated directions, one sigma, degrees.",
}
"""Hints by the whole key, or by its last part."""
COLUMN_HINTS = {
    "run": "direct, or flipped with the block turned by 180° about the platform's Z axis.",
    "beta_deg": "Turn of the head, degrees.",
    "time_s": "Time since the first row, seconds. May stay empty.",
    "temperature_c": "Temperature, °C. May stay empty.",
    "vibration_m_s2": "Vibration while the row was averaged, rms, m/s². May stay empty.",
    "tilt_se_deg": "Standard error of the block's mean tilt in the row, degrees. May stay empty.",
    "turn_angle_deg": "Angle of the turntable at the end of the row, degrees.",
    "turn_rate_deg_s": "Rate of the table during the row, degrees a second.",
    "position": "Which position the row belongs to: a whole number or a name.",
    "direction_x": "Approximate upward direction in block axes; empty if unknown.",
    "direction_y": "Approximate upward direction in block axes; empty if unknown.",
    "direction_z": "Approximate upward direction in block axes; empty if unknown.",
}


def reading_hint(sensor: str, unit: str) -> str:
    """Hint of a sensor's column."""
    return say("Reading of {sensor}, {unit}: the mean at this position.", sensor=sensor, unit=unit)


def standard_error_hint(sensor: str, unit: str) -> str:
    """Hint of the column of its standard errors."""
    return say("Standard error of the mean reading of {sensor}, {unit}. May stay empty.", sensor=sensor, unit=unit)
