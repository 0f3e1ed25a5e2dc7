"""The rows that a session under way still lacks, by the API; nothing is stored."""

import json

import httpx

from tests.builders import Document, accelerometer_block, arbitrary_orientations
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - a hook
from tests.service import tables
from tests.service.filled import filled

ADDRESS = "/api/v1/plan/missing"


def so_far(document: Document, count: int) -> Document:
    """The document with its first rows alone."""
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


def test_a_half_filled_workbook_says_what_is_to_come_and_is_not_stored(client: httpx.Client) -> None:
    template = client.get("/api/v1/session-template").content
    workbook = filled(template, {"unit": "MY-1", "stand.id": "S1"}, 9)
    assert client.post(ADDRESS, files={"file": ("so-far.xlsx", workbook)}).json()["done"] == 9
    page = client.post("/upload", files={"files": ("so-far.xlsx", workbook)}, data={"look": "yes"})
    assert page.status_code == 200
    assert "9 positions are done, 15 still to come." in page.text
    assert client.get("/api/v1/sessions").json()["sessions"] == []


def test_a_half_filled_table_of_ones_own_says_what_is_to_come(client: httpx.Client) -> None:
    document = tables.own_document()
    head, *rows = tables.text_table(document).split("\n")
    own = "\n".join([head, *rows[:9], *(";".join(row.split(";")[:3]) + ";;;" for row in rows[9:] if row)])
    facts = tables.facts_of(document)
    proposed = client.post("/api/v1/layouts/preview", files={"file": ("own.csv", own)}).json()["mapping"]
    sent = {"file": ("own.csv", own), "mapping": (None, json.dumps({**proposed, "session": facts}))}
    found = client.post("/api/v1/layouts/preview", files=sent).json()
    assert found["so_far"][0].startswith("9 positions are done")
    assert found["problems"]
