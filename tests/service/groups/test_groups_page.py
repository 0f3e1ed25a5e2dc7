"""Findings of a unit from all sessions together, on its page."""

import re

import httpx
import pytest

from tests.conftest import Holding
from tests.databases import one_engine
from tests.service.grouped import GROUP, WAVY


def words(client: httpx.Client) -> str:
    """The text of the unit's page."""
    return text_of(client, "/units/BA-017")


def text_of(client: httpx.Client, path: str) -> str:
    """The text of a page."""
    text = client.get(path, headers={"Accept": "text/html"}).raise_for_status().text
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
    assert "Diagnosis over 12 sessions" in page
    assert re.search(r"\d\.\d ± \d\.\d.µg/g³ in all of these sessions; \d\.\d standard errors", page)
    assert re.search(r"Session Unit Amplitude 1 Dec 2023 BA-017 \d\.\d ± \d", page)
    assert "A2 has a cubic nonlinearity; it could also be odd quadratic or a cause outside the catalogue." in page
    assert re.search(r"What else it could be .* odd quadratic .* %", page)


@one_engine
def test_it_is_drawn_and_the_same_stands_in_tables(twelve: httpx.Client) -> None:
    page = words(twelve)
    assert re.search(r"In each session .* \d\.\d ± \d\.\d.µg/g³ together", page)
    assert re.findall(r"(A2 with(?:out)? it) \d+ of \d+ outside ±2σ", page) == ["A2 without it", "A2 with it"]
    assert "input, of the applied vector without it with it" in page
    assert re.search(
        r"In the latest session the error of A2 [^;]*µg \(sizes as the first 8 sessions fixed them\)", page
    )
    assert re.search(
        r"Sizes estimated from the first 8 sessions, tested on the 4 later ones: .*, log score \d+\.\d more", page
    )


@one_engine
def test_the_pool_finds_less_than_a_session_does(twelve: httpx.Client) -> None:
    together, alone = re.findall(r"cubic nonlinearity ([\d.]+).µg/g³ ([\d.]+).µg/g³", words(twelve))[0]
    assert 2 * float(together) < float(alone)


@one_engine
def test_an_engineer_accepts_it_and_sees_what_it_moved(twelve: httpx.Client) -> None:
    form = {"level": "unit", "name": "BA-017", "cause": "cubic-nonlinearity", "sensors": ["A2"], "by": "K. Ito"}
    made = twelve.post("/groups/accept", data=form, headers={"Accept": "text/html"})
    assert made.status_code == 303
    page = text_of(twelve, made.headers["Location"])
    assert "Over 12 sessions, in all of these sessions" in page
    assert "12 sessions of 1 of 1 unit computed again:" in page
    assert re.search(r"BA-017 12 of 12 [a-z ]+ of A2 by .*? \(U.=.\d", page)
    assert "In the model of unit BA-017: revision 1" in words(twelve)
    ended = twelve.post("/models/1/withdraw", data={"by": "K. Ito", "why": "tilted"}, headers={"Accept": "text/html"})
    assert "it withdraws revision 1" in text_of(twelve, ended.headers["Location"])
    assert "Accept into the model of unit BA-017" in words(twelve)


@one_engine
def test_until_it_is_made_the_page_says_where_to_ask(holding: Holding) -> None:
    client = holding(*GROUP[:2])
    assert "What its 2 sessions show together has not been computed with the latest records" in words(client)


@one_engine
def test_a_learned_term_is_accepted_from_its_card_and_its_equation_stands_on_its_page(holding: Holding) -> None:
    client = holding(*WAVY)
    client.get("/api/v1/units/BA-017/diagnosis").raise_for_status()
    assert "Accept into the model of unit BA-017" in words(client)
    form = {"level": "unit", "name": "BA-017", "cause": "empirical-term", "sensors": ["A2"], "by": "K. Ito"}
    made = client.post("/groups/accept", data=form, headers={"Accept": "text/html"})
    page = text_of(client, made.headers["Location"])
    assert re.search(r"Empirical term \(A2\), unit BA-017 A2 reads high by \(.* sin 3β", page)
    assert "In the model of unit BA-017: revision 1" in words(client)
