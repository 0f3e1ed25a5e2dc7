"""A log of a flight controller or a robot from the file to a calibration of every IMU in it, over HTTP."""

import json
from functools import cache
from typing import Any

import httpx
import numpy as np
import pytest

from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - a hook
from tests.service.ingest import flight_logs as made
from tests.service.uploads.test_layouts_page import ADDRESS, sent, shown

FACTS = {"site": {"gravity_m_s2": made.GRAVITY}, "started_at": "2026-05-28T20:00:00Z"}

SAID = {"fact.day": "2026-05-28", "fact.clock": "09:00", "fact.offset": "Z", "fact.site.gravity_m_s2": "9.81"}
"""Entries of the form."""


flown = cache(made.imus)
"""Measurements of the IMUs in the log."""


@cache
def log(kind: str) -> bytes:
    """A log of a kind, with all IMUs."""
    return made.WRITERS[kind](flown())


def previewed(client: httpx.Client, content: bytes, mapping: dict[str, Any] | None = None, unit: str = "") -> Any:
    """Preview of a log."""
    stated = {} if mapping is None else {"mapping": json.dumps(mapping)}
    sent = {"files": {"file": ("flight.log", content)}, "data": stated, "params": {"unit": unit}}
    return client.post("/api/v1/layouts/preview", **sent).raise_for_status().json()


def stored(client: httpx.Client, content: bytes, unit: str = "DRONE-1") -> httpx.Response:
    """Stores a log as its preview proposes, with what no log says."""
    mapping = previewed(client, content, unit=unit)["mapping"]
    whole = {**mapping, "session": {**mapping["session"], **FACTS}}
    file = ("flight.log", content)
    return client.post("/api/v1/sessions", files={"file": file}, data={"mapping": json.dumps(whole)})


def test_of_a_log_only_the_site_is_asked(client: httpx.Client) -> None:
    found = previewed(client, log("ulog"))
    assert found["mapping"]["session"]["unit"] == made.UUID
    assert {problem["field"].split(".")[0] for problem in found["problems"]} == {"site"}
    mapping = found["mapping"]
    whole = {**mapping, "session": {**mapping["session"], **FACTS}}
    complete = previewed(client, log("ulog"), whole)
    assert complete["problems"] == []
    assert complete["felt"] == pytest.approx(made.GRAVITY, abs=0.1)


@pytest.mark.parametrize("kind", made.WRITERS)
def test_every_imu_of_a_log_is_calibrated_and_the_log_kept_unchanged(client: httpx.Client, kind: str) -> None:
    answer = stored(client, log(kind))
    assert answer.status_code == 201, answer.text
    found = client.get(f"/api/v1/sessions/{answer.json()['id']}/calibration").json()
    sensors = {sensor["name"]: sensor for sensor in found["sensors"]}
    assert set(sensors) >= {f"A{k}" for k in range(1, 7)}
    bias = [sensors[f"A{k}"]["bias"] for k in range(1, 7)]
    error = np.array([one["value"] for one in bias]) - made.BIAS.ravel()
    assert np.all(np.abs(error) < 5 * np.array([one["sigma"] for one in bias]))
    assert np.all(np.abs(error) < 0.005)
    kept = client.get(f"/api/v1/sessions/{answer.json()['id']}/file", params={"original": "true"})
    assert kept.content == log(kind)


def test_the_next_log_of_the_unit_is_understood_by_itself(client: httpx.Client) -> None:
    stored(client, log("mcap")).raise_for_status()
    later = made.mcap([made.Imu(imu.time + 86_400, imu.force, imu.rate) for imu in flown()])
    found = previewed(client, later, unit="DRONE-1")
    assert (found["remembered"], found["problems"]) == (True, [])
    assert found["mapping"]["session"]["started_at"].startswith("2026-05-29")


def test_a_log_without_its_mapping_is_told_what_to_do(client: httpx.Client) -> None:
    answer = client.post("/api/v1/sessions", content=log("ulog"))
    assert answer.status_code == 422
    assert "layouts/preview" in answer.json()["problems"][0]["message"]


def test_the_pages_take_a_log_from_the_upload_to_its_session(client: httpx.Client) -> None:
    upload = client.post("/upload", files={"files": ("flight.ulg", log("ulog"))})
    assert f'action="{ADDRESS}"' in upload.text
    page = client.post(ADDRESS, files={"file": ("flight.ulg", log("ulog"))}, headers={"Accept": "text/html"})
    fields = shown(page.text)
    assert (fields["fact.unit"], fields["as.6"]) == (made.UUID, "A6")
    looked = sent(client, fields, **SAID, do="look")
    assert sent(client, shown(looked.text), do="store").status_code == 303
    (session,) = client.get("/api/v1/sessions").json()["sessions"]
    assert (session["unit"], session["programme"]) == (made.UUID, "arbitrary-orientations")
