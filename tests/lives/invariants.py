"""Invariants after every step: nothing failed beside the requests, all addresses can be read, pages agree."""

import html
import re
from collections import Counter
from collections.abc import Iterator
from datetime import date
from itertools import product
from typing import Any
from urllib.parse import quote

from service.fleet.use import WORDS, Use
from service.kit.measures import day_of
from tests.lives.world import API, FindError, World

HTML = {"Accept": "text/html"}
FAILED = re.compile(r'"level": "(error|critical)"|background work failed|Traceback|Task exception')
LINK = re.compile(r'(?:href|src|data-src)="(/[^"#]*)')
LEFT_OUT = re.compile(r"^/(static|sign-out|uploads/.*/file)|^/api/v1/openapi")
COSTLY = re.compile(r"certificate|pdf|label|/plan|xlsx")
"""Addresses of drawings and prints, some seconds each for the first of a process: read in long lives only."""
MOST_ALIKE = 2
"""Pages that differ in the values of their question only."""
QUERIES = {
    "/units/{serial}/history": ("format=csv", "format=parquet", "format=arrow", "parameter=bias", "raw=true"),
    "/sessions/{id}/export": ("system=px4", "system=ardupilot", "system=kalibr", "system=ros2"),
    "/sessions/{id}/certificate": ("format=pdf", "format=dcc"),
    "/fleet/report": ("format=json", "format=csv", "format=xlsx", "format=pdf"),
    "/session-template": ("kind=accelerometer&sensors=6",),
    "/units/{serial}/outlook": ("until=2030-01-01",),
}
"""Queries of an address."""
NAMED = {
    "units": "serial",
    "sessions": "id",
    "unit-types": "name",
    "models": "id",
    "jobs": "id",
    "uploads": "id",
    "webhooks": "id",
}
"""Kinds of things that are listed, and what they are called in addresses."""


def log_is_clean(world: World) -> None:
    """Asserts that nothing failed beside the requests."""
    printed = world.new_log()
    if FAILED.search(printed):
        raise FindError(f"the service's log:\n{printed[-3000:]}")


def look_around(world: World, count: int) -> None:
    """Some addresses of what is there."""
    for path in _some(world, sorted(addresses(world)), count):
        read(world, path)


def walk(world: World, most: int) -> None:
    """Every address that the description of the API has for what is there, and every link of every page; where there
    are more than so many of either, some by chance."""
    for path in _some(world, sorted(addresses(world)), most):
        read(world, path)
    seen, waiting, shapes = set[str](), ["/", "/?lang=ru"], Counter[str]()
    while waiting and len(seen) < most:
        path = waiting.pop(world.chance.randrange(len(waiting)))
        if path in seen or is_left_out(world, path) or shapes[_shape(path)] >= MOST_ALIKE:
            continue
        seen.add(path)
        shapes[_shape(path)] += 1
        waiting += sorted(set(links(page(world, path))) - seen)
    world.counts["pages"] += len(seen)


def _some(world: World, found: list[str], most: int) -> list[str]:
    return world.chance.sample(found, min(most, len(found)))


def is_left_out(world: World, path: str) -> bool:
    """Whether an address is not looked at."""
    return bool(LEFT_OUT.search(path) or (world.is_short and COSTLY.search(path)))


def _shape(path: str) -> str:
    """A page without the values of its question: lists may be asked for in a thousand ways."""
    where, _, question = path.partition("?")
    names = sorted(part.partition("=")[0] for part in question.split("&"))
    if question and "lang" not in names:
        where = re.sub(r"/[^/]*[0-9][^/]*", "/…", where)
    return f"{where}?{names}"


def page(world: World, path: str) -> str:
    """A page, or what a page leads to: is there, unless it is being made."""
    world.http.cookies.clear()  # a page in another language is not followed by all others
    answer = world.ask("GET", path, headers=HTML, follow_redirects=True)
    if answer.status_code != 200 and not world.is_pending(answer) and not _is_refused_with_reason(answer, path):
        raise FindError(f"{path} → {answer.status_code}: {answer.text[:600]}")
    return answer.text if "html" in answer.headers.get("content-type", "") else ""


def _is_refused_with_reason(answer: Any, path: str) -> bool:
    """Forms that are sent by a press of a button are no pages."""
    return answer.status_code == 405 or (answer.status_code in (404, 409, 422) and "/api/" in path)


def links(text: str) -> Iterator[str]:
    """Links of a page within the service."""
    for found in LINK.findall(text):
        yield html.unescape(found)


def read(world: World, path: str) -> None:
    """Reads an address as a program does: an answer, or a reason why there is none."""
    answer = world.ask("GET", path)
    if answer.status_code >= 400 and "problem+json" not in answer.headers.get("content-type", ""):
        raise FindError(f"{path} → {answer.status_code}: {answer.text[:600]}")


