"""Kinds of columns: what a person says of one before saying which it is."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from estimator.session import ACCELEROMETER, GYROSCOPE
from service.ingest.layout.vocabulary import LETTERS

MEANINGS_OF = {
    "temperature": ("temperature_c",),
    "time": ("time_s",),
    "angle": ("beta_deg", "turn_angle_deg", "turn_rate_deg_s"),
    "run": ("run",),
    "position": ("position",),
    "direction": ("direction_x", "direction_y", "direction_z"),
    "quality": ("vibration_m_s2", "tilt_se_deg"),
}
"""Kinds beside those of sensors, with their columns of a session; a standard error is of quality too."""
IGNORED = "ignored"
KINDS = (ACCELEROMETER, GYROSCOPE, *MEANINGS_OF, IGNORED)
BY_MEANING = {meaning: kind for kind, meanings in MEANINGS_OF.items() for meaning in meanings}


def is_sensor(meaning: str) -> bool:
    """Whether a column is a sensor: columns of a session and standard errors are in lower case."""
    return bool(meaning) and meaning != meaning.lower() and not meaning.endswith("_se")


def kinds_of(meanings: Sequence[str | None], session: Mapping[str, Any]) -> list[str]:
    """The kind of each column; of a sensor as the session says, or else by its letter."""
    sensors = session.get("sensors")
    listed = sensors if isinstance(sensors, list | tuple) else ()
    stated = {str(s.get("name")): str(s.get("kind") or session.get("block")) for s in listed if isinstance(s, Mapping)}
    return [_kind(meaning or "", stated, str(session.get("block") or ACCELEROMETER)) for meaning in meanings]


def _kind(meaning: str, stated: Mapping[str, str], block: str) -> str:
    if not is_sensor(meaning):
        return BY_MEANING.get(meaning, "quality") if meaning else IGNORED
    by_letter = next((kind for kind, letter in LETTERS.items() if meaning.startswith(letter)), block)
    return stated.get(meaning, by_letter)


def first_of(kind: str, used: Collection[str | None]) -> str | None:
    """The first unused column of a kind; None where it is to be ignored, or none is left."""
    names = [f"{LETTERS[kind]}{k}" for k in range(1, len(used) + 2)] if kind in LETTERS else MEANINGS_OF.get(kind, ())
    return next((name for name in names if name not in used), None)
