"""The effect of other tolerances is shown before they are set, and nothing is stored by looking."""

import httpx
import pytest
from lxml import html

from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import session_bytes
from tests.service.recordings import recording_bytes

TYPE = "/unit-types/accelerometer × 6, V"
MOVED = tuple(
    session_bytes(unit=unit, seed=month, month=month, a3_moved=moved)
    for unit, moved in (("B-1", 20.0), ("B-2", 0.0))
    for month, moved in ((1, 0.0), (2, moved))
)
NARROW = {"accelerometer.bias": "10"}


@pytest.fixture
def typed(holding: Holding) -> httpx.Client:
    """Two units, in one of which A3's bias moved by 20 µg of 50 µg allowed, and one that has a reference only."""
    return holding(*MOVED, session_bytes(unit="B-3", seed=9))


def numbers(client: httpx.Client, address: str = TYPE, response: httpx.Response | None = None) -> dict[str, str]:
    text = (response or client.get(address)).text
    form = html.fromstring(text).xpath("//form[contains(@action, '/tolerances')]")[0]
    return {str(name): str(value or "") for name, value in form.fields.items()}


def test_narrower_ones_name_the_unit_that_changes_and_why(typed: httpx.Client) -> None:
    page = typed.post(f"{TYPE}/tolerances/preview", data=numbers(typed) | NARROW).text
    assert "With these tolerances, the verdict of 1 of 2 units changes" in page
    (row,) = html.fromstring(page).xpath("//tbody/tr")
    said = " ".join(row.text_content().split())
    assert said.startswith("B-1FitUnfitA3 bias changed")
    assert "1 unit not counted: the latest session is a reference" in page
    assert typed.get(f"/api/v1{TYPE}").json()["revision"] == 1


def test_what_was_seen_is_set_as_it_was_written(typed: httpx.Client) -> None:
    seen = typed.post(f"{TYPE}/tolerances/preview", data=numbers(typed) | NARROW)
    form = numbers(typed, response=seen) | {"by": "M. Okafor", "why": "the customer asks for more"}
    assert typed.post(f"{TYPE}/tolerances", data=form).status_code == 303
    found = typed.get(f"/api/v1{TYPE}").json()
    assert (found["revision"], found["tolerances"]["bias"]) == (2, pytest.approx(10e-6 * 9.80665))


def test_the_same_ones_change_nothing(typed: httpx.Client) -> None:
    kind = typed.get(f"/api/v1{TYPE}").json()
    same = {"tolerances": kind["tolerances"], "gyro_tolerances": kind["gyro_tolerances"]}
    found = typed.post(f"/api/v1{TYPE}/preview", json=same).json()
    assert found == {"units": 3, "judged": 2, "references": 1, "recordings": 0, "beyond": 0, "changes": []}


def test_a_recording_in_service_is_judged_as_its_upload_would_be(holding: Holding) -> None:
    flown = recording_bytes(a3_moved=400.0)
    client, other = holding(session_bytes(), flown), holding(session_bytes())
    kind = client.get(f"/api/v1{TYPE}").json()
    wide = {"tolerances": kind["tolerances"] | {"bias": 600e-6 * 9.80665}, "gyro_tolerances": None}
    found = client.post(f"/api/v1{TYPE}/preview", json=wide).json()
    other.put(f"/api/v1{TYPE}", json=wide).raise_for_status()
    stored = other.post("/api/v1/sessions", content=flown).json()
    (change,) = found["changes"]
    assert (found["judged"], found["recordings"], change["before"]) == (1, 0, "fail")
    assert (change["after"], change["reason"]) == (stored["verdict"], stored["reason"])


def test_a_recording_whose_calibration_was_withdrawn_is_counted_apart(holding: Holding) -> None:
    client = holding(session_bytes(), recording_bytes())
    own = next(
        one["id"] for one in client.get("/api/v1/sessions").json()["sessions"] if one["programme"] != "in-service"
    )
    client.post(f"/api/v1/sessions/{own}/withdraw", json={"by": "K. Ito", "why": "wrong"}).raise_for_status()
    same = {"tolerances": client.get(f"/api/v1{TYPE}").json()["tolerances"], "gyro_tolerances": None}
    found = client.post(f"/api/v1{TYPE}/preview", json=same).json()
    assert (found["judged"], found["references"], found["recordings"]) == (0, 0, 1)
