"""Two real recordings of one sensor array: converted, uploaded over HTTP, and read back as a history."""

import json
import os
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from benchmarks.convert import convert
from service.settings import Settings
from tests.databases import one_engine
from tests.serving import serving

PROJECT = Path(__file__).parents[2]
RECORDINGS = Path(os.environ.get("IMU_HEALTH_RECORDINGS", PROJECT.parent / "shared" / "data"))
STREAMS = [RECORDINGS / "kth-mimu-array" / f"exp_{number}.data.bin" for number in (1, 4)]
ACCELEROMETERS = 24
"""Eight triads on one board."""


@pytest.fixture(scope="module")
def sessions() -> list[tuple[str, bytes]]:
    """The accelerometers of the two sessions, as the shipped converter writes them."""
    if not all(stream.exists() for stream in STREAMS):
        pytest.skip(f"no recordings in {RECORDINGS}; set IMU_HEALTH_RECORDINGS to the folder that holds kth-mimu-array")
    return [(name, json.dumps(accelerometers(document)).encode()) for name, document in convert("kth-mimu", STREAMS)]


def accelerometers(document: dict[str, Any]) -> dict[str, Any]:
    """The session without its gyros: half the sensors, an eighth of the time that its diagnosis takes."""
    gyros = {sensor["name"] for sensor in document["sensors"] if sensor.get("kind", document["block"]) == "gyroscope"}
    left_out = gyros | {f"{name}_se" for name in gyros}
    return document | {
        "sensors": [sensor for sensor in document["sensors"] if sensor["name"] not in gyros],
        "table": {name: column for name, column in document["table"].items() if name not in left_out},
    }


@pytest.fixture
def answers(settings: Settings, sessions: list[tuple[str, bytes]]) -> Any:
    """Answers of the service after the two uploads."""
    with serving(settings) as address, httpx.Client(base_url=f"{address}/api/v1") as http:
        receipts = [http.post("/sessions", files={"file": session}) for session in sessions]
        assert [receipt.status_code for receipt in receipts] == [201, 201], [r.text for r in receipts]
        unit = receipts[0].json()["unit"]
        yield {
            "ids": [receipt.json()["id"] for receipt in receipts],
            "scales": http.get(f"/units/{unit}/history", params={"parameter": "scale"}).json()["points"],
            "file": http.get(f"/sessions/{receipts[0].json()['id']}/file").content,
            "again": http.post("/sessions", content=sessions[0][1]),
            "unit": http.get(f"/units/{unit}").json(),
        }


@one_engine
def test_two_real_sessions_become_a_history(answers: Any, sessions: list[tuple[str, bytes]]) -> None:
    """One test for it all, because the uploads take their time."""
    points = [point for point in answers["scales"] if point["kind"] == "accelerometer"]
    assert [point["session"] for point in points] == [id for id in answers["ids"] for _ in range(ACCELEROMETERS)]
    assert all(point["lower"] < point["value"] < point["upper"] for point in points)
    assert answers["unit"]["summary"]["sessions"] == 2
    assert answers["unit"]["reference_session"] == answers["ids"][0]
    assert not answers["unit"]["summary"]["simulated"]
    assert answers["file"] == sessions[0][1]
    assert (answers["again"].status_code, answers["again"].json()["id"]) == (200, answers["ids"][0])
    scales = np.array([point["value"] for point in points]).reshape(2, ACCELEROMETERS)
    repeated = np.sqrt(np.mean((scales[1] / scales[0] - 1) ** 2))
    assert repeated < 400e-6, "the recording's own notes: 200 to 400 ppm from session to session"
