"""Causes hidden by an independent generator are found over HTTP; `tests/blind` has all of them, and
`tests/test_hidden_effect.py` what is without a name."""

from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from typing import Any

import pytest

from service.app import create_app
from service.uploads.receive import upload
from tests.blind.case import Case
from tests.blind.cases import draw_case
from tests.blind.catalogue import CATALOGUE
from tests.blind.score import score
from tests.conftest import StockOf
from tests.databases import Databases
from tests.service.diagnosed import diagnosis_of, files_of
from tests.serving import http_client
from tests.stock import stores

Diagnosed = Callable[[Case], dict[str, Any]]
NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
LONGEST = 16
SEED = 400
TRIES = 12
"""A case in which the cause is told apart from every rival is looked for among so many."""
HIDDEN = list(CATALOGUE)[3::15]


@pytest.fixture(scope="module")
def diagnosed(sqlite: Databases, stock_of: StockOf) -> Iterator[Diagnosed]:
    """Diagnoses the session of a case over HTTP, its history stored before, in one service for all causes."""
    with (
        stock_of(sqlite).holding() as settings,
        http_client(create_app(settings)) as client,
        stores(settings) as storage,
    ):

        def diagnose(case: Case) -> dict[str, Any]:
            *history, session = files_of(case)
            for earlier in history:
                upload(storage, earlier, "earlier.json", NOW)
            return diagnosis_of(client, client.post("/api/v1/sessions", content=session).json()["id"])

        yield diagnose


def separated(cause: str) -> Case:
    """The case that is told apart best among some."""
    drawn: list[Case] = []
    for number in range(TRIES):
        drawn.append(draw_case("single", (SEED, list(CATALOGUE).index(cause), number), cause, LONGEST))
        if drawn[-1].truths[0].separation >= 8:
            break
    return max(drawn, key=lambda case: case.truths[0].separation)


@pytest.mark.parametrize("cause", HIDDEN)
def test_a_hidden_cause_is_found_over_http(diagnosed: Diagnosed, cause: str) -> None:
    case = separated(cause)
    outcome = score(case, diagnosed(case), 0.0)
    assert outcome.listed, outcome
    assert outcome.first or not outcome.separated, outcome
