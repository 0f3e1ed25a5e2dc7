"""What the sessions of a unit show together, on its page."""

import re

import httpx
import pytest

from tests.conftest import Holding
from tests.databases import one_engine
from tests.service.grouped import GROUP


def words(client: httpx.Client) -> str:
    """The text of the unit's page."""
    text = client.get("/units/BA-017", headers={"Accept": "text/html"}).raise_for_status().text
    return " ".join(re.sub(r"<[^>]+>", " ", text).split())


@pytest.fixture
def twelve(holding: Holding) -> httpx.Client:
    """A unit of twelve sessions, whose answer was asked for."""
    client = holding(*GROUP)
    client.get("/api/v1/units/BA-017/diagnosis").raise_for_status()
    return client


@one_engine
def test_the_page_says_what_they_show_how_large_and_in_which_session(twelve: httpx.Client) -> None:
    page = words(twelve)
    assert "What the simulation gets wrong, over 12 sessions" in page
    assert re.search(r"\d\.\d ± \d\.\d.µg/g³ in all of these sessions; \d\.\d standard errors", page)
    assert re.search(r"Session Unit Amplitude 1 Dec 2023 BA-017 \d\.\d ± \d", page)
    assert "A2 bends with the cube of the input, unless it is odd quadratic." in page
    assert re.search(r"What else it could be .* odd quadratic .* %", page)


@one_engine
def test_the_pool_finds_less_than_a_session_does(twelve: httpx.Client) -> None:
    together, alone = re.findall(r"cubic nonlinearity ([\d.]+).µg/g³ ([\d.]+).µg/g³", words(twelve))[0]
    assert 2 * float(together) < float(alone)


@one_engine
def test_until_it_is_made_the_page_says_where_to_ask(holding: Holding) -> None:
    client = holding(*GROUP[:2])
    assert "What its 2 sessions show together is not worked out with its latest records yet" in words(client)
