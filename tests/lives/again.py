"""Repeats the records: uploaded in order of their dates to a fresh service, and restored from a backup."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import quote

from sqlalchemy import create_engine, update

from estimator.session import CALIBRATIONS, IN_SERVICE
from service.app import utc_now
from service.kit.metrics import Metrics
from service.sessions.tables import CalibrationRow
from service.settings import Settings
from service.work.watch import look
from tests.databases import Databases
from tests.lives.quiet import differences, state, wait_until_quiet
from tests.lives.service import Service
from tests.lives.world import FindError, World, opened
from tests.stock import stores

BY = {"by": "K. Ito", "why": "as before"}
REVISION = re.compile(r"rev (\d+)\)$")
"""Revision at the end of the rule that a parameter was judged by."""
MOST = 12
"""Differences of one comparison that are printed."""


def settle(world: World) -> None:
    """Takes back what depends on when it was said: models hold from then on, and a file without a date has that of its
    upload. Then what is done every hour is done at once, and once more, for the first time tells types what their units
    teach."""
    undated = [one for one in world.sessions("accepted") if one["started_at"] == one["uploaded_at"]]
    for session in [*world.sessions("questioned"), *undated]:
        world.send(f"/sessions/{session['id']}/withdraw", BY)
    for model in world.listed("models"):
        world.send(f"/models/{model['id']}/withdraw", BY)
    wait_until_quiet(world)
    if world.is_dated:
        for serial in world.units():
            world.send(f"/units/{quote(serial, safe='')}/recalibrate")
        wait_until_quiet(world)
    settings = Settings(database_url=world.service.database, data_folder=world.service.folder / "data")
    with stores(settings) as storage:
        for _ in range(2):
            if not look(storage, utc_now, Metrics()):
                raise FindError("the hourly look at the fleet failed")
    wait_until_quiet(world)


def same_of_the_records(world: World, databases: Databases, folder: Path) -> None:
    """The state is a function of the accepted records, whatever their order and detours."""
    settle(world)
    url = databases.migrated()
    with opened(Service(url, folder / "fresh"), world.chance.randrange(2**31)) as fresh:
        _replay(world, fresh)
        _replay_types(world, fresh)
        fresh.is_dated = world.is_dated
        settle(fresh)
        if _resolve_again(world, fresh):
            settle(fresh)
        _compare(state(world), state(fresh), "the same records in order of their dates")
        world.service.processor += fresh.service.count_processor()
    databases.drop(url)


def same_of_the_backup(world: World, databases: Databases, folder: Path) -> None:
    """A backup that is made while the service runs is whole, and restores to the same."""
    file, url = folder / "life.backup", databases.empty()
    before, restored = state(world), Service(url, folder / "restored")
    steps = (
        ("backup", str(file), *world.service.where),
        ("backup", str(file), "--check"),
        ("restore", str(file), *restored.where),
    )
    for arguments in steps:
        code, output = world.service.command(*arguments)
        if code:
            raise FindError(f"imu-health {' '.join(arguments)} → {code}: {output}")
    with opened(restored, 0) as again:
        again.http.headers.update({k: v for k, v in world.http.headers.items() if k == "authorization"})
        wait_until_quiet(again)
        _compare(before, state(again), "restored from a backup")
        world.service.processor += restored.count_processor()
    databases.drop(url)


def _compare(one: dict[str, Any], other: dict[str, Any], what: str) -> None:
    found = differences(one, other)
    if found:
        raise FindError(f"{what}: {len(found)} differences\n" + "\n".join(found[:MOST]))


def _replay(world: World, fresh: World) -> None:
    """Sessions in order of their dates, after those that types began with. Each is judged by the tolerances that held
    when it was computed."""
    types = {serial: world.get(f"/units/{quote(serial, safe='')}")["summary"]["unit_type"] for serial in world.units()}
    begun, first = _begin_types(world, fresh, types), _first_of_units(world)
    counted = [(_revision(world, one["id"]), one) for one in world.sessions("accepted")]
    for number, session in sorted(counted, key=lambda own: _in_order(own[0], own[1], first)):
        _bring_to_revision(world, fresh, types[session["unit"]], number)
        if session["id"] not in begun:
            _upload_again(world, fresh, session)
        elif number > _revision(fresh, session["id"]):
            _compute_now(fresh, session["id"])
        _bring_to_state(fresh, session)
    wait_until_quiet(fresh)
    for _, session in counted:
        _bring_to_state(fresh, session)
    for unit, service in world.services.values():
        if unit in fresh.units():
            fresh.send(f"/units/{quote(unit, safe='')}/services", service)
    for path, certificate in world.certificates:
        fresh.send(path, certificate, "PUT")
    known = {session["id"] for _, session in counted}
    for id in (id for id in world.chosen if id in known):
        unit = next(session["unit"] for _, session in counted if session["id"] == id)
        fresh.send(f"/units/{quote(unit, safe='')}/reference", BY | {"session": id})


def _first_of_units(world: World) -> set[str]:
    """The sessions that named a unit's type, where others of the same unit name none and would have begun another."""
    typeless = {session["unit"] for session in world.sessions() if session["id"] in world.typeless}
    first = dict[str, str]()
    for session in sorted(world.sessions(), key=lambda one: one["uploaded_at"]):
        if session["unit"] in typeless:
            first.setdefault(session["unit"], session["id"])
    return set(first.values())


def _in_order(number: int, session: dict[str, Any], first: set[str]) -> tuple[int, bool, bool, str, str]:
    """Sort key by revision of the tolerances and date; recordings in service come after their reference."""
    is_later = session["id"] not in first
    return number, is_later, session["programme"] == IN_SERVICE, session["started_at"] or "", session["id"]


