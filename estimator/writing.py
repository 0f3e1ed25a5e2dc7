"""CalibrationSession → imu-session/1, the inverse of `estimator.read_session`. Angles in degrees and arcsec."""

from collections.abc import Iterable

import numpy as np

from estimator.json_object import Json
from estimator.reading.keys import FORMAT, SIGMA
from estimator.session import ACCELEROMETER, Array, CalibrationSession, Sensor, Stand, StandErrors

TIME_DECIMALS = 6
"""The time since power-on is written to a microsecond."""
ANGLE_DECIMALS = 10
"""Degrees and arcsec are written to 1e-10: 30.0, not 29.999999999999996."""


def session_document(session: CalibrationSession) -> Json:
    """The session as imu-session/1; what it does not state is left out.

    Reading the document back gives the same session, angles to 1e-12 rad.
    """
    return _stated(
        {
            "format": FORMAT,
            "unit": session.unit,
            "unit_type": session.unit_type,
            "block": session.block,
            "programme": session.programme,
            "started_at": session.started_at,
            "time_since_power_on_s": _rounded(session.time_since_power_on, TIME_DECIMALS),
            "operator": session.operator or None,
            "notes": session.notes or None,
            "stage": session.stage,
            "origin": session.origin,
            "site": _stated(
                {
                    "latitude_deg": _degrees(session.site.latitude),
                    "height_m": session.site.height,
                    "gravity_m_s2": session.site.gravity,
                }
            ),
            "stand": None if session.stand is None else _stand(session.stand),
            "mounting": None if np.array_equal(session.mounting, np.eye(3)) else session.mounting.tolist(),
            "direction_sigma_deg": _degrees(session.direction_sigma),
            "sample_rate_hz": session.sample_rate,
            "count_time_s": session.count_time,
            "counter": session.counter,
            "sensors": [_sensor(sensor, session) for sensor in session.sensors],
            "table": _table(session),
        }
    )


def _stated(fields: Json) -> Json:
    return {name: value for name, value in fields.items() if value is not None}


def _degrees(angle: float | None) -> float | None:
    return None if angle is None else _rounded(float(np.degrees(angle)), ANGLE_DECIMALS)


def _rounded(value: float | None, decimals: int) -> float | None:
    return None if value is None else round(value, decimals)


def _stand(stand: Stand) -> Json:
    return _stated(
        {
            "id": stand.id,
            "alpha_deg": _degrees(stand.alpha),
            "chi_deg": _degrees(stand.chi),
            "sigma_arcsec": _sigma(stand.sigma),
            "sigma_count_time_s": stand.sigma.count_time or None,
        }
    )


def _sigma(sigma: StandErrors) -> dict[str, float]:
    """The angles of known sigma, arcsec."""
    stated = {name: getattr(sigma, name) or 0.0 for name in SIGMA}
    values = {name: round(3600 * float(np.degrees(angle)), ANGLE_DECIMALS) for name, angle in stated.items()}
    return {name: value for name, value in values.items() if value}


def _sensor(sensor: Sensor, session: CalibrationSession) -> Json:
    suffix = "m_s2" if sensor.kind == ACCELEROMETER else "rad_s"
    return _stated(
        {
            "name": sensor.name,
            "kind": None if sensor.kind == session.block else sensor.kind,
            "nominal_axis": sensor.nominal_axis.tolist(),
            "nominal_scale": sensor.nominal_scale,
            "nominal_offset": sensor.nominal_offset,
            "reading_unit": sensor.reading_unit,
            f"bias_repeatability_{suffix}": sensor.bias_repeatability or None,
            "position_m": None if sensor.position is None else sensor.position.tolist(),
        }
    )


def _table(session: CalibrationSession) -> Json:
    table: Json = {}
    if session.flipped is not None:
        table["run"] = ["flipped" if flipped else "direct" for flipped in session.flipped]
    if session.beta is not None:
        table["beta_deg"] = np.round(np.degrees(session.beta), ANGLE_DECIMALS).tolist()
    for name, column in (("time_s", session.time), ("temperature_c", session.temperature)):
        if column is not None:
            table[name] = column.tolist()
    if session.vibration is not None and np.all(session.vibration == session.vibration[:, :1]):
        table["vibration_m_s2"] = np.sqrt(session.vibration[:, 0]).tolist()
    in_degrees = {
        "tilt_se_deg": session.tilt_error,
        "turn_angle_deg": session.turn_angle,
        "turn_rate_deg_s": session.turn_rate,
    }
    for name, turning in in_degrees.items():
        if turning is not None:
            table[name] = np.round(np.degrees(turning), ANGLE_DECIMALS).tolist()
    if session.position is not None:
        table["position"] = session.position.tolist()
    if session.directions is not None and session.direction_sigma is not None:
        table |= {f"direction_{axis}": _column(session.directions[:, k]) for k, axis in enumerate("xyz")}
    for i, sensor in enumerate(session.sensors):
        table[sensor.name] = session.readings[:, i].tolist()
        if np.isfinite(session.standard_errors[:, i]).any():
            table[f"{sensor.name}_se"] = _column(session.standard_errors[:, i])
    return table


def _column(values: Array) -> list[float | None]:
    """A column (R,), any unit, in which what is not known is null."""
    listed: Iterable[float] = values.tolist()
    return [value if np.isfinite(value) else None for value in listed]
