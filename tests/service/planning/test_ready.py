"""Whether a unit is ready to be measured, by the API and the page; nothing is stored."""

import json

import httpx
import numpy as np

from tests.builders import Document, accelerometer_block

ADDRESS = "/api/v1/plan/ready"


def at_rest(drift: float = 0.0, count: int = 480) -> Document:
    """Rows of one position every ten seconds; ``drift`` in V over a minute."""
    document = accelerometer_block(positions=12)
    table, rng = document["table"], np.random.default_rng(4)
    clock = 10.0 * np.arange(count)
    rows: dict[str, list[object]] = {"run": ["direct"] * count, "beta_deg": [0.0] * count, "time_s": clock.tolist()}
    for sensor in document["sensors"]:
        name = sensor["name"]
        noise = 5e-7 * 9.80665 * sensor["nominal_scale"] * rng.standard_normal(count)
        rows[name] = (table[name][0] + noise + drift * clock / 60).tolist()
    return document | {"table": rows}


def test_a_warm_unit_is_ready_and_nothing_is_stored(client: httpx.Client) -> None:
    found = client.post(ADDRESS, json=at_rest(), params={"minutes": 96}).json()
    assert (found["state"], found["ready"], found["said"][0]) == ("ready", True, "Ready")
    assert client.get("/api/v1/sessions").json()["sessions"] == []


def test_a_known_unit_is_judged_by_its_type_and_its_last_session_s_length(client: httpx.Client) -> None:
    document = accelerometer_block(positions=12)
    client.post("/api/v1/sessions", json=document)
    found = client.post(ADDRESS, json=at_rest()).json()
    assert found["unit_type"] == client.get("/api/v1/unit-types").json()["unit_types"][0]["name"]
    times = document["table"]["time_s"]
    assert found["duration_s"] == times[-1] - times[0]


def test_the_page_says_it_in_one_sentence(client: httpx.Client) -> None:
    sent = {"file": ("first.json", json.dumps(at_rest(drift=1e-5)))}
    page = client.post("/ready", files=sent, data={"minutes": "96"})
    assert page.status_code == 200
    assert "Not warm: waiting is not enough" in page.text


def test_the_form_says_what_it_cannot_use(client: httpx.Client) -> None:
    sent = {"file": ("first.json", json.dumps(at_rest(count=20)))}
    assert client.post("/ready", files=sent, data={"minutes": "soon"}).status_code == 422
    assert client.post("/ready", data={"minutes": "5"}).status_code == 422


def test_what_is_missing_has_a_page(client: httpx.Client) -> None:
    document = accelerometer_block(positions=12)
    so_far = document | {"table": {name: column[:15] for name, column in document["table"].items()}}
    page = client.post("/missing", files={"file": ("so-far.json", json.dumps(so_far))}, data={"runs": "both"})
    assert "15 positions are done, 9 still to come." in page.text
    assert "complete: ±" in page.text


def test_both_pages_are_linked_from_the_upload_page(client: httpx.Client) -> None:
    page = client.get("/upload").text
    for address in ("/ready", "/missing"):
        assert f'href="{address}"' in page
        assert client.get(address).status_code == 200
