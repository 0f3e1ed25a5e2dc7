"""A life as a crew enters it: uploads and services one after another, some late, twice, mistyped or put right later."""

from dataclasses import dataclass
from datetime import timedelta
from typing import Any, Literal

from tests.lives.generator.kinds import Random
from tests.lives.generator.life import Life, Measured, Serviced
from tests.lives.generator.sessions import BEGIN, draw_block, session_of, started_at

What = Literal["upload", "service", "withdraw", "supersede"]
LATE = (60, 300)
"""Days after which a late entry is made."""
SLIPS = {"": 0.8, "late": 0.06, "twice": 0.04, "wrong date": 0.04, "wrong serial": 0.03, "corrected": 0.03}
"""Slips with an upload, and how often each happens."""


@dataclass(frozen=True, eq=False)
class Entry:
    """One thing that a crew does with the service."""

    day: float
    """Day of the entry, since the first session of the life."""
    what: What
    slip: str
    """Slip in it, or the one that it puts right; empty where there is none."""
    key: int
    """Number of an upload; for a withdrawal that of the upload, or of the service, that is taken back; for a correction
    that of the upload that is replaced.
    """
    document: dict[str, Any]
    """Session file of an upload or a correction; body that is posted of a service or a withdrawal."""
    takes_back: Literal["", "session", "service"] = ""

    @property
    def at(self) -> str:
        """Moment of the entry."""
        return (BEGIN + timedelta(days=self.day)).isoformat()


def entries(life: Life, rng: Random) -> tuple[Entry, ...]:
    """All entries of a life in the order in which they are made; in the end every mistake is put right."""
    block, made = draw_block(life, rng), list[Entry]()
    for key, one in enumerate(life.sessions):
        slip = str(rng.choice(list(SLIPS), p=list(SLIPS.values())))
        made += _uploads(key, one, slip, session_of(life, block, one, rng), rng)
    for key, service in enumerate(life.services):
        made += _service(key, service, rng)
    return tuple(sorted(made, key=lambda entry: entry.day))


def accepted(made: tuple[Entry, ...]) -> tuple[Entry, ...]:
    """The uploads and services that count in the end, by the date of what they are about."""
    replaced = {(one.takes_back, one.key) for one in made if one.takes_back}
    first = [
        one for one in made if one.what == "upload" and one.slip != "twice" and ("session", one.key) not in replaced
    ]
    right = [one for one in made if one.what == "supersede"]
    services = [one for one in made if one.what == "service" and ("service", one.key) not in replaced]
    return tuple(
        sorted([*first, *right, *services], key=lambda one: str(one.document.get("started_at") or one.document["at"]))
    )


def _uploads(key: int, one: Measured, slip: str, document: dict[str, Any], rng: Random) -> list[Entry]:
    day, later = one.day + 0.2, one.day + float(rng.uniform(*LATE))
    if slip == "late":
        return [Entry(later, "upload", slip, key, document)]
    first = Entry(day, "upload", "", key, document)
    if slip == "twice":
        return [first, Entry(day + 0.1, "upload", slip, key, document)]
    wrong = _spoilt(one, slip, document, rng)
    if not wrong:
        return [first]
    return [
        Entry(day, "upload", slip, key, wrong),
        Entry(later, "supersede", slip, key, document, takes_back="session"),
    ]


def _spoilt(one: Measured, slip: str, document: dict[str, Any], rng: Random) -> dict[str, Any]:
    """The document as it was first sent; empty where it was right."""
    if slip == "wrong date":
        away = 365 if rng.random() < 0.5 else 30
        return {**document, "started_at": started_at(max(one.day - away, 0) + 0.01)}
    if slip == "wrong serial":
        serial = str(document["unit"])
        return {**document, "unit": serial.replace("0", "O", 1) if "0" in serial else serial + "1"}
    if slip == "corrected":
        sensor = document["sensors"][0]["name"]
        table = {**document["table"], sensor: [*document["table"][sensor][:-1], document["table"][sensor][0]]}
        return {**document, "table": table}
    return {}


def _service(key: int, one: Serviced, rng: Random) -> list[Entry]:
    body = {"kind": one.kind, "at": started_at(one.day), "note": f"day {one.day}", "by": "R. Lind"}
    later = one.day + float(rng.uniform(*LATE))
    if one.recorded == "in time":
        return [Entry(one.day + 0.3, "service", "", key, body)]
    if one.recorded == "late":
        return [Entry(later, "service", "late", key, body)]
    number = len(SLIPS) * 1000 + key
    wrong = {**body, "at": started_at(max(one.day - 30 * int(rng.integers(1, 4)), 0))}
    back = {"by": "R. Lind", "why": "wrong date"}
    return [
        Entry(one.day + 0.3, "service", "wrong date", key, wrong),
        Entry(later, "withdraw", "wrong date", key, back, takes_back="service"),
        Entry(later + 0.1, "service", "", number, body),
    ]
