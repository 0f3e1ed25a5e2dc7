"""May a unit be used? Every rule on its own, over HTTP and on the command line."""

import json
from collections.abc import Callable
from datetime import UTC, datetime
from typing import Any

import httpx
import pytest

from service.app import create_app
from tests.conftest import Holding, SettingsHolding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import FAILED, session_bytes, session_id
from tests.service.papers.laboratory import state_all
from tests.serving import http_client

FIT = (session_bytes(month=1), session_bytes(seed=2, month=2))
SOON, LATE = datetime(2026, 2, 5, tzinfo=UTC), datetime(2028, 3, 1, tzinfo=UTC)
Asking = Callable[..., dict[str, Any]]


def answer(client: httpx.Client, **headers: str) -> httpx.Response:
    """The answer for the unit of `tests.service.made_sessions`."""
    return client.get("/api/v1/units/BA-017/usable", headers=headers)


@pytest.fixture
def asked(settings_holding: SettingsHolding) -> Asking:
    """Asks a service that holds uploads, at a time, after something was done to it."""

    def ask(
        *uploads: bytes, at: datetime = SOON, first: Callable[[httpx.Client], Any] = lambda _: None
    ) -> dict[str, Any]:
        with http_client(create_app(settings_holding(*uploads), clock=lambda: at)) as client:
            first(client)
            found: dict[str, Any] = answer(client).raise_for_status().json()
            return found

    return ask


def test_a_fit_unit_may_be_used_until_it_is_due(asked: Asking) -> None:
    found = asked(*FIT)
    assert (found["usable"], found["verdict"], found["reasons"]) == (True, "pass", [])
    assert found["until"][:10] == found["next_calibration"] > "2026-02-05"
    assert found["session"] == session_id(FIT[-1])
    assert found["correction"] == f"/api/v1/sessions/{session_id(FIT[-1])}/correction"
    assert found["why"].startswith("Fit by its session of 1 Feb 2026, and not due before ")


def test_an_unfit_one_may_not(asked: Asking) -> None:
    found = asked(*FAILED)
    assert (found["usable"], found["verdict"]) == (False, "fail")
    assert "A3 bias changed" in found["why"]
    assert any("Flag" in reason for reason in found["reasons"])


def test_past_due_it_may_not(asked: Asking) -> None:
    found = asked(*FIT, at=LATE)
    assert (found["usable"], found["verdict"]) == (False, "pass")
    assert "Its calibration was due on" in found["why"]


def test_a_sound_reference_alone_may_be_used_with_a_reservation(asked: Asking) -> None:
    found = asked(FIT[0])
    assert (found["usable"], found["verdict"], found["session"]) == (True, None, None)
    assert found["why"].startswith("Its reference was measured on 1 Jan 2026, there is no objection")
    assert "No session has been compared with the reference of 1 Jan 2026 yet" in found["reservation"]
    assert found["until"][:10] == found["next_calibration"] > "2026-02-05"
    assert found["correction"] == f"/api/v1/sessions/{session_id(FIT[0])}/correction"


def test_a_reference_that_is_coarser_than_the_tolerance_may_not(asked: Asking) -> None:
    def tightened(client: httpx.Client) -> None:
        name = client.get("/api/v1/unit-types").json()["unit_types"][0]["name"]
        tight = {"tolerances": {"scale": None, "bias": 1e-9, "quadratic": None, "axis": None}}
        client.put(f"/api/v1/unit-types/{name}", json=tight).raise_for_status()

    found = asked(FIT[0], first=tightened)
    assert not found["usable"]
    assert "A1 bias, A2 bias, A3 bias, A4 bias and 2 more" in found["why"]


def test_after_a_repair_the_new_reference_is_enough(asked: Asking) -> None:
    repair = {"kind": "repair", "at": "2026-01-20T12:00:00Z"}
    found = asked(*FAILED, first=lambda client: client.post("/api/v1/units/BA-017/services", json=repair))
    assert found["why"].startswith("Its reference was measured on 1 Feb 2026")


