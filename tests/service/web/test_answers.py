"""Refusals come in words, with the right headers, to programs and to people."""

from pathlib import Path

import httpx
import pytest

from service.app import create_app
from service.settings import Settings
from tests.service.web.conftest import At
from tests.serving import http_client

HTML = {"Accept": "text/html,application/xhtml+xml,*/*;q=0.8"}
SEVERAL = {
    "/api/v1/sessions": "GET, HEAD, POST",
    "/api/v1/webhooks": "GET, HEAD, POST",
    "/api/v1/units/B/notes": "GET, HEAD, POST",
    "/api/v1/units/B/customer": "GET, HEAD, PUT",
    "/api/v1/units/B/lot": "PUT",
    "/api/v1/units/B/recalibrate": "POST",
    "/api/v1/unit-types/T": "GET, HEAD, PUT",
    "/api/v1/webhooks/1": "DELETE",
    "/upload": "GET, HEAD, POST",
    "/openapi.json": "GET, HEAD",
}


@pytest.mark.parametrize("path", SEVERAL)
def test_a_method_that_is_not_possible_is_told_all_that_are(at: At, path: str) -> None:
    answer = httpx.patch(at() + path)
    assert (answer.status_code, answer.headers["allow"]) == (405, SEVERAL[path])


@pytest.mark.parametrize("path", ["/", "/units/x", "/api/v1/units", "/api/v1/units/x/label.pdf", "/readyz"])
def test_without_its_database_the_service_shows_people_a_page_and_programs_a_problem(path: str, tmp_path: Path) -> None:
    nowhere = Settings(database_url=f"sqlite:///{tmp_path}", data_folder=tmp_path / "data")
    with http_client(create_app(nowhere)) as client:
        page, problem = client.get(path, headers=HTML), client.get(path)
    assert (page.status_code, problem.status_code) == (503, 503)
    assert '<section id="problem"' in page.text
    assert problem.headers["content-type"] == "application/problem+json"


EXTREMES = [
    *(
        (name, value)
        for name in ("scale", "bias", "axis", "noise", "variation", "minutes")
        for value in (5e-324, 1e-300)
    ),
    *((name, value) for name in ("theta", "alpha_error", "beta_error", "latitude") for value in (5e-324, 1e-200)),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "value"), EXTREMES)
@pytest.mark.parametrize("path", ["/plan", "/api/v1/plan"])
def test_a_number_next_to_nothing_is_planned_with_or_refused(at: At, path: str, name: str, value: float) -> None:
    question = {"positions": 12, "elevation": 40, "runs": "direct", name: value}
    assert httpx.get(at() + path, params=question).status_code in (200, 422)


def test_errors_that_no_computation_holds_together_are_said(at: At) -> None:
    apart = {"sensors": 3, "theta": 1e-9, "alpha_error": 1e-3, "noise": 1e-9, "variation": 1e-9, "runs": "direct"}
    answer = httpx.get(f"{at()}/api/v1/plan", params=apart | {"positions": 3, "elevation": 45})
    assert answer.status_code == 422
    assert "orders of magnitude apart" in answer.json()["detail"]
