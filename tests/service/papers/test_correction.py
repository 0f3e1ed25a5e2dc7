"""The correction over HTTP: a program that knows only the document gives back what the stand applied."""

import json
import math
from typing import Any

import httpx
import numpy as np
import pytest

from tests.builders import accelerometer_block, arbitrary_orientations, gyro_block, raw_log
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.diagnosed import ECCENTRIC, accepted, held, send
from tests.service.turntable import alignment_bytes

Document = dict[str, Any]


def correction(client: httpx.Client, id: str) -> Document:
    """imu-correction/1 of a session."""
    answer = client.get(f"/api/v1/sessions/{id}/correction")
    assert answer.status_code == 200, answer.text
    found: Document = answer.json()
    return found


def firmware(block: Document, readings: list[float]) -> list[float]:
    """The three steps of the formula, as firmware would write them."""
    components = []
    for sensor, reading in zip(block["sensors"], readings, strict=True):
        y = (reading - sensor["offset"]) / ((sensor["count_time"] or 1) * sensor["scale"]) - sensor["bias"]
        components.append(2 * y / (1 + math.sqrt(1 + 4 * sensor["quadratic"] * y)))
    return [sum(m * a for m, a in zip(row, components, strict=True)) for row in block["matrix"]]


@pytest.mark.parametrize("document", [accelerometer_block(positions=24), gyro_block(), arbitrary_orientations()])
def test_firmware_gets_the_worked_example(client: httpx.Client, document: Document) -> None:
    [block] = correction(client, send(client, document))["blocks"]
    example = block["example"]
    assert example["readings"] == [document["table"][sensor["name"]][0] for sensor in block["sensors"]]
    assert firmware(block, example["readings"]) == pytest.approx(example["vector"], rel=1e-12)
    assert f"{example['vector'][0]:.9g}" in " ".join(example["words"])


def test_every_row_of_the_file_comes_back_as_what_the_stand_applied(client: httpx.Client) -> None:
    document = accelerometer_block(positions=24)
    [block] = correction(client, send(client, document))["blocks"]
    columns = [document["table"][sensor["name"]] for sensor in block["sensors"]]
    found = np.array([firmware(block, list(row)) for row in zip(*columns, strict=True)])
    assert block["example"]["applied"] == pytest.approx(found[0], abs=1e-3)
    # One reading is known to 2.5e-5 m/s²; six of them make a component of about 1.8e-5.
    assert np.linalg.norm(found, axis=1) == pytest.approx(np.full(48, 9.81532), abs=1e-4)


def test_a_raw_log_is_corrected_too(client: httpx.Client) -> None:
    [block] = correction(client, send(client, raw_log()))["blocks"]
    assert np.linalg.norm(block["example"]["vector"]) == pytest.approx(9.81532, rel=1e-3)


def test_it_says_what_it_rests_on_and_what_it_leaves(holding: Holding) -> None:
    client, id = held(holding, ECCENTRIC)
    finding, revision = accepted(client, id)
    found = correction(client, id)
    [extended] = found["extended_model"]
    assert (found["sha256"][:20], found["model_revision"]) == (id, revision)
    assert (extended["cause"], extended["amplitude"]) == (finding["cause"], finding["amplitude"])
    assert any("temperature" in line for line in found["not_corrected"])


def test_an_alignment_has_no_correction(client: httpx.Client) -> None:
    answer = client.get(f"/api/v1/sessions/{send(client, json.loads(alignment_bytes()))}/correction")
    assert answer.status_code == 404
    assert "does not calibrate a block" in answer.json()["detail"]


def test_numbers_survive_as_json(client: httpx.Client) -> None:
    id = send(client, accelerometer_block())
    text = client.get(f"/api/v1/sessions/{id}/correction").text
    assert "NaN" not in text
    assert json.loads(text)["format"] == "imu-correction/1"
