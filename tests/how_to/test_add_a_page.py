"""docs/how-to/add-a-page.md, followed: route, frozen context, template."""

import httpx
import pytest

from tests.how_to.follow import followed
from tests.service.made_sessions import session_bytes


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, str]:
    """The new page of an empty service, and after an upload."""
    house = followed("add-a-page", tmp_path_factory.mktemp("page"))
    with house.serving() as address:
        empty = httpx.get(f"{address}/seating")
        httpx.post(f"{address}/api/v1/sessions", content=session_bytes()).raise_for_status()
        return empty.text, httpx.get(f"{address}/seating").text


def test_a_service_without_sessions_says_so(shown: tuple[str, str]) -> None:
    assert "No session names a stand yet." in shown[0]


def test_the_stand_of_a_session_stands_on_the_page(shown: tuple[str, str]) -> None:
    assert '<th scope="row">ODG-1</th><td>1</td><td>' in shown[1]
