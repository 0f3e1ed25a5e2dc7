"""Oddities of a session file that are legal all the same: additions, omissions and other spellings."""

from collections.abc import Callable
from datetime import datetime, timedelta, timezone

from tests.lives.units import Document

Change = Callable[[Document], None]


def _without(*names: str) -> Change:
    def change(document: Document) -> None:
        for name in names:
            document.pop(name, None)

    return change


def _without_columns(ends: Callable[[str], bool]) -> Change:
    def change(document: Document) -> None:
        document["table"] = {name: cells for name, cells in document["table"].items() if not ends(name)}

    return change


def _in_zone(hours: float) -> Change:
    """Writes the moment as a clock of another place does."""

    def change(document: Document) -> None:
        if "started_at" in document:
            at = datetime.fromisoformat(document["started_at"])
            document["started_at"] = at.astimezone(timezone(timedelta(hours=hours))).isoformat()

    return change


def _warmer(by: float) -> Change:
    def change(document: Document) -> None:
        cells = document["table"].get("temperature_c")
        if cells:
            document["table"]["temperature_c"] = [cell + by for cell in cells]

    return change


def _in_other_order(document: Document) -> None:
    document["sensors"] = document["sensors"][::-1]


def _without_sigma(document: Document) -> None:
    if "stand" in document:
        document["stand"] = {k: v for k, v in document["stand"].items() if not k.startswith("sigma")}


def _without_gravity(document: Document) -> None:
    document["site"] = {k: v for k, v in document.get("site", {}).items() if k != "gravity_m_s2"} | {
        "latitude_deg": 55.81,
        "height_m": 160.0,
    }


def _placed(document: Document) -> None:
    for number, sensor in enumerate(document["sensors"]):
        sensor["position_m"] = [0.01 * number, -0.02, 0.0]


def _says(**fields: object) -> Change:
    return lambda document: document.update(fields)


ODDITIES: dict[str, Change] = {
    "no date": _without("started_at"),
    "zone +03:00": _in_zone(3),
    "zone +05:30": _in_zone(5.5),
    "zone -09:30": _in_zone(-9.5),
    "3 °C warmer": _warmer(3.0),
    "14 °C colder": _warmer(-14.0),
    "no temperature": _without_columns(lambda name: name == "temperature_c"),
    "no time": _without_columns(lambda name: name == "time_s"),
    "no standard errors": _without_columns(lambda name: name.endswith("_se")),
    "no stand sigma": _without_sigma,
    "no gravity": _without_gravity,
    "no mounting": _without("mounting"),
    "no type": _without("unit_type"),
    "sensors in other order": _in_other_order,
    "sensors placed": _placed,
    "as found": _says(stage="as-found"),
    "as left": _says(stage="as-left"),
    "operator": _says(operator="Å. Łukasz-O'Neill", notes="нет замечаний; =1+1 <b>"),
    "no operator": _without("operator", "notes"),
    "simulated": _says(origin="simulated"),
}
RARE = ("simulated", "no type", "no date")
"""Oddities that turn most of the later sessions into another unit's or another life's."""