@contextmanager
def _calibrated(world: World, fresh: World, session: dict[str, Any]) -> Iterator[None]:
    """While a recording in service is uploaded its unit has a calibration, if only one that counts no longer."""
    missing = session["programme"] == IN_SERVICE and not _calibrations(fresh, session["unit"], "accepted")
    lent = _calibrations(world, session["unit"], "withdrawn", "superseded")[:1] if missing else []
    for one in lent:
        if one["id"] not in {own["id"] for own in fresh.sessions()}:
            _upload_again(world, fresh, one)
            fresh.forget()
        if one["id"] not in {own["id"] for own in _calibrations(fresh, one["unit"], "accepted")}:
            fresh.send(f"/sessions/{one['id']}/accept", BY)
    yield
    for one in lent:
        fresh.send(f"/sessions/{one['id']}/withdraw", BY)


def _calibrations(world: World, unit: str, *states: str) -> list[dict[str, Any]]:
    return [one for one in world.sessions(*states, unit=unit) if one["programme"] in CALIBRATIONS]


def _begin_types(world: World, fresh: World, types: dict[str, str]) -> set[str]:
    """Uploads what each type began with, also where that counts no longer: a type is what its first session says, and a
    unit is of the type that its first session names."""
    first, of_units = dict[str, dict[str, Any]](), _first_of_units(world)
    for session in sorted(world.sessions(), key=lambda one: one["uploaded_at"]):
        if session["unit"] in types:  # no unit until one of its sessions is accepted
            first.setdefault(types[session["unit"]], session)
            if session["id"] in of_units and session["state"] != "accepted":
                first.setdefault(session["id"], session)
    begun = {session["id"]: session for session in first.values()}
    for session in begun.values():
        _upload_again(world, fresh, session)
        if session["state"] != "accepted":
            fresh.send(f"/sessions/{session['id']}/withdraw", BY)
    return set(begun)


def _upload_again(world: World, fresh: World, session: dict[str, Any]) -> None:
    content = world.ask("GET", f"/api/v1/sessions/{session['id']}/file").content
    params = {"check": "true"} if session["is_check"] else {}
    with _calibrated(world, fresh, session):
        answer = fresh.ask("POST", "/api/v1/sessions", files={"file": (session["filename"], content)}, params=params)
    if answer.status_code != 201 or answer.json()["id"] != session["id"]:
        raise FindError(f"{session['id']} uploaded again → {answer.status_code}: {answer.text[:400]}")


def _revision(world: World, id: str) -> int:
    """Revision of the tolerances that a session was judged by."""
    found = [REVISION.search(one["rule"]) for one in world.get(f"/sessions/{id}")["decisions"]]
    return max((int(one[1]) for one in found if one), default=1)


def _bring_to_revision(world: World, fresh: World, name: str, number: int) -> None:
    """Sets a type's tolerances as they were then."""
    now = next(kind["revision"] for kind in fresh.listed("unit-types") if kind["name"] == name)
    for following in range(now + 1, number + 1):
        fresh.send(f"/unit-types/{quote(name, safe='')}", world.tolerances[name, following], "PUT")


def _compute_now(fresh: World, id: str) -> None:
    """Judges what a type began with by the tolerances as they are by now: in the life it was computed again when they
    held, under a model that counts no longer."""
    engine = create_engine(fresh.service.database)
    with engine.begin() as connection:
        own = update(CalibrationRow).where(CalibrationRow.session_id == id)
        connection.execute(own.values(computed_at=utc_now()))
    engine.dispose()
    for step in ("withdraw", "accept"):
        fresh.send(f"/sessions/{id}/{step}", BY)


def _bring_to_state(fresh: World, session: dict[str, Any]) -> None:
    now = fresh.get(f"/sessions/{session['id']}")
    if now["state"] == "questioned":
        fresh.send(f"/sessions/{session['id']}/accept", BY)
    if now["stage"] != session["stage"]:
        fresh.send(f"/sessions/{session['id']}/stage", {"by": BY["by"], "stage": session["stage"]}, "PUT")


def _resolve_again(world: World, fresh: World) -> bool:
    """Resolves what somebody resolved and no later session has shown again; whether there was any. A parameter's jump
    is flagged only where none of its sensor's is out of tolerance, so others may be raised in its place."""
    has_resolved = False
    for serial in fresh.units():
        path = f"/units/{quote(serial, safe='')}/flags"
        ours, theirs = world.get(path)["flags"], fresh.get(path)["flags"]
        opened = {(one["matter"], one["place"]) for one in ours if one["state"] != "resolved"}
        by_hand = {(one["matter"], one["place"]) for one in ours if one["state"] == "resolved"} - opened
        for one in theirs:
            if one["state"] != "resolved" and (one["matter"], one["place"]) in by_hand:
                fresh.send(f"/flags/{one['id']}/resolve", BY)
                has_resolved = True
    return has_resolved


def _replay_types(world: World, fresh: World) -> None:
    for kind in world.listed("unit-types"):
        path = f"/unit-types/{quote(kind['name'], safe='')}"
        new = {name: kind[name] for name in ("tolerances", "gyro_tolerances", "maximum_interval_days")}
        if new["tolerances"] is not None:
            fresh.send(path, new, "PUT")
    for serial in fresh.units():
        lot = world.get(f"/units/{quote(serial, safe='')}")["summary"]["lot"]
        fresh.send(f"/units/{quote(serial, safe='')}/lot", {"lot": lot}, "PUT")
