"""HEAD is answered wherever GET is, as GET would be but for the body."""

import httpx
import pytest

from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - a hook
from tests.service.made_sessions import FAILED

ITS_OWN = ("date", "x-request-id")
"""Headers that no two answers share."""


@pytest.mark.parametrize(
    "path",
    [
        "/",
        "/healthz",
        "/api/v1/units/BA-017/history",
        "/api/v1/units/BA-017/history?format=parquet",
        "/api/v1/fleet/report?format=csv",
        "/api/v1/units/none",
    ],
)
def test_the_head_of_an_answer_is_that_of_the_whole(holding: Holding, path: str) -> None:
    client = holding(*FAILED)
    head, whole = client.head(path), client.get(path)
    own, of_whole = ({k: v for k, v in a.headers.items() if k not in ITS_OWN} for a in (head, whole))
    assert (head.status_code, head.content, own) == (whole.status_code, b"", of_whole)


def test_head_is_not_possible_where_get_is_not(client: httpx.Client) -> None:
    assert client.head("/api/v1/webhooks/1").status_code == 405


def test_the_figures_name_what_a_head_was_asked_of(client: httpx.Client) -> None:
    client.head("/api/v1/fleet")
    counted = [line for line in client.get("/metrics").text.splitlines() if 'method="HEAD"' in line]
    assert any('operation="read_fleet"' in line for line in counted), counted
