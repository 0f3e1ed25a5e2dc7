"""docs/how-to/add-a-programme.md, followed: a session of a new programme is read, calibrated, stored and judged."""

import json
from typing import Any

import httpx
import numpy as np
import pytest

from tests.builders import GRAVITY
from tests.how_to.conftest import Served

SCALE, BIAS = 0.12, 2e-3
AXES = np.eye(3)
UP = np.repeat(AXES, 2, axis=0) * np.tile([[1.0], [-1.0]], (3, 1))
"""(6, 3) where each axis points up, then down."""


def measured(moved: float, month: int) -> dict[str, Any]:
    """A two-point session of three accelerometers; the bias of A1 has moved, m/s²."""
    bias = BIAS + moved * AXES[0]
    noise = 3e-6 * np.random.default_rng(month).standard_normal((6, 3))
    readings = SCALE * (GRAVITY * UP @ AXES + bias) + noise
    names = ("A1", "A2", "A3")
    return {
        "format": "imu-session/1",
        "unit": "TP-1",
        "block": "accelerometer",
        "programme": "two-point",
        "started_at": f"2026-{month:02d}-01T09:00:00Z",
        "site": {"gravity_m_s2": GRAVITY},
        "direction_sigma_deg": 0.1,
        "sensors": [
            {"name": name, "nominal_axis": axis, "nominal_scale": 0.12, "reading_unit": "V"}
            for name, axis in zip(names, AXES.tolist(), strict=True)
        ],
        "table": {
            **{f"direction_{letter}": UP[:, k].tolist() for k, letter in enumerate("xyz")},
            **{name: readings[:, k].tolist() for k, name in enumerate(names)},
            **{f"{name}_se": [3e-6] * 6 for name in names},
        },
    }


@pytest.fixture
def service(served: Served) -> httpx.Client:
    """A service that knows the page's programme."""
    return served.http


@pytest.fixture(scope="module")
def answers(served: Served) -> list[dict[str, Any]]:
    """Answers to three sessions: the reference, an unchanged one, one in which A1 has moved by 500 µg."""
    sessions = (measured(0.0, 1), measured(0.0, 2), measured(5e-3, 3))
    return [served.http.post("/api/v1/sessions", content=json.dumps(session)).json() for session in sessions]


def test_the_truth_is_found_within_its_uncertainty(service: httpx.Client, answers: list[dict[str, Any]]) -> None:
    found = service.get(f"/api/v1/sessions/{answers[0]['id']}/calibration").json()["sensors"][1]
    for parameter, truth in (("scale", SCALE), ("bias", BIAS)):
        assert abs(found[parameter]["value"] - truth) < 4 * found[parameter]["sigma"]


def test_sessions_are_judged_against_the_first(answers: list[dict[str, Any]]) -> None:
    assert [answer["is_reference"] for answer in answers] == [True, False, False]
    assert [answer["verdict"] for answer in answers[1:]] == ["pass", "fail"]
    assert answers[2]["reason"].startswith("A1 bias changed by +513 µg")


def test_a_session_that_never_turned_a_sensor_over_is_refused(service: httpx.Client) -> None:
    session = measured(0.0, 4)
    session["table"] = {name: column[:3] for name, column in session["table"].items()}
    answer = service.post("/api/v1/sessions", content=json.dumps(session))
    assert answer.status_code == 422
    assert "never turned over" in answer.json()["problems"][0]["message"]


def test_the_session_has_its_page(service: httpx.Client, answers: list[dict[str, Any]]) -> None:
    assert "A1 bias changed" in service.get(f"/sessions/{answers[2]['id']}").text
