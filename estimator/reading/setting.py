"""Circumstances of a session: site, stand, mounting, date. Degrees and arcseconds become radians here."""

import math
from dataclasses import replace
from datetime import datetime

import numpy as np

from estimator.moments import DAY, as_stated, moment
from estimator.reading.bounds import WITHIN
from estimator.reading.columns import vector
from estimator.reading.fields import Fields
from estimator.reading.interval import Interval
from estimator.reading.keys import SIGMA, SITE, STAND, check_keys
from estimator.reading.problems import Problems, shown
from estimator.session import (
    ACCELEROMETER,
    ARBITRARY_ORIENTATIONS,
    GYROSCOPE,
    ROTATION_ALIGNMENT,
    THERMAL,
    TWO_AXIS_STAND,
    Array,
    Site,
    Stand,
    StandErrors,
)

ARCSEC = math.pi / 648_000
"""rad."""
FLATTEST = 0.01
"""Degrees by which the head's axis must stay clear of 0° and 90°, where bias and scale become inseparable."""
ROTATION_TOLERANCE = 1e-6
"""Tolerance on products of rows that should be 0 or 1: a mounting written with seven digits, known to 0.2″."""
YEARS = Interval(1950, 2200)
"""Strapdown systems are younger; later is a slip."""
POWERED_ON, SINCE_POWER_ON = "powered_on_at", "time_since_power_on_s"
"""The keys that tell when the unit was switched on: a moment, or how long that was before the first row."""
NEEDS_GRAVITY = (TWO_AXIS_STAND, ARBITRARY_ORIENTATIONS, ROTATION_ALIGNMENT, THERMAL)
NEEDS_LATITUDE = (TWO_AXIS_STAND, ROTATION_ALIGNMENT)
"""Programmes whose accelerometers need gravity, and whose gyros the latitude."""


def read_site(document: Fields, programme: str, kinds: set[str]) -> Site:
    """The site; records what the applied vectors need and it lacks."""
    site = document.child("site") or Fields({}, "site", document.problems)
    check_keys(site, SITE)
    latitude = site.optional_number("latitude_deg", WITHIN["site.latitude_deg"])
    height = site.optional_number("height_m", WITHIN["site.height_m"])
    if ACCELEROMETER in kinds and programme in NEEDS_GRAVITY and not _any(site, "latitude_deg", "gravity_m_s2"):
        site.add("gravity_m_s2", "missing, and latitude_deg too; accelerometers need one of them")
    if GYROSCOPE in kinds and programme in NEEDS_LATITUDE and not site.has("latitude_deg"):
        site.add("latitude_deg", "missing; gyroscopes need it for the Earth's rotation")
    return Site(
        latitude=None if latitude is None else math.radians(latitude),
        height=0.0 if height is None else height,
        gravity=site.optional_number("gravity_m_s2", WITHIN["site.gravity_m_s2"]),
    )


def read_stand(document: Fields, programme: str, kinds: set[str]) -> Stand | None:
    """The stand; required, with the elevation that each kind of sensor needs, for the two-axis programme."""
    stand = document.child("stand")
    if stand is None:
        if programme == TWO_AXIS_STAND and not document.has("stand"):
            document.add("stand", "missing; {programme} needs id and alpha_deg or chi_deg", programme=programme)
        return None
    check_keys(stand, STAND)
    needed = kinds if programme == TWO_AXIS_STAND else set()
    return Stand(
        id=stand.required_text("id", "give the stand's name or number"),
        alpha=_read_elevation(stand, "alpha_deg", ACCELEROMETER in needed, programme),
        chi=_read_elevation(stand, "chi_deg", GYROSCOPE in needed, programme),
        sigma=_read_sigma(stand),
    )


def read_mounting(document: Fields) -> Array:
    """(3, 3) dimensionless rotation platform → block; identity when not given."""
    value = document.values.get("mounting")
    if value is None:
        return np.eye(3)
    rows = value.tolist() if isinstance(value, np.ndarray) else value
    if not isinstance(rows, list | tuple) or len(rows) != 3:
        document.add("mounting", "is {rows}; must be three rows of three numbers", rows=shown(rows))
        return np.eye(3)
    row_fields = Fields({f"[{i}]": row for i, row in enumerate(rows, 1)}, "", document.problems)
    matrix = np.array([_mounting_row(row_fields, f"[{i}]", document.problems) for i in (1, 2, 3)])
    if np.isfinite(matrix).all() and not _is_rotation(matrix):
        document.add("mounting", "is not a rotation; its rows must be orthogonal unit vectors of a right-handed triad")
    return matrix


