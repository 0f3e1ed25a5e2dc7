"""A diagnosis raises a flag where it names a sensor's cause or leaves structure unexplained."""

import httpx
import pytest

from tests.service.diagnosed import ECCENTRIC, TEMPERATURE, UNEXPLAINED, diagnosis_of, drawn, send, send_case


def flagged(client: httpx.Client, id: str) -> list[tuple[str, str, str]]:
    """Matter, place and state of every flag of a session's unit."""
    diagnosis_of(client, id)
    unit = client.get(f"/api/v1/sessions/{id}").json()["unit"]
    flags = client.get(f"/api/v1/units/{unit}/flags").json()["flags"]
    return [(flag["matter"], flag["place"], flag["state"]) for flag in flags]


def test_a_named_cause_raises_a_flag_on_its_sensor(client: httpx.Client) -> None:
    assert flagged(client, send_case(client, drawn(TEMPERATURE))) == [("cause", "A5", "raised")]


def test_an_unexplained_structure_raises_a_flag_on_the_unit(client: httpx.Client) -> None:
    assert ("unexplained", "", "raised") in flagged(client, send_case(client, drawn(UNEXPLAINED)))


def test_a_fault_of_the_stand_raises_a_flag_on_the_stand(client: httpx.Client) -> None:
    case = drawn(ECCENTRIC)
    assert ("stand", case.session["stand"]["id"], "raised") in flagged(client, send_case(client, case))


@pytest.mark.parametrize("accept", [True, False])
def test_an_accepted_cause_raises_nothing_any_more(client: httpx.Client, accept: bool) -> None:
    case = drawn(TEMPERATURE)
    first = send(client, case.session)
    [flag] = client.get(f"/api/v1/units/{case.session['unit']}/flags").json()["flags"]
    client.post(f"/api/v1/flags/{flag['id']}/resolve", json={"by": "K. Ito", "why": "known"}).raise_for_status()
    if accept:
        new = {"cause": "bias-temperature", "scope": "unit", "by": "K. Ito"}
        client.post(f"/api/v1/sessions/{first}/diagnosis/accept", json=new).raise_for_status()
    later = send(client, case.session | {"started_at": "2026-11-01T09:00:00Z", "notes": "measured again"})
    states = [state for matter, _, state in flagged(client, later) if matter == "cause"]
    assert states == (["resolved"] if accept else ["raised", "resolved"])
