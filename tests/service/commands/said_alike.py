"""Statements of a service about one unit's use, wherever they stand."""

from csv import DictReader
from dataclasses import dataclass
from io import StringIO
from typing import Any

import httpx
from icalendar import Calendar

from estimator.message import capitalised
from service.fleet.use import Use, in_words
from service.kit.measures import day_of
from service.pages.fleet.pages import SHORT
from tests.service.papers.documents import text_of

HTML = {"Accept": "text/html"}
SYSTEM = {"system": "px4"}


@dataclass(frozen=True)
class FleetSaid:
    """Statements about all units at once."""

    page: str
    paper: str
    events: dict[str, Any]
    """Events of the calendar, by serial number."""
    lists: tuple[dict[str, tuple[bool, str]], ...]
    """`usable` and `use` of every unit, by serial number, as each list for programs has them."""


def plain(text: str) -> str:
    """Words alone, without marks of where a line may break."""
    return " ".join(text.replace("\u200b", "").split())


def fleet_of(client: httpx.Client) -> FleetSaid:
    """The statements of a service."""
    calendar = Calendar.from_ical(client.get("/api/v1/feeds/due.ics").raise_for_status().content)
    return FleetSaid(
        plain(client.get("/", headers=HTML).raise_for_status().text),
        plain(text_of(client.get("/api/v1/fleet/report", params={"format": "pdf"}).raise_for_status().content)),
        {str(event["SUMMARY"]).split(":")[0]: event for event in calendar.events},
        _lists(client),
    )


def _lists(client: httpx.Client) -> tuple[dict[str, tuple[bool, str]], ...]:
    listed = client.get("/api/v1/units", params={"limit": 1000, "retired": False}).raise_for_status().json()["units"]
    table = client.get("/api/v1/fleet/report", params={"format": "csv"}).raise_for_status().text
    due = client.get("/api/v1/fleet/due", headers={"Accept": "text/csv"}).raise_for_status().text
    return (
        {unit["serial"]: (unit["usable"], unit["use"]) for unit in listed},
        {row["serial"]: (row["usable"] == "true", row["use"]) for row in DictReader(StringIO(table))},
        {row["unit"]: (row["usable"] == "true", row["use"]) for row in DictReader(StringIO(due))},
    )


def check_unit(client: httpx.Client, serial: str, fleet: FleetSaid) -> dict[str, Any]:
    """Holds everything that is said of a unit against the API's answer, which it returns."""
    answer: dict[str, Any] = client.get(f"/api/v1/units/{serial}/usable").raise_for_status().json()
    said = answer["use"]
    assert said == in_words(Use(answer["answer"]), answer["action"])
    page = plain(client.get(f"/units/{serial}", headers=HTML).raise_for_status().text)
    word = in_words(Use(answer["answer"]), "")
    assert f"</span> {word}</h1>" in page
    assert not answer["action"] or f'<p class="do">{capitalised(answer["action"])}.</p>' in page
    before, _, after = fleet.page.partition(f'href="/units/{serial}"')
    row = before.rpartition("<tr")[2] + after.partition("</tr")[0]
    assert f"<span>{SHORT[Use(answer['answer'])]}</span>" in row
    assert capitalised(answer["action"]) in row
    assert said in fleet.paper
    units, report, due = fleet.lists
    known = (answer["usable"], said)
    assert (units[serial], report[serial], due.get(serial, known)) == (known, known, known)
    _check_date(answer, page, _label(client, serial), fleet.events.get(serial))
    if answer["correction"]:
        _check_export(client, answer, said)
    return answer


def _label(client: httpx.Client, serial: str) -> str:
    return plain(text_of(client.get(f"/api/v1/units/{serial}/label.pdf").raise_for_status().content))


def _check_date(answer: dict[str, Any], page: str, label: str, event: Any) -> None:
    """A date stands where it counts, and else what to do in its place."""
    use = Use(answer["answer"])
    is_overdue = answer["until"] is not None and answer["until"] < answer["as_of"]
    assert (event is None) is (answer["until"] is None)
    if event is not None:
        assert str(event["DESCRIPTION"]).startswith(answer["use"])
    if answer["until"] is None or not (answer["usable"] or is_overdue):
        assert in_words(use, "").upper() in label
        assert "Calibration due" not in label
        return
    day = day_of(event.start)
    assert day in page
    assert f"Calibration {'overdue since' if is_overdue else 'due'} {day}" in label
    word = in_words(use, "")
    assert ((word.upper() if is_overdue else word) in label) is (use is not Use.YES)


def _check_export(client: httpx.Client, answer: dict[str, Any], said: str) -> None:
    """Refused where the unit must not be used; its comments say what else is to be known."""
    address = answer["correction"].replace("/correction", "/export")
    found = client.get(address, params=SYSTEM)
    assert found.status_code == (200 if answer["usable"] else 409)
    if not answer["usable"]:
        assert answer["why"] in found.json()["detail"]
        found = client.get(address, params=SYSTEM | {"force": "true"}).raise_for_status()
        said = said.upper()
    assert (said in found.text) is (answer["answer"] != Use.YES)
    assert all(plain(one) in found.text for one in answer["reservations"])