def read_moment(document: Fields, key: str) -> str | None:
    """A moment with its offset from UTC, ISO 8601; None when not given."""
    text = document.optional_text(key)
    if text is None:
        return None
    try:
        at = datetime.fromisoformat(text)
    except ValueError:
        document.add(key, "is {value}; write it like 2026-03-01T09:00:00Z", value=shown(text))
        return None
    if at.tzinfo is None:
        document.add(key, "{value} has no offset; end it with Z for UTC or with one like +03:00", value=shown(text))
    elif at.year not in YEARS:
        document.add(key, "is in the year {year}; must be {years}", year=at.year, years=YEARS)
    else:
        return as_stated(at)
    return None


def read_time_since_power_on(document: Fields, started_at: str | None) -> float | None:
    """s, from switching on to the first row, which is measured at ``started_at``; None when neither key says it."""
    passed = document.optional_number(SINCE_POWER_ON, WITHIN[SINCE_POWER_ON])
    at = read_moment(document, POWERED_ON)
    if at is None:
        return passed
    if document.has(SINCE_POWER_ON):
        document.add(POWERED_ON, "is given beside {other}; give one of the two", other=SINCE_POWER_ON)
    elif started_at is not None:
        return _between(document, moment(at), moment(started_at))
    elif not document.has("started_at"):
        document.add(POWERED_ON, "needs started_at; give that too, or {other} instead", other=SINCE_POWER_ON)
    return None


def _between(document: Fields, on: datetime, start: datetime) -> float | None:
    """s from switching on to the start; None, and a problem, where that cannot be."""
    within, passed = WITHIN[SINCE_POWER_ON], (start - on).total_seconds()
    if passed < 0:
        document.add(POWERED_ON, "is later than started_at; the unit was on when its first row was measured")
    elif passed not in within:
        most = within.high / DAY
        document.add(POWERED_ON, "is more than {most} days before started_at; check both", most=f"{most:.0f}")
    else:
        return passed
    return None


def _any(fields: Fields, *keys: str) -> bool:
    return any(fields.has(key) for key in keys)


def _read_elevation(stand: Fields, key: str, required: bool, programme: str) -> float | None:
    if required and not stand.has(key):
        stand.add(key, "missing; give the elevation of the head's axis in degrees")
    degrees = stand.optional_number(key, WITHIN[f"stand.{key}"])
    if degrees is None:
        return None
    if programme == TWO_AXIS_STAND and not FLATTEST <= abs(degrees) <= 90 - FLATTEST:
        stand.add(
            key,
            "is {degrees}; must be strictly between 0 and 90 degrees, else parameters cannot be separated",
            degrees=f"{degrees:g}",
        )
    return math.radians(degrees)


def _read_sigma(stand: Fields) -> StandErrors:
    count_time = stand.optional_number("sigma_count_time_s", WITHIN["stand.sigma_count_time_s"]) or 0.0
    sigma = stand.child("sigma_arcsec")
    if sigma is None:
        return StandErrors(count_time=count_time)
    check_keys(sigma, SIGMA)
    stated = {name: sigma.optional_number(name, WITHIN["stand.sigma_arcsec"]) for name in SIGMA}
    angles = {name: ARCSEC * angle for name, angle in stated.items() if angle is not None}
    return replace(StandErrors(**angles), count_time=count_time)


def _mounting_row(rows: Fields, key: str, problems: Problems) -> Array:
    named = Fields({f"mounting{key}": rows.values[key]}, "", problems)
    return vector(named, f"mounting{key}", "must be a row of three numbers")


def _is_rotation(matrix: Array) -> bool:
    orthonormal = np.abs(matrix @ matrix.T - np.eye(3)).max() <= ROTATION_TOLERANCE
    return bool(orthonormal and np.linalg.det(matrix) > 0)
