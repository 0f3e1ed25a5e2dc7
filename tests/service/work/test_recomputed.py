"""The model in force on a session's page, and the message when sessions were computed again."""

import httpx

from service.models.records import ModelRevision, Scope
from service.models.rules import model_as_of
from service.pages.session.pages import session_page
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import FAILED, session_id
from tests.service.pages.records import NOON, session_report


def revision(number: int, withdraws: int | None = None) -> ModelRevision:
    return ModelRevision(number, Scope.UNIT, "BA-017", "cubic", ("A2",), "5e55", None, "K. Ito", "", NOON, withdraws)


def test_a_session_names_the_causes_of_its_own_model_and_its_earlier_results() -> None:
    every = (revision(1), revision(2), revision(3, withdraws=2))
    assert [one.id for one in model_as_of(every, 2)] == [1, 2]
    assert [one.id for one in model_as_of(every, 3)] == [1]
    page = session_page(session_report(revision=3), model=model_as_of(every, 3), computed=(0, 2, 3))
    assert (page.causes, page.earlier) == (("cubic (A2)",), (0, 2))


def test_a_form_that_computes_again_says_what_it_did(holding: Holding) -> None:
    client = holding(*FAILED)
    form = {"scope": "unit", "subject": "BA-017", "by": "K. Ito"}
    page = client.post("/jobs/recalibration", data=form, headers={"Accept": "text/html"}, follow_redirects=True).text
    assert "Unit BA-017 computed again" in page
    assert "No session needed it: all use the models in force." in page


def test_a_session_s_page_has_both_certificates_and_its_model(flagged: httpx.Client) -> None:
    page = flagged.get(f"/sessions/{session_id(FAILED[1])}").text
    assert "/certificate?format=dcc" in page
    assert "baseline, no cause accepted" in page
