"""Flags narrowed by the address, and many of them handled at once."""

import httpx
import pytest
from lxml import html

from service.flags.view import FlagsView
from tests.conftest import Holding
from tests.service.made_sessions import session_bytes

SAID = {"by": "K. Ito", "why": "all seen"}


SESSIONS = tuple(
    session_bytes(seed=month, month=month, unit=unit, a3_moved=moved)
    for unit in ("BA-1", "BA-2", "XC-7")
    for month, moved in ((1, 0.0), (4, 200.0))
)


@pytest.fixture
def client(holding: Holding) -> httpx.Client:
    """Three units, each with a flag: out of tolerance."""
    return holding(*SESSIONS)


@pytest.fixture
def flagged(client: httpx.Client) -> list[int]:
    """The flags' numbers."""
    return sorted(flag["id"] for flag in client.get("/api/v1/flags").json()["flags"])


def states(client: httpx.Client) -> list[str]:
    """States of all flags, the oldest first."""
    found = client.get("/api/v1/flags").json()["flags"]
    return [flag["state"] for flag in sorted(found, key=lambda flag: int(flag["id"]))]


def test_the_list_is_narrowed_by_unit_matter_and_state(client: httpx.Client, flagged: list[int]) -> None:
    def shown(query: str) -> int:
        return client.get(f"/flags{query}").text.count('type="checkbox"')

    assert len(flagged) == 3
    assert [shown(q) for q in ("", "?q=ba", "?matter=drift", "?state=acknowledged", "?matter=odd")] == [3, 2, 0, 0, 3]
    assert "No open flag matches" in client.get("/flags?matter=drift").text


def test_ticked_flags_are_handled_at_once_and_the_view_stays(client: httpx.Client, flagged: list[int]) -> None:
    answer = client.post("/flags/acknowledge?q=BA", data=SAID | {"flag": flagged[:2]})
    assert (answer.status_code, answer.headers["location"]) == (303, "/flags?q=BA")
    assert states(client) == ["acknowledged", "acknowledged", "raised"]
    client.post("/flags/resolve", data=SAID | {"flag": flagged})
    assert states(client) == ["resolved"] * 3


def test_one_that_somebody_handled_meanwhile_is_left_alone(client: httpx.Client, flagged: list[int]) -> None:
    for _ in range(2):
        assert client.post("/flags/acknowledge", data=SAID | {"flag": flagged[:1]}).status_code == 303
    (one,) = [f for f in client.get("/api/v1/flags").json()["flags"] if f["id"] == flagged[0]]
    assert [change["kind"] for change in one["changes"]] == ["flag.raised", "flag.acknowledged"]


def test_a_flag_that_is_not_there_changes_none(client: httpx.Client, flagged: list[int]) -> None:
    assert client.post("/flags/resolve", data=SAID | {"flag": [*flagged, 9999]}).status_code == 404
    assert client.post("/flags/resolve", data=SAID).status_code == 422
    assert states(client) == ["raised"] * 3


def test_ticked_flags_are_given_to_somebody_and_found_by_the_name(client: httpx.Client, flagged: list[int]) -> None:
    answer = client.post("/flags/assign?matter=out-of-tolerance", data=SAID | {"flag": flagged[1:], "to": "M. Sato"})
    assert (answer.status_code, answer.headers["location"]) == (303, "/flags?matter=out-of-tolerance")
    assert [numbers(client, f"?assigned={who}") for who in ("M.+Sato", "nobody", "K.+Ito")] == [
        flagged[:0:-1],
        flagged[:1],
        [],
    ]
    assert "M. Sato" in client.get("/flags").text


def test_acknowledging_with_a_name_gives_them_too(client: httpx.Client, flagged: list[int]) -> None:
    client.post("/flags/acknowledge", data=SAID | {"flag": flagged[:1], "to": "M. Sato"})
    assert states(client) == ["acknowledged", "raised", "raised"]
    assert numbers(client, "?assigned=M.+Sato") == flagged[:1]


def test_a_page_stays_where_it_was_when_flags_before_it_are_settled(
    client: httpx.Client, flagged: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(FlagsView, "PAGE_SIZE", 1)
    second = html.fromstring(client.get("/flags").text).xpath("//a[@rel='next']/@href")[0]
    assert numbers(client, second.removeprefix("/flags")) == [flagged[1]]
    assert numbers(client, f"?sort=oldest&before={flagged[2]}") == [flagged[1]]
    client.post("/flags/resolve", data=SAID | {"flag": flagged[2:]})
    shown = client.get(second).text
    assert numbers(client, second.removeprefix("/flags")) == [flagged[1]]
    assert html.fromstring(shown).xpath("//a[@rel='next']/@href") == [f"/flags?after={flagged[1]}"]
    oldest = client.get("/flags?sort=oldest").text
    assert html.fromstring(oldest).xpath("//a[@rel='next']/@href") == [f"/flags?sort=oldest&after={flagged[0]}"]
    assert numbers(client, f"?sort=oldest&before={flagged[1]}") == [flagged[0]]


def numbers(client: httpx.Client, query: str) -> list[int]:
    """Numbers of the flags on a page, in its order."""
    boxes = html.fromstring(client.get(f"/flags{query}").text).xpath("//input[@name='flag']/@value")
    return [int(number) for number in boxes]


def test_a_view_comes_back_from_its_own_address() -> None:
    view = FlagsView(q=" BA ", matter="stand", state="raised")
    assert view.url() == "/flags?q=BA&matter=stand&state=raised"
