"""Names of a mapping's fields on the page, and its faults in the words of a form instead of a file."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from estimator.errors import Problem
from estimator.message import Message, say

LABELS = {
    "run": "run: direct or flipped", "beta_deg": "β, turn of the head", "time_s": "time",
    "temperature_c": "temperature",
    "vibration_m_s2": "vibration", "tilt_se_deg": "standard error of the tilt",
    "turn_angle_deg": "angle of the turntable", "turn_rate_deg_s": "rate of the table",
    "position": "position", "direction_x": "direction x", "direction_y": "direction y", "direction_z": "direction z",
}  # fmt: skip
"""Names of columns on this page."""
KINDS_CALLED = {
    "accelerometer": "accelerometer", "gyroscope": "gyroscope", "temperature": "temperature", "time": "time",
    "angle": "angle or rate of a stand", "run": "run", "position": "position", "direction": "direction",
    "quality": "quality of a reading", "ignored": "left out",
}  # fmt: skip
"""Names of kinds of columns on this page."""
FACTS = (
    ("fact.operator", "Operator", "operator"), ("fact.notes", "Notes", "notes"),
)  # fmt: skip
PLACES = (
    ("stand.id", "Stand: name or number", "text"), ("stand.alpha_deg", "Elevation of the head's axis α, °", "decimal"),
    ("site.latitude_deg", "Latitude, °", "decimal"), ("site.gravity_m_s2", "or measured gravity, m/s²", "decimal"),
)  # fmt: skip
RARE = (
    ("time_since_power_on_s", "From switching on to the first row, s", "decimal"),
    ("stand.chi_deg", "Gyroscopes: elevation χ, °", "decimal"), ("count_time_s", "Pulses: count time, s", "decimal"),
    ("sample_rate_hz", "Raw log: samples a second", "decimal"),
    ("direction_sigma_deg", "Directions: known to, °", "decimal"),
)  # fmt: skip
"""Fields that only some sessions need."""
LABEL_OF = {key: label for key, label, _ in (*PLACES, *RARE)} | {
    "site.gravity_m_s2": "Measured gravity, m/s²",
    "unit": "Serial number of the unit", "unit_type": "Name of the type", "started_at": "Measured on",
    "operator": "Operator", "notes": "Notes", "block": "Kind of sensors", "programme": "Programme",
    "stand": "Stand: name or number", "sensors": "Sensors", "table": "Table", "columns": "Columns", "file": "File",
    "table.sheet": "Sheet", "table.encoding": "Encoding", "table.separator": "Columns parted by",
    "table.record": "Only rows that begin with",
    "table.decimal": "Decimal sign", "table.header_row": "Headings in row", "table.first_row": "Readings from row",
}  # fmt: skip
"""Names of the fields of a session and of its table's settings."""
OF_SENSOR = {
    "nominal_axis": "{name}: input axis", "nominal_scale": "{name}: scale factor",
    "reading_unit": "{name}: unit of readings", "kind": "{name}: kind",
}  # fmt: skip
SENSOR = re.compile(r"sensors\[(\d+)\](?:\.(\w+))?")
COLUMN = re.compile(r"columns\[(\d+)\]")
IN_FORM = {
    "missing, and latitude_deg too; accelerometers need one of them": "missing, and the latitude too; give one of them",
    "is the text {value}; write a number, without quotes and with a decimal point": "is {value}; write a number",
    "give the three components of the input axis in block axes": (
        "give x y z in block axes, or azimuth and elevation in degrees"
    ),
    "a list of {value}": "not three numbers",
    "is {value}; write it like 2026-03-01T09:00:00Z": "is {value}; choose the day, the time and its zone",
    "the column is missing; the table needs it, with one value per row": (
        "no column is read as this yet; choose it among the columns"
    ),
    "the column is missing; {programme} needs it, or sample_rate_hz for a raw log": (
        "no column is read as this yet; choose it among the columns, or give the samples a second of a raw log"
    ),
    "is given without directions; add the columns {directions} or remove it": (
        "is given without directions; choose their columns, or empty this field"
    ),
    "is for gyroscopes, and this session has none; give readings as a rate": (
        "is for gyroscopes, and this session has none; empty this field"
    ),
    "missing; {programme} needs id and alpha_deg or chi_deg": "missing; give its name and the elevation of its axis",
    "{axes} of kind {kind}; a block needs at least {fewest}": (
        "{axes} of kind {kind}; a block needs at least {fewest}: choose their columns"
    ),
    "give {columns}": "choose what it means among the columns",
    "another column is also read as {meaning}; remove one": "another column is also read as {meaning}; leave one out",
    "has no rows; give one row per reading": "no column is read as anything yet; choose them",
}
"""Templates of a file's faults in terms of its keys or its notation, and their wording in a form."""


def said_on_page(problems: Sequence[Problem], mapping: Mapping[str, Any]) -> tuple[Problem, ...]:
    """The faults of a mapping under the labels of its page."""
    return tuple(Problem(_label(p.field, mapping), _in_form(p.message), p.row) for p in problems)


def _label(field: str, mapping: Mapping[str, Any]) -> str:
    if match := SENSOR.match(field):
        name = str(_entry(mapping["session"].get("sensors"), match[1]).get("name", match[1]))
        return say(OF_SENSOR.get(match[2] or "", "{name}"), name=name)
    if match := COLUMN.match(field):
        return say("column {heading}", heading=str(_entry(mapping["columns"], match[1]).get("heading", match[1])))
    if field.endswith("_se"):
        return say("standard error of {name}", name=field.removesuffix("_se"))
    return LABEL_OF.get(field) or LABELS.get(field, field)


def _entry(entries: Any, number: str) -> Mapping[str, Any]:
    found = entries[int(number) - 1] if isinstance(entries, list) and int(number) <= len(entries) else {}
    return found if isinstance(found, Mapping) else {}


def _in_form(text: str) -> str:
    if not isinstance(text, Message):
        return IN_FORM.get(text, text)
    parts = {name: _in_form(part) for name, part in text.parts.items()}
    return Message(IN_FORM.get(text.template, text.template), parts, text.many, text.number)
