"""A diagnosis raises a flag where it names a sensor's cause or leaves structure unexplained."""

import json

import httpx
import pytest

from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.diagnosed import (
    DOUBTED,
    ECCENTRIC,
    TEMPERATURE,
    UNEXPLAINED,
    diagnosis_of,
    drawn,
    files_of,
    held,
    send,
    swaying_stand,
    warm,
)
from tests.service.recordings import recording_document


def flagged(client: httpx.Client, id: str) -> list[tuple[str, str, str]]:
    """Matter, place and state of every flag of a session's unit."""
    unit = client.get(f"/api/v1/sessions/{id}").json()["unit"]
    flags = client.get(f"/api/v1/units/{unit}/flags").json()["flags"]
    return [(flag["matter"], flag["place"], flag["state"]) for flag in flags]


def test_a_named_cause_raises_a_flag_on_its_sensor(holding: Holding) -> None:
    assert flagged(*held(holding, TEMPERATURE)) == [("cause", "A5", "raised")]


def test_an_unexplained_structure_raises_a_flag_on_the_unit(holding: Holding) -> None:
    assert ("unexplained", "", "raised") in flagged(*held(holding, UNEXPLAINED))


def test_a_cause_that_an_unknown_one_may_be_raises_its_flag_with_the_doubt(holding: Holding) -> None:
    client, id = held(holding, DOUBTED)
    assert ("cause", "A2", "raised") in flagged(client, id)
    said = [flag["summary"] for flag in client.get("/api/v1/flags").json()["flags"] if flag["place"] == "A2"]
    assert said == ["The bias of A2 has one step (95.1\xa0% likely), or a cause outside the catalogue."]


def test_what_all_sensors_show_is_a_matter_of_stand_or_fixture(holding: Holding) -> None:
    content = json.dumps(swaying_stand()).encode()
    (flag,) = holding(content, diagnosed=True).get("/api/v1/flags").json()["flags"]
    assert (flag["matter"], flag["place"]) == ("unexplained", "")
    assert flag["summary"].startswith("An effect common to all sensors, of the stand or fixture")


def test_a_cause_that_nobody_knows_cannot_be_accepted(holding: Holding) -> None:
    client, id = held(holding, DOUBTED)
    new = {"cause": "unexplained", "scope": "unit", "by": "K. Ito"}
    refused = client.post(f"/api/v1/sessions/{id}/diagnosis/accept", json=new)
    assert refused.status_code == 422
    assert "is not among the causes that this session shows" in refused.json()["problems"][0]["message"]


def test_a_fault_of_the_stand_raises_a_flag_on_the_stand(holding: Holding) -> None:
    client, _ = held(holding, ECCENTRIC)
    [flag] = [flag for flag in client.get("/api/v1/flags").json()["flags"] if flag["matter"] == "stand"]
    stand = drawn(ECCENTRIC).session["stand"]["id"]
    assert (flag["scope"], flag["subject"], flag["state"]) == ("stand", stand, "raised")
    assert flag["summary"].endswith(f"Seen with {flag['unit']}.")


def test_a_recording_in_which_no_causes_are_looked_for_speaks_for_resolving_none(holding: Holding) -> None:
    document = warm(2, "2026-03-05T08:00:00Z")
    client = holding(json.dumps(document).encode(), diagnosed=True)
    own = {"unit": document["unit"], "sensors": document["sensors"], "started_at": "2026-09-01T09:00:00Z"}
    recording = recording_document(m=len(document["sensors"])) | own
    diagnosis_of(client, send(client, recording))
    (unit,) = client.get("/api/v1/units").json()["units"]
    assert unit["last_at"].startswith("2026-09-01")
    [flag] = [flag for flag in client.get("/api/v1/flags").json()["flags"] if flag["matter"] == "cause"]
    assert (flag["state"], flag["proposal"]) == ("raised", "")


@pytest.mark.parametrize("accept", [True, False])
def test_an_accepted_cause_raises_nothing_any_more(holding: Holding, accept: bool) -> None:
    client, first = held(holding, TEMPERATURE)
    [flag] = client.get("/api/v1/flags").json()["flags"]
    client.post(f"/api/v1/flags/{flag['id']}/resolve", json={"by": "K. Ito", "why": "known"}).raise_for_status()
    if accept:
        new = {"cause": "bias-temperature", "scope": "unit", "by": "K. Ito"}
        client.post(f"/api/v1/sessions/{first}/diagnosis/accept", json=new).raise_for_status()
    session = json.loads(files_of(drawn(TEMPERATURE))[-1])
    later = send(client, session | {"started_at": "2026-11-01T09:00:00Z", "notes": "measured again"})
    diagnosis_of(client, later)
    states = [state for matter, _, state in flagged(client, later) if matter == "cause"]
    assert states == (["resolved"] if accept else ["raised", "resolved"])
