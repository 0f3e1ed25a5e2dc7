"""Two halves of one hall that live the same life, with types and stands of their own: in one half files have gross
readings and recordings fail, which are set aside or taken back. In the end both halves must say the same.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st
from hypothesis.stateful import initialize, rule

from estimator import calibrate, read_session
from tests.databases import Databases
from tests.lives.faults import DRAWN, WITHIN, off, recorded
from tests.lives.generator.faults import FAILURES, SLIPS, failing, gross
from tests.lives.life import lived
from tests.lives.quiet import wait_until_quiet
from tests.lives.service import Service
from tests.lives.steps import BY, NUMBERS, WHICH
from tests.lives.units import Document, day
from tests.lives.uploads import Uploads
from tests.lives.world import FindError, World, opened

SERIALS = ("LV-101", "LV-102", "HM-460", "FL-790")
"""The first two are of one type and on the same stands."""
STRUCK = ("LV-101", "HM-460")
"""Units whose files have gross readings; their neighbours' files have none."""
TWIN = " twin"
LITTLE = 0.5
"""Standard uncertainties by which sensors without a gross reading may differ: errors that a stand gives to all sensors
of a session are told by a few readings less."""
DAYS = 1
"""Days by which the dates of a unit may differ."""
SAME = 1e-3
"""Standard uncertainties by which figures of files differ that differ in a last digit."""
LAST_DIGIT = 1e-9
OPPOSITE = {"pass", "fail"}


def twin_of(document: Document) -> Document:
    """The file for the other half, with a last digit of its own: readings that are stored twice are questioned."""
    name = document["sensors"][0]["name"]
    cells = document["table"][name]
    made = {**document, "unit": document["unit"] + TWIN}
    made["table"] = {**document["table"], name: [*cells[:-1], cells[-1] * (1 + LAST_DIGIT)]}
    if "unit_type" in made:
        made["unit_type"] += TWIN
    if "stand" in made:
        made["stand"] = {**made["stand"], "id": made["stand"]["id"] + TWIN}
    return made


@dataclass
class Halves:
    """Sessions that were sent in both halves."""

    pairs: list[tuple[str, str]] = field(default_factory=list)
    """Sessions of the two halves."""
    struck: dict[str, set[str]] = field(default_factory=dict)
    """Sensors with a gross reading, by session of the second half."""


class Twins(Uploads):
    """Steps that are taken in both halves."""

    halves: Halves

    @initialize(drawn=st.integers(1, 2**32))
    def begins(self, drawn: int) -> None:
        """Begins with a reference that has a gross reading, and a neighbour that has none."""
        assume(drawn)
        self.sends("LV-102", 0, None, drawn)
        self.sends("LV-101", 0, list(SLIPS)[drawn % len(SLIPS)], drawn)
        self.sends("FL-790", 0, None, drawn)

    @rule(
        serial=st.sampled_from(SERIALS),
        number=NUMBERS,
        slip=st.sampled_from([None, *SLIPS]),
        drawn=DRAWN,
    )
    def sends(self, serial: str, number: int, slip: str | None, drawn: int) -> None:
        """A session, which in the second half may have a gross reading."""
        document = self.measured(serial, number)
        other, sensors = twin_of(document), set[str]()
        if slip is not None and serial in STRUCK:
            made = gross(other, slip, np.random.default_rng(drawn))
            other, sensors = made.document, {made.sensor}
        first, second = (self.upload(json.dumps(d).encode(), "twin.json") for d in (document, other))
        if first is None or second is None or (first["id"], second["id"]) in self.halves.pairs:
            self.expect(first is None or second, f"{slip} in {sorted(sensors)} of {serial}-{number} is refused")
            return
        what = f"{serial}-{number} with {slip} in {sorted(sensors)}: {second['reason']}"
        self.expect(first["state"] == second["state"], f"{what}; {first['state']} without, {second['state']} with it")
        self.expect({first["verdict"], second["verdict"]} != OPPOSITE, f"{what}; {first['verdict']} without it")
        self.halves.pairs.append((first["id"], second["id"]))
        self.halves.struck[second["id"]] = sensors

    @rule(number=NUMBERS, failure=st.sampled_from(list(FAILURES)), drawn=DRAWN)
    def takes_a_failing_recording_back(self, number: int, failure: str, drawn: int) -> None:
        """Records and withdraws in the second half alone."""
        document = self.world.benches["FL-790"].programmes["in-service"](number)
        faulty, sensor = failing(twin_of(document), failure, np.random.default_rng(drawn))
        if receipt := self.upload(json.dumps(faulty).encode(), "failing.json"):
            self.expect(sensor in receipt["reason"], f"{failure} of {sensor}: {receipt['reason']}")
            self.tries(f"/sessions/{receipt['id']}/withdraw", BY)

    @rule(which=WHICH, what=st.sampled_from(["withdraw", "accept"]))
    def changes_a_session(self, which: int, what: str) -> None:
        """Changes a session in both halves."""
        for id in self.halves.pairs[which % len(self.halves.pairs)]:
            self.tries(f"/sessions/{id}/{what}", BY)

    @rule(which=WHICH)
    def chooses_a_reference(self, which: int) -> None:
        """Chooses a reference in both halves."""
        for id in self.halves.pairs[which % len(self.halves.pairs)]:
            unit = self.world.get(f"/sessions/{id}")["unit"]
            self.tries(f"/units/{quote(unit)}/reference", BY | {"session": id})

    @rule(serial=st.sampled_from(SERIALS), number=NUMBERS, kind=st.sampled_from(["adjustment", "repair", "service"]))
    def services(self, serial: str, number: int, kind: str) -> None:
        """Records a service in both halves."""
        for unit in (serial, serial + TWIN):
            new = {"kind": kind, "at": day(number), "by": "R. Lind", "note": "shock"}
            self.tries(f"/units/{quote(unit)}/services", new)


