"""Flags on pages: shown, counted, handled by forms that only our pages may send."""

import re

import httpx
import pytest

HTML = {"Accept": "text/html"}
WHO = {"by": "K. Ito", "why": "replacement <b>ordered</b>"}


def form(client: httpx.Client) -> str:
    """Address that the flag's form on the unit's page is sent to."""
    page = client.get("/units/BA-017", headers=HTML).text
    found = re.search(r'action="(/flags/\d+/acknowledge)"', page)
    assert found is not None
    return found.group(1)


def test_the_list_names_the_sensor_and_the_matter(flagged: httpx.Client) -> None:
    assert "A3: out of tolerance" in flagged.get("/flags", headers=HTML).text


def test_a_form_acknowledges_and_shows_who_and_why_as_text(flagged: httpx.Client) -> None:
    answer = flagged.post(form(flagged), data=WHO, headers=HTML)
    assert (answer.status_code, answer.headers["location"]) == (303, "/units/BA-017#flags")
    page = flagged.get("/units/BA-017", headers=HTML).text
    assert "by K. Ito: replacement &lt;b&gt;ordered&lt;/b&gt;" in page
    assert "/resolve" in page
    assert "/acknowledge" not in page


@pytest.mark.parametrize("header", [{"Origin": "https://elsewhere.example"}, {"Sec-Fetch-Site": "cross-site"}])
def test_a_form_of_another_site_changes_nothing(flagged: httpx.Client, header: dict[str, str]) -> None:
    assert flagged.post(form(flagged), data=WHO, headers=HTML | header).status_code == 403
    assert form(flagged)


def test_a_form_without_a_reason_changes_nothing(flagged: httpx.Client) -> None:
    assert flagged.post(form(flagged), data={"by": "K. Ito", "why": " "}, headers=HTML).status_code == 422
    assert form(flagged)
