"""Flags over HTTP."""

import httpx
import pytest

FLAGS = "/api/v1/units/BA-017/flags"
WHO = {"by": "K. Ito", "why": "replacement ordered"}


def only(client: httpx.Client) -> dict[str, object]:
    [flag] = client.get(FLAGS, params={"state": "raised"}).json()["flags"]
    found: dict[str, object] = flag
    return found


def test_a_unit_s_flags_are_there_with_their_lives(flagged: httpx.Client) -> None:
    flag = only(flagged)
    assert (flag["matter"], flag["place"], flag["state"]) == ("out-of-tolerance", "A3", "raised")
    assert flagged.get("/api/v1/units/BA-017").json()["summary"]["flags"] == 1
    assert flagged.get("/api/v1/fleet").json()["flags"] == 1


def test_a_flag_is_acknowledged_then_resolved_once(flagged: httpx.Client) -> None:
    path = f"/api/v1/flags/{only(flagged)['id']}"
    done = [flagged.post(f"{path}/{what}", json=WHO) for what in ("acknowledge", "resolve", "resolve")]
    assert [answer.status_code for answer in done] == [200, 200, 409]
    assert [change["kind"] for change in done[1].json()["changes"]] == [
        "flag.raised",
        "flag.acknowledged",
        "flag.resolved",
    ]
    assert done[2].headers["content-type"] == "application/problem+json"


@pytest.mark.parametrize("body", [{"by": "K. Ito"}, {"by": "K. Ito", "why": "  "}, {"by": "", "why": "done"}])
def test_name_and_reason_are_required(flagged: httpx.Client, body: dict[str, str]) -> None:
    assert flagged.post(f"/api/v1/flags/{only(flagged)['id']}/acknowledge", json=body).status_code == 422
    assert only(flagged)["state"] == "raised"


def test_flags_of_the_fleet_are_listed_by_state(flagged: httpx.Client) -> None:
    def listed(state: str) -> int:
        return len(flagged.get("/api/v1/flags", params={"state": state}).json()["flags"])

    assert (listed("raised"), listed("acknowledged")) == (1, 0)
    flagged.post(f"/api/v1/flags/{only(flagged)['id']}/acknowledge", json=WHO)
    assert (listed("raised"), listed("acknowledged")) == (0, 1)


def test_what_is_not_there_is_404(client: httpx.Client) -> None:
    assert client.get("/api/v1/units/none/flags").status_code == 404
    assert client.post("/api/v1/flags/1/resolve", json=WHO).status_code == 404
