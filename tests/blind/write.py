"""A session and its readings as the file that the diagnosis is given, ``imu-session/1``."""

from typing import Any

import numpy as np

from tests.blind.world import ARCSEC, Array, Session


def session_file(session: Session, readings: Array) -> dict[str, Any]:
    """The dictionary of the file's JSON; readings (R, m), reading units."""
    unit, stand = session.unit, session.stand
    gyro = bool(unit.gyro.all())
    document: dict[str, Any] = {
        "format": "imu-session/1",
        "unit": unit.name,
        "block": "gyroscope" if gyro else "accelerometer",
        "programme": "two-axis-stand",
        "started_at": session.started_at,
        "site": _site(session),
        "stand": {
            "id": stand.id,
            "alpha_deg": float(np.degrees(stand.alpha)),
            "sigma_arcsec": {
                "theta_x": stand.sigma.theta_x / ARCSEC,
                "theta_y": stand.sigma.theta_y / ARCSEC,
                "alpha": stand.sigma.alpha / ARCSEC,
                "beta": stand.sigma.beta / ARCSEC,
            },
        },
        "mounting": session.mounting.tolist(),
        "sensors": [_sensor(session, i) for i in range(unit.size)],
        "table": _table(session, readings),
    }
    if unit.gyro.any():
        document["stand"]["chi_deg"] = float(np.degrees(stand.chi))
    if session.count_time:
        document["count_time_s"] = session.count_time
        document["counter"] = "reset"
    return document


def _site(session: Session) -> dict[str, Any]:
    site = session.site
    return {
        "latitude_deg": float(np.degrees(site.latitude)),
        "height_m": float(site.height),
        "gravity_m_s2": site.gravity,
    }


def _sensor(session: Session, i: int) -> dict[str, Any]:
    unit = session.unit
    counted = session.count_time or 1.0
    gyro = bool(unit.gyro[i])
    return {
        "name": unit.names[i],
        "kind": "gyroscope" if gyro else "accelerometer",
        "nominal_axis": unit.nominal_axis[i].tolist(),
        "nominal_scale": float(unit.nominal_scale[i] / (counted if gyro else 1.0)),
        "reading_unit": unit.reading_unit[i],
        f"bias_repeatability_{'rad_s' if gyro else 'm_s2'}": float(session.noise.repeatability[i]),
    }


def _table(session: Session, readings: Array) -> dict[str, Any]:
    schedule, unit = session.schedule, session.unit
    table: dict[str, Any] = {
        "run": ["flipped" if f else "direct" for f in schedule.flipped],
        "beta_deg": np.degrees(schedule.beta).tolist(),
    }
    if schedule.timed:
        table["time_s"] = schedule.time.tolist()
    if schedule.thermometer:
        table["temperature_c"] = schedule.temperature.tolist()
    if schedule.vibration is not None:
        table["vibration_m_s2"] = schedule.vibration.tolist()
    for i, name in enumerate(unit.names):
        table[name] = readings[:, i].tolist()
        if session.noise.stated:
            table[f"{name}_se"] = [float(abs(unit.scale[i]) * session.noise.reading[i])] * len(readings)
    return table
