"""What a session still lacks while it is measured, by the API and the command; nothing is stored."""

import json
from pathlib import Path

import httpx

from tests.builders import Document, accelerometer_block, arbitrary_orientations
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - a hook
from tests.service.commands.conftest import Run, run, write  # noqa: F401 - a fixture

ADDRESS = "/api/v1/plan/missing"


def so_far(document: Document, count: int) -> Document:
    """Its first rows."""
    return document | {"table": {name: column[:count] for name, column in document["table"].items()}}


def test_a_session_so_far_is_told_what_is_to_come(client: httpx.Client) -> None:
    found = client.post(ADDRESS, json=so_far(accelerometer_block(positions=12), 9)).json()
    assert (found["done"], found["positions"], found["complete"]) == (9, 12, False)
    assert found["settings"][0] == {"run": "direct", "beta_deg": 270.0}
    assert found["said"][:2] == ["9 positions are done, 15 still to come.", "direct: β = 270°, 300°, 330°"]
    assert client.get("/api/v1/sessions").json()["sessions"] == []


def test_orientations_to_add_are_said_as_directions(client: httpx.Client) -> None:
    found = client.post(ADDRESS, json=so_far(arbitrary_orientations(), 8)).json()
    assert len(found["directions"]) == 1
    assert found["said"][1].startswith("up along (")


def test_a_file_that_cannot_be_read_is_refused_with_its_problems(client: httpx.Client) -> None:
    answer = client.post(ADDRESS, json=so_far(accelerometer_block(positions=12), 1))
    assert (answer.status_code, answer.json()["problems"][0]["field"]) == (422, "beta_deg")


def test_the_command_says_the_same(run: Run, tmp_path: Path) -> None:  # noqa: F811
    file = write(tmp_path, "so-far.json", so_far(accelerometer_block(positions=12), 13))
    assert "flipped: β = 30°, 60°" in run("missing", file).out
    assert run("missing", file, "-n", 24, "--json").documents[0]["positions"] == 24
    short = write(tmp_path, "one.json", json.loads(json.dumps(so_far(accelerometer_block(positions=12), 1))))
    assert run("missing", short).code == 2
