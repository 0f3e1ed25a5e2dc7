"""The planning page over HTTP: what is asked is answered, what is left empty is proposed, nonsense is refused."""

import re

import httpx
import pytest

from tests.databases import one_engine
from tests.service.made_sessions import session_bytes
from tests.service.turntable import alignment_bytes

HTML = {"Accept": "text/html"}


def page(client: httpx.Client, **asked: object) -> str:
    """The text of the page, tags taken out."""
    answer = client.get("/plan", params=asked, headers=HTML)
    assert answer.status_code == 200, answer.text
    text = re.sub(r"<script.*?</script>", "", answer.text, flags=re.DOTALL)
    return re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", text))


@one_engine
def test_nothing_asked_is_a_proposal(client: httpx.Client) -> None:
    text = page(client)
    assert "24 positions in both runs, 1 h 36 min: no tolerance was given" in text
    assert "39.4°, proposed" in text
    assert "A1, A2, A3, A4, A5, A6" in text


@one_engine
def test_an_empty_field_is_proposed(client: httpx.Client) -> None:
    assert page(client, elevation="", positions="", bias="") == page(client)


@one_engine
def test_tolerances_are_judged(client: httpx.Client) -> None:
    assert "reach every tolerance" in page(client, bias=12, scale=20)
    unreachable = page(client, axis=0.5)
    assert "Not reached" in unreachable
    assert "do not reach the tolerance of axis" in unreachable


@one_engine
def test_what_is_asked_is_kept_in_the_form(client: httpx.Client) -> None:
    form = client.get("/plan", params={"elevation": 35, "positions": 8, "runs": "direct"}, headers=HTML).text
    assert re.search(r'name="elevation"[^>]*value="35"', form)
    assert re.search(r'<option value="direct" selected>', form)
    assert "direct run" in form
    assert "flipped run" not in form


@one_engine
def test_one_run_says_what_it_does_not_see(client: httpx.Client) -> None:
    assert "scale and bias and axis of every sensor: not observable" in page(client, runs="direct", positions=12)


@one_engine
def test_gyros_are_planned_in_their_units(client: httpx.Client) -> None:
    text = page(client, kind="gyroscope", bias=0.05)
    assert "°/h of 0.05" in text.replace("\u202f", " ")
    assert "Without a stand" not in text
    assert "g sensitivity" in text


@one_engine
def test_accelerometers_hear_nothing_of_gyros(client: httpx.Client) -> None:
    assert "g sensitivity" not in page(client)


@one_engine
@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("sensors", 2), ("sensors", 1000), ("elevation", 90), ("positions", 1), ("noise", -1), ("bias", "nan"),
        ("kind", "magnetometer"), ("minutes", 0), ("theta", "1e308"), ("alpha_error", "x"), ("latitude", "inf"),
    ],
)  # fmt: skip
def test_nonsense_is_refused_by_name(client: httpx.Client, field: str, value: object) -> None:
    answer = client.get("/plan", params={field: value}, headers=HTML)
    assert answer.status_code == 422
    assert field in answer.text


@one_engine
@pytest.mark.parametrize(
    "asked",
    [
        {"sensors": 12, "positions": 72},
        {"theta": 0, "alpha_error": 0, "beta_error": 0, "noise": 1e-9, "variation": 1e-9},
        {"noise": 1e9, "bias": 1e-9},
        {"elevation": 1, "positions": 3},
        {"elevation": 89, "positions": 4, "runs": "direct"},
        {"latitude": 90, "kind": "gyroscope", "sensors": 3},
        {"minutes": 1440, "axis": 1e9},
    ],
)
def test_the_edges_of_what_may_be_asked_are_answered(client: httpx.Client, asked: dict[str, object]) -> None:
    assert "positions in" in page(client, **asked)


def test_a_stored_unit_type_brings_its_sensors_and_tolerances(client: httpx.Client) -> None:
    client.post("/api/v1/sessions", content=session_bytes(m=5, unit_type="RA-5"))
    text = page(client, unit_type="RA-5")
    assert "A1, A2, A3, A4, A5" in text
    assert "of 50" in text
    assert "A cone" not in text
    form = client.get("/plan", params={"unit_type": "RA-5"}, headers=HTML).text
    assert '<option value="RA-5" selected>' in form
    assert '"/api/v1/plan?unit_type=RA-5&amp;' in form


@one_engine
def test_the_same_plan_is_served_as_json(client: httpx.Client) -> None:
    client.post("/api/v1/sessions", content=session_bytes(m=5, unit_type="RA-5"))
    document = client.get("/api/v1/plan", params={"unit_type": "RA-5", "positions": 12, "axis": 3}).json()
    assert (document["format"], document["positions"]) == ("imu-plan/1", 12)
    assert document["question"]["axis"] == 3
    assert document["question"]["bias"] == pytest.approx(50)
    assert {p["sensor"] for p in document["parameters"]} == {"A1", "A2", "A3", "A4", "A5"}


@one_engine
def test_a_type_that_cannot_be_planned_for_says_why(client: httpx.Client) -> None:
    client.post("/api/v1/sessions", content=alignment_bytes())
    name = client.get("/api/v1/unit-types").json()["unit_types"][0]["name"]
    answer = client.get("/api/v1/plan", params={"unit_type": name})
    assert answer.status_code == 422
    assert "accelerometers and gyros" in answer.json()["problems"][0]["message"]
    assert client.get("/api/v1/plan", params={"unit_type": "nobody"}).status_code == 404
    assert f'value="{name}"' not in client.get("/plan", headers=HTML).text
