"""imu-session/1 as JSON Schema: what of docs/session-file.md a schema can say. The reader says the rest."""

from estimator.json_object import Json
from estimator.reading.bounds import WITHIN
from estimator.reading.keys import SIGMA
from estimator.screening import KINDS as SCREENED
from estimator.screening import OFF

KINDS = ["accelerometer", "gyroscope"]
NULL = {"type": "null"}
"""Means the same as leaving a field out."""


def _text(description: str) -> Json:
    return {"type": "string", "minLength": 1, "description": description}


def _number(description: str, field: str) -> Json:
    within = WITHIN[field]
    return {"type": "number", "description": description, "minimum": within.low, "maximum": within.high}


def _vector(description: str) -> Json:
    return {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3, "description": description}


def _column(description: str, *kinds: str) -> Json:
    return {"type": "array", "items": {"type": [*kinds]}, "description": description}


def _optional(properties: dict[str, Json]) -> dict[str, Json]:
    """Each of them or null."""
    return {
        name: {"description": schema["description"], "anyOf": [schema, NULL]} for name, schema in properties.items()
    }


SITE: Json = {
    "type": "object",
    "description": "Where it was measured.",
    "properties": _optional(
        {
            "latitude_deg": _number("Geodetic latitude, degrees.", "site.latitude_deg"),
            "height_m": _number("Height above the ellipsoid, m; 0 unless given.", "site.height_m"),
            "gravity_m_s2": _number("Measured gravity, m/s², in place of the formula's.", "site.gravity_m_s2"),
        }
    ),
}
STAND: Json = {
    "type": "object",
    "description": "The stand and how it was set.",
    "properties": _optional(
        {
            "id": _text("Name or number of the stand."),
            "alpha_deg": _number(
                "Elevation of the head's axis above the horizon, degrees; for accelerometers.", "stand.alpha_deg"
            ),
            "chi_deg": _number(
                "Its elevation above the plane orthogonal to the Earth's axis; for gyroscopes.", "stand.chi_deg"
            ),
            "sigma_arcsec": {
                "type": "object",
                "description": "One-sigma errors of the stand, arc seconds; 0 unless given.",
                "properties": _optional(
                    {name: _number("One sigma, arc seconds.", "stand.sigma_arcsec") for name in SIGMA}
                ),
            },
            "sigma_count_time_s": _number("One-sigma error of the count time, s.", "stand.sigma_count_time_s"),
        }
    ),
}
SENSOR: Json = {
    "type": "object",
    "required": ["name", "nominal_axis", "nominal_scale", "reading_unit"],
    "properties": {
        "name": _text("Name of the sensor and of its column."),
        "nominal_axis": _vector("Unit vector of the input axis, block axes."),
        "nominal_scale": _number(
            "Reading units per m/s² or rad/s; of a pulse gyro pulses per rad.", "sensors[].nominal_scale"
        ),
        "reading_unit": _text("Unit of the readings, such as V, mA or count."),
    }
    | _optional(
        {
            "kind": {"enum": KINDS, "description": "Where it differs from `block`."},
            "nominal_offset": _number("Reading at zero input, reading units.", "sensors[].nominal_offset"),
            "bias_repeatability_m_s2": _number(
                "One sigma of an accelerometer's bias from position to position.", "sensors[].bias_repeatability_m_s2"
            ),
            "bias_repeatability_rad_s": _number("The same of a gyroscope.", "sensors[].bias_repeatability_rad_s"),
            "position_m": _vector("Where the sensor sits, m, block axes."),
        }
    ),
}
TABLE: Json = {
    "type": "object",
    "description": "Columns of equal length: one row a reading, in the order measured. Each sensor has a column of its "
    "name, and `<sensor>_se` for the standard errors of averaged readings.",
    "properties": _optional(
        {
            "run": {"type": "array", "items": {"enum": ["direct", "flipped"]}, "description": "Of the two-axis stand."},
            "beta_deg": _column("Turn of the head, degrees.", "number"),
            "time_s": _column("Time since the start, s; never runs backwards.", "number"),
            "temperature_c": _column("Temperature, °C.", "number"),
            "vibration_m_s2": _column("Rms about the mean while the row is averaged, m/s².", "number"),
            "tilt_se_deg": _column("Standard error of the block's mean tilt, degrees.", "number", "null"),
            "turn_angle_deg": _column("Angle of the turntable at the end of the row, degrees.", "number"),
            "turn_rate_deg_s": _column("Rate of the table during the row, degrees a second.", "number"),
            "position": _column("Position that the row belongs to; -1 or null: none.", "integer", "string", "null"),
        }
        | {
            f"direction_{axis}": _column(f"Roughly known direction of the specific force, {axis}.", "number", "null")
            for axis in "xyz"
        }
    ),
    "additionalProperties": {"type": ["array", "null"]},
}
SESSION_FILE: Json = {
    "title": "imu-session/1",
    "type": "object",
    "description": "One calibration session: a block of a unit, measured once. Fields of your own are left unread.",
    "required": ["format", "unit", "block", "programme", "sensors", "table"],
    "properties": {
        "format": {"const": "imu-session/1", "description": "Always that."},
        "unit": _text("Serial number of the unit."),
        "block": {"enum": KINDS, "description": "Kind of every sensor that does not state its own."},
        "programme": _text(
            "`two-axis-stand`, `arbitrary-orientations`, `rotation-alignment`, `rate-table`, `in-service` "
            "or `thermal`."
        ),
        "sensors": {"type": "array", "items": SENSOR, "minItems": 3, "description": "At least three of each kind."},
        "table": TABLE,
    }
    | _optional(
        {
            "unit_type": _text("Kind of unit, whose tolerances apply."),
            "started_at": {"type": "string", "format": "date-time", "description": "When, with its offset from UTC."},
            "powered_on_at": {
                "type": "string", "format": "date-time", "description": "When the unit was switched on, with its "
                "offset; not after started_at, which it needs.",
            },
            "time_since_power_on_s": _number(
                "Seconds from switching on to the first row; instead of powered_on_at.", "time_since_power_on_s"
            ),
            "operator": {"type": "string", "description": "Who measured."},
            "notes": {"type": "string", "description": "Free text."},
            "stage": {"enum": ["as-found", "as-left"], "description": "Before or after the unit was worked on."},
            "origin": {"enum": ["measured", "simulated"], "description": "Measured unless stated; one kind a unit."},
            "site": SITE,
            "stand": STAND,
            "mounting": {
                "type": "array", "items": _vector("A row."), "minItems": 3, "maxItems": 3,
                "description": "Rotation from platform axes to block axes; identity unless given.",
            },
            "count_time_s": _number("Readings of gyros are pulse counts over this time, s.", "count_time_s"),
            "counter": {"enum": ["free-running", "reset"], "description": "How pulses are counted."},
            "sample_rate_hz": _number("The rows are samples at this rate, Hz.", "sample_rate_hz"),
            "direction_sigma_deg": _number("One sigma of the stated directions, degrees.", "direction_sigma_deg"),
            "screening": {
                "anyOf": [{"const": OFF}, {"type": "array", "items": {"enum": list(SCREENED)}}],
                "description": "What the rows of a raw log are not to be screened for.",
            },
        }
    ),
}  # fmt: skip
