"""A thermal session over HTTP: page, calibration and correction with its curves."""

from dataclasses import replace
from typing import Any

import httpx
import numpy as np
import pytest

from benchmarks.thermal import CASES, draw
from tests.service.diagnosed import send
from tests.service.papers.test_correction import correction

LOOP = replace(CASES[5], noise=5e-6, gyros=3)
"""Hysteresis of 1 mg, good instruments."""


@pytest.fixture(scope="module")
def document() -> dict[str, Any]:
    made = draw(LOOP, np.random.default_rng(5))[0]
    return made | {"unit": "BA-017", "started_at": "2026-03-01T09:00:00Z"}


def test_page_api_and_correction_hold_the_curves(client: httpx.Client, document: dict[str, Any]) -> None:
    id = send(client, document)
    page = client.get(f"/sessions/{id}").text
    assert "Over temperature" in page
    assert "Hysteresis of A1, A2, A3, A4, A5, A6" in page
    assert "curves-accelerometer-bias" in page
    thermal = client.get(f"/api/v1/sessions/{id}/calibration").json()["thermal"]
    assert thermal["reference_temperature"] == 20
    assert [one["name"] for one in thermal["sensors"]] == [f"A{i}" for i in range(1, 7)] + ["G1", "G2", "G3"]
    assert_firmware_gives_gravity(correction(client, id), document)


def assert_firmware_gives_gravity(found: dict[str, Any], document: dict[str, Any]) -> None:
    """Every row of the file, at whatever temperature: a loop of 1 mg is what remains."""
    [block] = found["blocks"]
    low, high = found["temperature_range_c"]
    table, vectors = document["table"], []
    for row, temperature in enumerate(table["temperature_c"]):
        dT = min(max(temperature, low), high) - found["reference_temperature_c"]
        a = []
        for sensor in block["sensors"]:
            scale = sum(c * dT**k for k, c in enumerate(sensor["scale_over_temperature"]))
            bias = sum(c * dT**k for k, c in enumerate(sensor["bias_over_temperature"]))
            a.append((table[sensor["name"]][row] - sensor["offset"]) / scale - bias)
        vectors.append(np.array(block["matrix"]) @ a)
    assert vectors[0] == pytest.approx(block["example"]["vector"], abs=1e-3)
    assert np.linalg.norm(vectors, axis=1) == pytest.approx(np.full(len(vectors), 9.81), abs=0.02)


def test_the_next_thermal_session_is_judged_against_the_first(client: httpx.Client, document: dict[str, Any]) -> None:
    send(client, document)
    later = document | {"started_at": "2026-05-01T09:00:00Z", "notes": "again"}
    table = dict(later["table"])
    table["A1"] = [reading + 1e-2 for reading in table["A1"]]
    answer = client.get(f"/api/v1/sessions/{send(client, later | {'table': table})}").json()
    assert answer["verdict"] == "fail"
    assert "A1" in answer["reason"]
