"""Services, notes and stages on pages, and the forms that record them."""

import httpx
import pytest

from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import session_bytes

HTML = {"Accept": "text/html"}
BIAS = "/units/BA-017/parameters/bias-accelerometer"
FORMS = {
    "/units/BA-017/services": {"kind": "repair", "sensor": "A3", "by": "K. Ito", "note": "glued", "at": ""},
    "/units/BA-017/notes": {"text": "moved by road", "by": "K. Ito", "at": "2026-04-01T12:00"},
}


@pytest.fixture
def measured(holding: Holding) -> httpx.Client:
    """A unit with two sessions."""
    return holding(session_bytes(month=1), session_bytes(seed=2, month=2))


@pytest.mark.parametrize("path", FORMS)
def test_what_a_form_records_is_listed(measured: httpx.Client, path: str) -> None:
    answer = measured.post(path, data=FORMS[path], headers=HTML)
    assert (answer.status_code, answer.headers["location"]) == (303, "/units/BA-017#events")
    page = measured.get("/units/BA-017", headers=HTML).text
    assert {"services": "Repair of A3</b> by K. Ito", "notes": "Note</b> by K. Ito"}[path.rpartition("/")[2]] in page


@pytest.mark.parametrize("path", FORMS)
def test_a_form_of_another_site_records_nothing(measured: httpx.Client, path: str) -> None:
    answer = measured.post(path, data=FORMS[path], headers=HTML | {"Sec-Fetch-Site": "cross-site"})
    assert answer.status_code == 403
    assert "by K. Ito" not in measured.get("/units/BA-017", headers=HTML).text


def test_a_note_is_drawn_until_it_is_withdrawn(measured: httpx.Client) -> None:
    measured.post("/units/BA-017/notes", data=FORMS["/units/BA-017/notes"], headers=HTML)
    drawn = '"notes":[{"t":"2026-04-01T12:00:00.000000Z","date":"1 Apr 2026","note":"moved by road"}]'
    assert drawn in measured.get(BIAS, headers=HTML).text
    measured.post("/notes/1/withdraw", data={"by": "K. Ito", "why": "another unit"}, headers=HTML)
    assert drawn not in measured.get(BIAS, headers=HTML).text
    page = measured.get("/units/BA-017", headers=HTML).text
    assert '<span class="text">moved by road</span>' in page
    assert "by K. Ito: another unit" in page


def test_sessions_marked_on_their_pages_stand_beside_each_other(measured: httpx.Client) -> None:
    sessions = measured.get("/api/v1/sessions?unit=BA-017").json()["sessions"]
    left, found = (session["id"] for session in sessions)
    measured.post("/api/v1/sessions", content=session_bytes(seed=3, month=3))
    for id, stage in ((left, "as-found"), (found, "neither")):
        answer = measured.post(f"/sessions/{id}/stage", data={"stage": stage, "by": "K. Ito"}, headers=HTML)
        assert answer.status_code == 303
    page = measured.get("/units/BA-017", headers=HTML).text
    assert "As found and as left" in page
    assert "as left: not measured yet" in page
    assert "A3 bias</th>" in page