def addresses(world: World) -> set[str]:
    """Addresses of all operations that read, for the records at hand."""
    names = {(kind, f"{{{of}}}"): [str(one[of]) for one in world.listed(kind)] for kind, of in NAMED.items()}
    names["stands", "{name}"] = sorted({one["stand"] for one in world.sessions() if one["stand"]})
    found = set[str]()
    for template, methods in world.get_description()["paths"].items():
        if "get" in methods and template.startswith(API):
            found |= set(_filled(template.removeprefix(API), names))
    return {path for path in found if not is_left_out(world, path)}


def _filled(template: str, names: dict[tuple[str, str], list[str]]) -> Iterator[str]:
    kind = template[1:].partition("/")[0]
    wanted = re.findall(r"{\w+}", template)
    if not wanted:
        filled = [template]
    elif len(wanted) == 1 and (kind, wanted[0]) in names:
        filled = [template.replace(wanted[0], quote(name, safe="")) for name in names[kind, wanted[0]]]
    else:
        return
    for path, query in product(filled, ("", *QUERIES.get(template, ()))):
        yield f"{API}{path}?{query}" if query else API + path


def pages_agree(world: World, everything: bool = False) -> None:
    """Pages of a unit and a session say what programs read of them."""
    units, sessions = world.units(), world.sessions()
    if not everything:
        units, sessions = (
            world.chance.sample(units, min(1, len(units))),
            world.chance.sample(sessions, min(1, len(sessions))),
        )
    for serial in units:
        unit_agrees(world, serial)
    for session in sessions:
        session_agrees(world, session["id"])


def unit_agrees(world: World, serial: str) -> None:
    """Use and due date of a unit: on its page, in the lists, in its outlook, and where it is said to be usable."""
    path = f"/units/{quote(serial, safe='')}"
    before = world.get(path)
    text, outlook, usable = page(world, path), world.get(f"{path}/outlook"), world.get(f"{path}/usable")
    after = world.get(path)
    if before != after:
        return  # the workers were faster than the reader
    if usable["use"] != before["summary"]["use"]:
        return
    _same(heading(text), WORDS[Use(usable["answer"])], f"{path}: heading and use")
    listed_by_use(world, serial, usable)
    due = before["summary"]["due"]
    if not usable_is_pending(usable):
        _same(str(due), str(outlook["due"]), f"{path}: due in the list and in the outlook")
        _same(str(usable["next_calibration"])[:10], str(due)[:10], f"{path}: due and next_calibration")
    if due and usable["usable"] and outlook["due"] == due:
        shown = day_of(_date(due))
        if shown not in plain(text):
            raise FindError(f"{path}: due {due} is not on the page")


def listed_by_use(world: World, serial: str, usable: dict[str, Any]) -> None:
    """A unit of the fleet is in the list of its answer and in no other; not while something is being worked out."""
    if usable["answer"] == Use.PENDING or any("ask again" in one for one in usable["reservations"]):
        return
    if not _is_listed(world, serial):
        return
    for use in (Use.YES, Use.RESERVED, Use.NO):
        is_listed = _is_listed(world, serial, use=use.value)
        if (
            is_listed is not (usable["answer"] == use)
            and world.get(f"/units/{quote(serial, safe='')}/usable") == usable
        ):
            raise FindError(f"/units?use={use}: {serial} is {'there' if is_listed else 'missing'}, {usable['use']!r}")


def _is_listed(world: World, serial: str, **wanted: str) -> bool:
    found = world.get("/units", params={"text": serial, "limit": 1000, **wanted})["units"]
    return any(unit["serial"] == serial for unit in found)


def usable_is_pending(usable: dict[str, Any]) -> bool:
    """Whether its dates are being worked out."""
    return any("ask again" in reason for reason in usable["reasons"])


def session_agrees(world: World, id: str) -> None:
    """Verdict and state of a session, on its page and for programs."""
    path = f"/sessions/{id}"
    before = world.get(path)
    text = page(world, path)
    if before != world.get(path):
        return
    state = before["state"]
    _same(heading(text), state.capitalize() if state != "accepted" else before["said"], f"{path}: heading")


def heading(text: str) -> str:
    """Words at the head of a page about its subject."""
    found = re.search(r"<h1>(.*?)</h1>", text, re.DOTALL)
    if found is None:
        return ""
    without = re.sub(r'<span class="subject">.*?</span>', "", found[1], count=1, flags=re.DOTALL)
    return plain(without)


def plain(text: str) -> str:
    """The words of a page."""
    words = html.unescape(re.sub(r"<[^>]+>", "", text)).replace("\u200b", "")
    return " ".join(words.split())


def _same(one: str, other: str, what: str) -> None:
    if plain(html.escape(one)) != plain(html.escape(other)):
        raise FindError(f"{what}: {one!r} is not {other!r}")


def _date(moment: str) -> date:
    return date.fromisoformat(moment[:10])
