"""Sessions and services are taken back, accepted and chosen over HTTP, and the pages say so."""

import json
from typing import Any

import httpx
import pytest

from tests.conftest import Holding
from tests.service.made_sessions import FAILED, session_bytes, session_id

FIRST, SECOND = (session_id(content) for content in FAILED)
WHO = {"by": "K. Ito", "why": "wrong cable"}
UNIT = "/api/v1/units/BA-017"


@pytest.fixture
def http(holding: Holding) -> httpx.Client:
    """A unit whose second session is out of tolerance."""
    return holding(*FAILED)


def post(http: httpx.Client, path: str, status: int = 200, **more: Any) -> Any:
    answer = http.post(f"/api/v1{path}", json=WHO | more)
    assert answer.status_code == status, answer.text
    return answer.json()


def test_a_withdrawn_session_stays_readable_and_leaves_history_and_verdict(http: httpx.Client) -> None:
    assert post(http, f"/sessions/{SECOND}/withdraw")["state"] == "withdrawn"
    assert {p["session"] for p in http.get(f"{UNIT}/history").json()["points"]} == {FIRST}
    report = http.get(UNIT).json()
    assert (report["summary"]["sessions"], report["summary"]["last_session"]) == (1, FIRST)
    life = http.get(f"/api/v1/sessions/{SECOND}/states").json()
    assert [(line["state"], line["who"], line["why"]) for line in life["states"]] == [
        ("withdrawn", "K. Ito", "wrong cable")
    ]


def test_no_certificate_is_issued_of_a_session_that_does_not_count(http: httpx.Client) -> None:
    post(http, f"/sessions/{SECOND}/withdraw")
    refused = http.get(f"/api/v1/sessions/{SECOND}/certificate")
    assert (refused.status_code, refused.json()["detail"][:28]) == (409, "This session is withdrawn: n")
    assert http.get(f"/api/v1/sessions/{SECOND}/certificates").json()["certificates"] == []
    assert "Certificate (PDF)" not in http.get(f"/sessions/{SECOND}").text


def test_a_session_is_accepted_again_once(http: httpx.Client) -> None:
    post(http, f"/sessions/{SECOND}/withdraw")
    assert post(http, f"/sessions/{SECOND}/accept")["verdict"] == "fail"
    assert post(http, f"/sessions/{SECOND}/accept", 409)["detail"].endswith("accepted already.")


def test_a_chosen_reference_is_the_units_own(http: httpx.Client) -> None:
    assert post(http, "/units/BA-017/reference", session=SECOND)["is_reference"]
    assert http.get(UNIT).json()["reference_session"] == SECOND
    http.post("/api/v1/sessions", content=session_bytes(unit="BA-018"))
    post(http, "/units/BA-018/reference", 409, session=SECOND)


def test_a_corrected_file_names_what_it_replaces_by_whom_and_why(http: httpx.Client) -> None:
    content = session_bytes(seed=2, month=2)
    given = {"supersedes": SECOND, "by": "K. Ito"}
    refused = http.post("/api/v1/sessions", params=given, content=content)
    assert [p["field"] for p in refused.json()["problems"]] == ["why"]
    form = http.post("/api/v1/sessions", data=given | {"why": "typing error"}, files={"file": ("b.json", content)})
    assert form.status_code == 201
    known = http.get(f"/api/v1/sessions/{SECOND}").json()
    assert (known["state"], known["superseded_by"]) == ("superseded", form.json()["id"])


def test_the_session_that_stands_for_another_is_found_where_it_is_the_only_one(http: httpx.Client) -> None:
    post(http, f"/sessions/{SECOND}/supersede", 409)
    right = http.post("/api/v1/sessions", content=session_bytes(seed=2, month=2)).json()["id"]
    assert post(http, f"/sessions/{SECOND}/supersede")["superseded_by"] == right


def test_a_service_is_withdrawn_and_stays_on_record(http: httpx.Client) -> None:
    new = {"kind": "repair", "at": "2026-01-15T00:00:00Z", "by": "K. Ito"}
    number = http.post(f"{UNIT}/services", json=new).json()["id"]
    assert http.get(f"/api/v1/sessions/{SECOND}").json()["is_reference"]
    assert post(http, f"/services/{number}/withdraw")["state"] == "withdrawn"
    report = http.get(UNIT).json()
    assert (report["services"], [s["id"] for s in report["withdrawn_services"]]) == ([], [number])
    assert http.get(f"/api/v1/sessions/{SECOND}").json()["verdict"] == "fail"
    assert "by K. Ito: wrong cable" in http.get("/units/BA-017").text
    post(http, f"/services/{number}/withdraw", 409)


def test_the_pages_say_first_what_became_of_a_session(http: httpx.Client) -> None:
    post(http, f"/sessions/{SECOND}/withdraw")
    page = http.get(f"/sessions/{SECOND}").text
    assert page.index("Withdrawn</h1>") < page.index("by K. Ito: wrong cable") < page.index("Its verdict was: ")
    assert 'action="/sessions/' + SECOND + '/accept"' in page
    assert '<tr class="withdrawn">' in http.get("/units/BA-017").text


def test_the_forms_of_the_pages_do_the_same(http: httpx.Client) -> None:
    for what, state in (("withdraw", "withdrawn"), ("accept", "accepted"), ("reference", "accepted")):
        assert http.post(f"/sessions/{SECOND}/{what}", data=WHO).status_code == 303
        assert http.get(f"/api/v1/sessions/{SECOND}").json()["state"] == state
    assert http.get(f"/api/v1/sessions/{SECOND}").json()["is_reference"]


def test_the_page_of_a_unit_without_an_accepted_session_is_there(http: httpx.Client) -> None:
    for id in (FIRST, SECOND):
        post(http, f"/sessions/{id}/withdraw")
    assert "None of its sessions counts as a calibration: calibrate the unit." in http.get("/units/BA-017").text
    assert "BA-017" not in json.dumps(http.get("/api/v1/units").json())


def test_an_empty_reason_is_none(http: httpx.Client) -> None:
    answer = http.post(f"/api/v1/sessions/{SECOND}/withdraw", json={"by": "K. Ito", "why": " "})
    assert answer.status_code == 422