def test_what_cannot_be_decided_says_what_to_measure(asked: Asking) -> None:
    tight = {"tolerances": {"scale": None, "bias": 1e-9, "quadratic": None, "axis": None}}

    def uncertain(client: httpx.Client) -> None:
        name = client.get("/api/v1/unit-types").json()["unit_types"][0]["name"]
        client.put(f"/api/v1/unit-types/{name}", json=tight).raise_for_status()
        client.post("/api/v1/sessions", content=FIT[1]).raise_for_status()

    found = asked(FIT[0], first=uncertain)
    assert (found["usable"], found["verdict"]) == (False, "undecidable")
    assert "measure more positions" in found["why"]


def test_after_a_service_nothing_is_judged_yet(asked: Asking) -> None:
    repair = {"kind": "repair", "at": "2026-02-03T12:00:00Z"}
    found = asked(*FIT, first=lambda client: client.post("/api/v1/units/BA-017/services", json=repair))
    assert (found["usable"], found["correction"]) == (False, None)
    assert "Nothing was measured since the service of 3 Feb 2026" in found["why"]


def test_a_flag_forbids_although_the_next_session_is_fit(asked: Asking) -> None:
    again = session_bytes(seed=3, month=3)

    def acknowledged(client: httpx.Client) -> None:
        client.post("/api/v1/sessions", content=again).raise_for_status()
        for flag in client.get("/api/v1/units/BA-017/flags").json()["flags"]:
            because = {"by": "K. Ito", "why": "seen"}
            client.post(f"/api/v1/flags/{flag['id']}/acknowledge", json=because).raise_for_status()

    found = asked(*FAILED, at=datetime(2026, 3, 5, tzinfo=UTC), first=acknowledged)
    assert (found["usable"], found["verdict"]) == (False, "pass")
    assert found["why"].startswith("Flag ")


def moved(month: int, *columns: str) -> bytes:
    """A session in which the bias of some sensors is out of tolerance."""
    document = json.loads(session_bytes(seed=month, month=month))
    for column in columns:
        document["table"][column] = [reading + 1e-3 for reading in document["table"][column]]
    return json.dumps(document).encode()


def test_flags_are_listed_alike_whichever_was_raised_first(asked: Asking) -> None:
    first, one, both = session_bytes(month=1), moved(2, "A5"), moved(3, "A2", "A5")
    forwards, backwards = asked(first, one, both, at=LATE), asked(first, both, one, at=LATE)
    flags = [
        [line.split(": ")[1][:2] for line in found["reasons"] if "Flag" in line] for found in (forwards, backwards)
    ]
    assert flags == [["A2", "A5"], ["A2", "A5"]]


def test_a_date_to_come_is_not_believed(asked: Asking) -> None:
    found = asked(*FIT, at=datetime(2026, 1, 20, tzinfo=UTC))
    assert not found["usable"]
    assert "in the future" in found["why"]


def test_a_broken_chain_is_a_reservation(asked: Asking) -> None:
    found = asked(*FIT, first=lambda client: state_all(client, valid_until="2026-01-31"))
    assert found["usable"]
    assert "Traceability is interrupted" in found["reservation"]
    assert [line for line in found["reservations"] if "interrupted" in line]


def test_a_later_session_that_waits_for_an_engineer_is_a_reservation(asked: Asking) -> None:
    later = json.loads(session_bytes(seed=3, month=3))
    table = later["table"]
    for sensor in later["sensors"]:
        table[sensor["name"]] = [1000 * reading for reading in table[sensor["name"]]]
    found = asked(*FIT, json.dumps(later).encode(), at=datetime(2026, 3, 5, tzinfo=UTC))
    assert found["usable"]
    assert "The session of 1 Mar 2026 waits for an engineer" in found["reservation"]


def test_the_same_answer_is_not_sent_twice(holding: Holding) -> None:
    client = holding(*FIT)
    first = answer(client)
    assert (first.headers["cache-control"], first.status_code) == ("no-cache", 200)
    again = answer(client, **{"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")
    repair = {"kind": "repair", "at": "2026-02-03T12:00:00Z"}
    client.post("/api/v1/units/BA-017/services", json=repair).raise_for_status()
    assert answer(client, **{"If-None-Match": first.headers["etag"]}).status_code == 200


def test_an_unknown_unit_is_not_found(client: httpx.Client) -> None:
    assert answer(client).status_code == 404
