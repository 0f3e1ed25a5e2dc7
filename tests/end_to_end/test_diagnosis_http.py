"""Every cause of the catalogue, hidden by an independent generator, is found over HTTP."""

from collections.abc import Iterator

import httpx
import pytest

from service.app import create_app
from service.settings import Settings
from tests.blind.case import Case
from tests.blind.cases import draw_case
from tests.blind.catalogue import CATALOGUE
from tests.blind.score import score
from tests.databases import Databases
from tests.service.diagnosed import diagnosis_of, send_case
from tests.serving import http_client

LONGEST = 16
SEED = 400
TRIES = 12
"""A case in which the cause is told apart from every rival is looked for among so many."""
SHARED = {"bias-per-position", "levelling-y", "meridian-error", "g-sensitivity"}
"""Causes that leave the trace of another one on the blocks that show them: they are listed, if not first."""


@pytest.fixture(scope="module")
def address(sqlite: Databases, tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """One service for all causes."""
    settings = Settings(database_url=sqlite.migrated(), data_folder=tmp_path_factory.mktemp("data"))
    with http_client(create_app(settings)) as client:
        yield client


def separated(cause: str) -> Case:
    """The case that is told apart best among some."""
    drawn: list[Case] = []
    for number in range(TRIES):
        drawn.append(draw_case("single", (SEED, list(CATALOGUE).index(cause), number), cause, LONGEST))
        if drawn[-1].truths[0].separation >= 8:
            break
    return max(drawn, key=lambda case: case.truths[0].separation)


@pytest.mark.parametrize("cause", CATALOGUE)
def test_a_hidden_cause_is_found_over_http(address: httpx.Client, cause: str) -> None:
    case = separated(cause)
    found = diagnosis_of(address, send_case(address, case))
    outcome = score(case, found, 0.0)
    assert outcome.listed, outcome
    assert outcome.first or not outcome.separated or cause in SHARED, outcome


def test_a_session_without_an_effect_gets_no_name(address: httpx.Client) -> None:
    case = draw_case("none", (SEED, 1), None, LONGEST)
    found = diagnosis_of(address, send_case(address, case))
    assert (found["findings"], found["unexplained"], found["state"]) == ([], False, "nothing wrong")


def test_structure_outside_the_catalogue_is_unexplained_over_http(address: httpx.Client) -> None:
    case = draw_case("outside", (5, 1), "fifth-harmonic", LONGEST)
    found = diagnosis_of(address, send_case(address, case))
    assert (found["findings"], found["unexplained"]) == ([], True)
    assert "harmonic 5" in found["summary"]
