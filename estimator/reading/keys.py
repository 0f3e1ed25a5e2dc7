"""The keys of a session file, and the unknown ones that are mistakes rather than additions.

A file may carry keys of its own. One that looks like a known key with another unit, like a slip of the pen, or like a
known key in the wrong place would change the result in silence if it were ignored: it is a problem.
"""

import re
from collections.abc import Iterable
from difflib import get_close_matches
from itertools import islice

from estimator.message import joined, say
from estimator.reading.fields import Fields

FORMAT = "imu-session/1"
"""Required value of ``format``; docs/session-file.md describes it."""
TOP = (
    "format", "unit", "unit_type", "block", "programme", "started_at", "powered_on_at", "time_since_power_on_s",
    "operator", "notes", "stage", "origin", "site", "stand", "mounting", "sensors", "table", "count_time_s", "counter",
    "sample_rate_hz", "direction_sigma_deg", "screening",
)  # fmt: skip
SITE = ("latitude_deg", "height_m", "gravity_m_s2")
STAND = ("id", "alpha_deg", "chi_deg", "sigma_arcsec", "sigma_count_time_s")
SIGMA = ("theta_x", "theta_y", "alpha", "beta", "latitude", "meridian", "wobble")
SENSOR = (
    "name", "kind", "nominal_axis", "nominal_scale", "nominal_offset", "reading_unit",
    "bias_repeatability_m_s2", "bias_repeatability_rad_s", "position_m",
)  # fmt: skip
DIRECTIONS = ("direction_x", "direction_y", "direction_z")
COLUMNS = (
    "run", "beta_deg", "time_s", "temperature_c", "vibration_m_s2", "tilt_se_deg", "turn_angle_deg", "turn_rate_deg_s",
    "position", *DIRECTIONS,
)  # fmt: skip
"""The keys of every object of a session file, and the columns beside the sensors' own: docs/session-file.md."""

HOME = dict.fromkeys(SITE, "site") | dict.fromkeys(STAND[1:], "stand") | {"nominal_axis": "sensors[]"}
HOME |= dict.fromkeys((key for key in TOP if "_" in key), "the top level")
"""Where a key belongs that could stand nowhere else by intent."""
UNITS = (
    "deg", "degrees", "rad", "mrad", "urad", "arcsec", "arcmin", "s", "sec", "ms", "us", "ns", "min", "h", "hours",
    "c", "k", "f", "celsius", "kelvin", "m", "km", "cm", "mm", "ft", "m_s2", "g", "mg", "ug", "gal", "mgal",
    "hz", "khz", "rad_s", "deg_s", "deg_h", "dps",
)  # fmt: skip
"""Endings of keys for values in a unit of the writer's own."""
UNIT_ENDING = re.compile(r"_(deg|m|s|c|hz|m_s2|rad_s|arcsec)$")
"""The units that known keys end with."""
UNKNOWN_LOOKED_AT = 200
"""Unknown keys of one object that are compared with known ones: bounds the work on a hostile file."""
LONGEST_KEY = 40
"""Characters; a longer key is no slip of a known one, and comparing it takes long."""
ALIKE = 0.8
"""Likeness (difflib's ratio) from which a key is taken for a slip: one letter of five may differ."""


def check_keys(fields: Fields, known: tuple[str, ...]) -> None:
    """Record unknown keys that look like known ones."""
    for key in islice((str(key) for key in fields.values if key not in known), UNKNOWN_LOOKED_AT):
        if meant := meant_key(key, known):
            fields.add(key, "is not a key of {path}; {suggestion}", path=fields.path or "the file", suggestion=meant)
        elif key in HOME and HOME[key] != fields.path:
            fields.add(key, "is in the wrong place; it belongs in {home}", home=HOME[key])


def meant_key(key: str, known: Iterable[str]) -> str | None:
    """The suggestion for an unknown key that looks like a known one."""
    if len(key) > LONGEST_KEY:
        return None
    plain = key.strip().lower().replace("-", "_").replace(" ", "_")
    in_other_unit = [name for name in known if _same_but_unit(plain, name)]
    if in_other_unit:
        return say("give the value as {in_other_unit}, in that unit", in_other_unit=joined(" or ", in_other_unit))
    close = get_close_matches(plain, list(known), n=1, cutoff=ALIKE)
    return say("did you mean {close}? Otherwise give it a name of its own", close=close[0]) if close else None


def _same_but_unit(key: str, known: str) -> bool:
    base = UNIT_ENDING.sub("", known)
    if base == known or not key.startswith(base):
        return False
    ending = key[len(base) :].lstrip("_")
    return ending == "" or ending in UNITS
