"""The end of a life: nothing waits for ever, the state follows from the records alone, and a backup restores to it."""

import re
from time import monotonic
from typing import Any
from urllib.parse import quote

from tests.lives.world import FindError, World
from tests.patience import LONG, until

IDLE = 2.0
"""Seconds of computing in `LONG` seconds that a service uses which has nothing to do, many times over."""
AT_WORK = 1800.0
"""Seconds of computing after which the same things that still wait are taken as never coming."""
OPEN = ("waiting", "running")
FLAG = re.compile(r"\bFlag \d+")


def pending(world: World) -> frozenset[str]:
    """The names of all that is still being made."""
    world.forget()
    found = set[str]()
    for session in world.sessions("accepted"):
        if any(one["kind"] == "pending" for one in session["reservations"] or ()):
            found.add(f"session {session['id']}")
    for serial in world.units():
        found |= {f"unit {serial} {what}" for what in _of_unit(world, serial)}
    found |= {f"job {one['id']}" for one in world.listed("jobs") if one["state"] in OPEN}
    found |= {f"upload {one['id']}" for one in world.get("/uploads")["under_way"]}
    for model in world.listed("models"):
        made = world.get(f"/models/{model['id']}")["recomputations"]
        found |= {f"model {model['id']} {one['unit']}" for one in made if one["state"] in OPEN}
    return frozenset(found)


def _of_unit(world: World, serial: str) -> set[str]:
    path = f"/units/{quote(serial, safe='')}"
    found = set()
    if world.get(f"{path}/derivation")["waiting"]:
        found.add("verdicts")
    if any("ask again" in reason for reason in world.get(f"{path}/usable")["reasons"]):
        found.add("dates")
    if world.send(f"{path}/diagnosis", method="GET").status_code == 202:
        found.add("group")
    return found


def wait_until_quiet(world: World) -> None:
    """Waits until nothing is being made any more. Progress counts: work that waits for an idle service, or is done
    without end, is a find.
    """
    left, since, computed = frozenset({""}), monotonic(), world.service.count_processor()

    def is_quiet() -> bool:
        nonlocal left, since, computed
        now, spent = pending(world), world.service.count_processor()
        if now != left:
            left, since, computed = now, monotonic(), spent
        waited, worked = monotonic() - since, spent - computed
        if (waited > LONG / 2 and worked < IDLE + 0.1 * waited) or worked > AT_WORK:
            raise FindError(f"waits for ever, after {waited:.0f} s with {worked:.0f} s of computing: {sorted(left)}")
        return not now

    while True:
        try:
            until(is_quiet)
            return
        except AssertionError:
            continue


def state(world: World) -> dict[str, Any]:
    """The state of all units, without times and numbers of writing."""
    world.forget()
    return {serial: _unit(world, serial) for serial in world.units() if _counted(world, serial)}


def _counted(world: World, serial: str) -> list[dict[str, Any]]:
    return world.sessions("accepted", unit=serial)


def _unit(world: World, serial: str) -> dict[str, Any]:
    path = f"/units/{quote(serial, safe='')}"
    points = world.get(f"{path}/history", params={"limit": 10000})["points"]
    flags = [one for one in world.get(f"{path}/flags")["flags"] if one["state"] != "resolved"]
    usable, outlook = world.get(f"{path}/usable"), world.get(f"{path}/outlook")
    names = ("id", "verdict", "said", "reason", "is_reference", "is_check", "stage", "started_at")
    return {
        "sessions": sorted(([one[name] for name in names] for one in _counted(world, serial)), key=lambda one: one[0]),
        "history": [_without(point, "revision") for point in points],
        "outlook": outlook,
        "usable": _without_numbers(_without(usable, "as_of")),
        "flags": sorted((one["matter"], one["summary"], one["proposal"]) for one in flags),
    }


def _without_numbers(value: Any) -> Any:
    """Flags are counted as they are raised."""
    if isinstance(value, dict):
        return {name: _without_numbers(one) for name, one in value.items()}
    if isinstance(value, list):
        return [_without_numbers(one) for one in value]
    return FLAG.sub("Flag", value) if isinstance(value, str) else value


def _without(found: dict[str, Any], *names: str) -> dict[str, Any]:
    return {name: value for name, value in found.items() if name not in names}


def differences(one: Any, other: Any, at: str = "") -> list[str]:
    """Places where two states differ."""
    if isinstance(one, dict) and isinstance(other, dict):
        return [
            line
            for name in sorted({*one, *other})
            for line in differences(one.get(name), other.get(name), f"{at}/{name}")
        ]
    if isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        return [
            line
            for number, (mine, theirs) in enumerate(zip(one, other, strict=True))
            for line in differences(mine, theirs, f"{at}/{number}")
        ]
    return [] if one == other else [f"{at}: {str(one)[:300]} ≠ {str(other)[:300]}"]
