"""A table of one's own layout by the API: looked at without a trace, stored with its mapping, known again."""

import json
from typing import Any

import httpx

from service.ingest.layout.envelope import is_wrapped
from tests.databases import one_engine
from tests.service import tables

TABLE = tables.text_table(tables.own_document()).encode("cp1251")
PREVIEW = "/api/v1/layouts/preview"


def previewed(client: httpx.Client, content: bytes = TABLE, mapping: Any = None, **query: str) -> dict[str, Any]:
    stated = {} if mapping is None else {"mapping": json.dumps(mapping)}
    answer = client.post(PREVIEW, files={"file": ("own.csv", content)}, data=stated, params=query)
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


def whole_mapping(client: httpx.Client, **facts: Any) -> dict[str, Any]:
    """The mapping as it is proposed, with what the table does not state."""
    mapping = previewed(client)["mapping"]
    return {**mapping, "session": tables.facts_of(tables.own_document(**facts))}


def stored(client: httpx.Client, mapping: dict[str, Any], content: bytes = TABLE) -> httpx.Response:
    return client.post("/api/v1/sessions", files={"file": ("own.csv", content)}, data={"mapping": json.dumps(mapping)})


def test_a_preview_says_what_is_understood_and_what_is_missing(client: httpx.Client) -> None:
    found = previewed(client)
    assert [column["as"] for column in found["mapping"]["columns"]] == [
        "run", "beta_deg", "temperature_c", "A1", "A2", "A3",
    ]  # fmt: skip
    assert found["mapping"]["table"]["encoding"] == "cp1251"
    assert {"unit", "stand.id", "sensors[1].nominal_axis"} <= {problem["field"] for problem in found["problems"]}


def test_a_preview_shows_the_first_rows_in_si(client: httpx.Client) -> None:
    found = previewed(client, mapping=whole_mapping(client))
    assert found["problems"] == []
    assert found["first_rows"][1]["run"] == "direct"
    assert abs(found["first_rows"][1]["beta_rad"] - 0.5235987756) < 1e-9
    assert abs(found["felt"] - 9.815) < 0.01


def test_a_preview_leaves_no_trace(client: httpx.Client) -> None:
    previewed(client, mapping=whole_mapping(client))
    assert client.get("/api/v1/sessions").json()["sessions"] == []
    assert client.get("/api/v1/audit").json()["lines"] == []


def test_the_bytes_are_stored_unchanged_with_their_mapping(client: httpx.Client) -> None:
    answer = stored(client, whole_mapping(client))
    assert answer.status_code == 201, answer.text
    file = f"/api/v1/sessions/{answer.json()['id']}/file"
    assert client.get(file, params={"original": "true"}).content == TABLE
    assert is_wrapped(client.get(file).content)


def test_the_stored_file_is_a_session_file_itself(client: httpx.Client) -> None:
    id = stored(client, whole_mapping(client)).json()["id"]
    again = client.post("/api/v1/sessions", content=client.get(f"/api/v1/sessions/{id}/file").content)
    assert (again.status_code, again.json()["id"]) == (200, id)


def test_a_session_with_a_mapping_is_read_again_from_its_bytes(client: httpx.Client) -> None:
    id = stored(client, whole_mapping(client)).json()["id"]
    assert client.get(f"/api/v1/sessions/{id}/correction").status_code == 200


def test_the_same_content_as_a_session_file_is_the_same_session(client: httpx.Client) -> None:
    first = stored(client, whole_mapping(client)).json()
    again = client.post("/api/v1/sessions", json=tables.own_document())
    assert (again.status_code, again.json()["id"]) == (200, first["id"])


def test_the_same_bytes_of_another_unit_are_another_session(client: httpx.Client) -> None:
    first = stored(client, whole_mapping(client)).json()
    other = stored(client, whole_mapping(client, unit="BA-018")).json()
    assert other["created"]
    assert other["id"] != first["id"]


def test_a_layout_is_known_again_and_asks_for_unit_and_date_alone(client: httpx.Client) -> None:
    assert stored(client, whole_mapping(client)).status_code == 201
    other = tables.own_document()
    other["table"]["A1"] = [cell + 1e-6 for cell in other["table"]["A1"]]
    found = previewed(client, tables.text_table(other).encode())
    assert found["remembered"]
    assert [problem["field"] for problem in found["problems"]] == ["unit"]
    assert "started_at" not in found["mapping"]["session"]


@one_engine
def test_the_next_table_of_a_simulated_unit_must_say_that_it_is_simulated_too(client: httpx.Client) -> None:
    first = stored(client, whole_mapping(client, origin="simulated")).json()
    assert client.get(first["url"]).json()["simulated"]
    proposed = previewed(client, unit="BA-017")["mapping"]
    silent = {**proposed, "session": proposed["session"] | {"started_at": "2026-04-01T09:00:00Z"}}
    refused = stored(client, silent)
    assert [problem["field"] for problem in refused.json()["problems"]] == ["origin"]
    said = {**silent, "session": silent["session"] | {"origin": "simulated"}}
    assert stored(client, said).status_code == 201


def test_what_the_unit_said_last_is_offered(client: httpx.Client) -> None:
    client.post("/api/v1/sessions", json=tables.own_document())
    found = previewed(client, unit="BA-017")
    assert found["problems"] == []
    assert found["mapping"]["session"]["stand"]["id"] == "ODG-1"


def test_a_mapping_for_other_headings_is_refused_with_them(client: httpx.Client) -> None:
    mapping = whole_mapping(client)
    answer = stored(client, mapping, TABLE.replace("Угол".encode("cp1251"), "Крен".encode("cp1251")))
    assert answer.status_code == 422
    assert "columns" in [problem["field"] for problem in answer.json()["problems"]]


def test_a_mapping_that_is_no_json_is_refused(client: httpx.Client) -> None:
    answer = client.post("/api/v1/sessions", files={"file": ("own.csv", TABLE)}, data={"mapping": "{"})
    assert answer.status_code == 422


def test_a_session_file_needs_no_mapping(client: httpx.Client) -> None:
    content = json.dumps(tables.own_document()).encode()
    assert stored(client, whole_mapping(client), content).status_code == 422
    assert client.post(PREVIEW, files={"file": ("x.json", content)}).status_code == 422
