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


def test_the_upload_page_says_it_and_stores_nothing(client: httpx.Client) -> None:
    sent = {"files": ("first.json", json.dumps(at_rest(drift=1e-5)))}
    page = client.post("/upload", files=sent, data={"look": "yes"})
    assert page.status_code == 200
    assert "Not warm: waiting is not enough" in page.text
    assert client.get("/api/v1/sessions").json()["sessions"] == []
