"""What a session's page says of the model in force, and what is said when sessions were computed again."""

import httpx
import pytest

from service.judging.model_in_force import model_as_of
from service.pages.session import session_page
from service.records.model import ModelRevision, Scope
from service.words.recalibrated import recalibrated_in_words
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.pages.records import NOON, session_report
from tests.service.sessions import FAILED, session_id


def revision(number: int, withdraws: int | None = None) -> ModelRevision:
    return ModelRevision(number, Scope.UNIT, "BA-017", "cubic", ("A2",), "5e55", None, "K. Ito", "", NOON, withdraws)


def test_a_session_names_the_causes_of_its_own_model_and_its_earlier_results() -> None:
    every = (revision(1), revision(2), revision(3, withdraws=2))
    assert [one.id for one in model_as_of(every, 2)] == [1, 2]
    assert [one.id for one in model_as_of(every, 3)] == [1]
    page = session_page(session_report(revision=3), model=model_as_of(every, 3), computed=(0, 2, 3))
    assert (page.causes, page.earlier) == (("cubic (A2)",), (0, 2))


@pytest.mark.parametrize(
    ("counts", "said"),
    [
        ((3, 1, 0), "3 sessions were computed again under the model in force; 1 session was left alone, on this model"),
        ((0, 0, 2), "2 sessions were left alone: the model's causes cannot be told from them."),
        ((0, 0, 0), ""),
    ],
)
def test_what_was_computed_again_is_counted(counts: tuple[int, int, int], said: str) -> None:
    told = recalibrated_in_words(*counts)
    assert told.startswith(said)
    assert bool(told) == bool(said)


def test_a_form_that_computes_again_says_what_it_did(holding: Holding) -> None:
    client = holding(*FAILED)
    answer = client.post("/units/BA-017/recalibrate", headers={"Accept": "text/html"})
    assert answer.status_code == 303
    assert "2 sessions were left alone, on this model already." in client.get(answer.headers["location"]).text
    assert client.get("/units/BA-017?recomputed=-1").status_code == 422


def test_a_session_s_page_has_both_certificates_and_its_model(flagged: httpx.Client) -> None:
    page = flagged.get(f"/sessions/{session_id(FAILED[1])}").text
    assert "/certificate?format=dcc" in page
    assert "baseline, no cause accepted" in page