def halves_agree(world: World, halves: Halves) -> None:
    """Compares all that is stated about sessions, units, types and stands."""
    for serial in SERIALS:
        if serial in world.units():
            _units_agree(world, serial, dict(halves.pairs), halves.struck)
    kinds = {one["name"]: one for one in world.listed("unit-types")}
    for name in kinds.keys() & {name.removesuffix(TWIN) for name in kinds if name.endswith(TWIN)}:
        _same(_plain(kinds[name]), _plain(kinds[name + TWIN]), f"type {name}")
    stands = {one["stand"]: one for one in world.get("/stands")["stands"]}
    for name in stands.keys() & {name.removesuffix(TWIN) for name in stands if name.endswith(TWIN)}:
        _stands_agree(stands[name], stands[name + TWIN])


def _units_agree(world: World, serial: str, twin: dict[str, str], struck: dict[str, set[str]]) -> None:
    ours, theirs = ({one["id"]: one for one in world.sessions(unit=unit)} for unit in (serial, serial + TWIN))
    for first, second in twin.items():
        if first in ours:
            one, other = ours[first], theirs[second]
            for name in ("state", "is_reference", "is_check", "stage"):
                _same(one[name], other[name], f"{name} of {first} and {second}")
            if {one["verdict"], other["verdict"]} == OPPOSITE:
                raise FindError(f"{first} is {one['verdict']}, {second} is {other['verdict']}: {other['reason']}")
    _figures_agree(world, serial, twin, struck)
    one, other = (world.get(f"/units/{quote(unit)}/outlook") for unit in (serial, serial + TWIN))
    if (one["due"] is None) != (other["due"] is None):
        raise FindError(f"{serial}: due {one['due']}, its twin {other['due']}")
    if one["due"] and abs((_date(one["due"]) - _date(other["due"])).days) > DAYS:
        raise FindError(f"{serial}: due {one['due']}, its twin {other['due']}")
    one, other = (world.get(f"/units/{quote(unit)}/usable") for unit in (serial, serial + TWIN))
    _same(one["use"], other["use"], f"{serial}: {one['why']} | {other['why']}: use")


def _figures_agree(world: World, serial: str, twin: dict[str, str], struck: dict[str, set[str]]) -> None:
    """Parameters of sessions: of a sensor with a gross reading near those without it, of all others nearly the same."""
    ours, theirs = (
        {(p["session"], p["sensor"], p["parameter"]): p for p in _history(world, unit)}
        for unit in (serial, serial + TWIN)
    )
    for (session, sensor, parameter), point in ours.items():
        second = twin.get(session, "")
        if (other := theirs.get((second, sensor, parameter))) is None:
            raise FindError(f"{serial}: {sensor} {parameter} of {session} is not told by {second}")
        right = calibrate(read_session(json.loads(world.stored[session]))) if struck[second] else None
        by = 0.0 if right is None else off(recorded(other, right.sensor(sensor)), right.sensor(sensor), parameter)
        most = WITHIN if sensor in struck[second] else LITTLE
        if by > most:
            raise FindError(f"{serial}: {sensor} {parameter} of {second} is off by {by:.2f} u")
        is_number = point["value"] is not None and parameter != "axis"
        near = SAME * (point["u"] or 0.0)
        if right is None and is_number and abs(point["value"] - other["value"]) > near:
            raise FindError(f"{serial}: {sensor} {parameter} of {second} is {other['value']}, not {point['value']}")


def _history(world: World, unit: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = world.get(f"/units/{quote(unit)}/history", params={"limit": 10000})["points"]
    return [point for point in found if point["session"] in {one["id"] for one in world.sessions(unit=unit)}]


def _stands_agree(one: dict[str, Any], other: dict[str, Any]) -> None:
    _same([one["sessions"], one["has_shifted"], len(one["shifts"])],
          [other["sessions"], other["has_shifted"], len(other["shifts"])], f"stand {one['stand']}")  # fmt: skip


def _plain(kind: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in kind.items() if not name.endswith("_at") and name != "name"}


def _same(one: Any, other: Any, what: str) -> None:
    if one != other:
        raise FindError(f"{what}: {one!r} is not {other!r}")


def _date(moment: str) -> date:
    return date.fromisoformat(moment[:10])


def twin_life(databases: Databases, folder: Path, number: int, steps: int, seen: Callable[[World], None]) -> None:
    """A life of both halves on a database of its own; ``seen`` is called with its world."""
    url, halves = databases.migrated(), Halves()
    try:
        with opened(Service(url, folder / "twins"), number) as world:
            seen(world)
            lived(type("OneHall", (Twins,), {"halves": halves}), world, number, steps)
            wait_until_quiet(world)
            halves_agree(world, halves)
    finally:
        databases.drop(url)
