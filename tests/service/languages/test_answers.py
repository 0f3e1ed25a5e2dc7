"""Pages and refusals over HTTP in the language of the one who asks."""

import re

import httpx
import pytest

from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - the hook

HTML = {"Accept": "text/html"}
RU = {"Accept-Language": "ru"}


def test_the_page_says_in_which_language_it_is(client: httpx.Client) -> None:
    answer = client.get("/", headers=HTML | RU)
    assert '<html lang="ru">' in answer.text
    assert answer.headers["content-language"] == "ru"
    assert {"Accept-Language", "Cookie"} <= {name.strip() for name in answer.headers["vary"].split(",")}


def test_english_is_said_to_who_asks_for_nothing(client: httpx.Client) -> None:
    answer = client.get("/", headers=HTML)
    assert '<html lang="en">' in answer.text
    assert answer.headers["content-language"] == "en"


def test_a_link_on_the_page_chooses_for_a_year(client: httpx.Client) -> None:
    assert 'href="/flags?lang=ru"' in client.get("/flags", headers=HTML).text
    assert '<html lang="ru">' in client.get("/flags?lang=ru", headers=HTML).text
    assert '<html lang="ru">' in client.get("/upload", headers=HTML).text


def test_the_link_keeps_what_the_address_asks_for(client: httpx.Client) -> None:
    page = client.get("/sessions?q=BA&lang=ru", headers=HTML).text
    assert 'href="/sessions?q=BA&amp;lang=en"' in page


def test_a_refusal_is_said_to_a_program_that_asks_for_russian(client: httpx.Client) -> None:
    answer = client.get("/api/v1/units/none", headers=RU)
    assert answer.status_code == 404
    assert answer.headers["content-type"] == "application/problem+json"
    assert (answer.json()["title"], answer.json()["detail"]) == ("Не найдено", "Прибора 'none' нет.")


def test_a_refusal_is_english_for_programs_that_ask_for_nothing(client: httpx.Client) -> None:
    assert client.get("/api/v1/units/none").json()["detail"] == "There is no unit 'none'."


def test_every_problem_of_a_file_is_said_with_what_to_do(client: httpx.Client) -> None:
    answer = client.post("/api/v1/sessions", content=b'{"format": "imu-session/1"}', headers=RU)
    assert answer.status_code == 422
    assert "отсутствует" in {one["message"].split(";")[0] for one in answer.json()["problems"]}


@pytest.mark.parametrize("method", ["HEAD", "GET"])
def test_a_refusal_without_a_body_is_passed_on(client: httpx.Client, method: str) -> None:
    assert client.request(method, "/nowhere", headers=RU).status_code in (404, 405)


def test_whether_a_unit_may_be_used_and_its_flags_are_said_in_russian(flagged: httpx.Client) -> None:
    usable = flagged.get("/api/v1/units/BA-017/usable", headers=RU).json()
    (flag,) = flagged.get("/api/v1/units/BA-017/flags", headers=RU).json()["flags"]
    said = [
        text.replace("accelerometer × 6, V", "")
        for text in (usable["use"], usable["why"], usable["action"], *usable["reasons"], flag["summary"])
    ]
    assert [text for text in said if re.search(r"[A-Za-z]{3}", text)] == []
    assert flagged.get("/api/v1/flags", headers=RU).json()["flags"] == [flag]
    assert flagged.get("/api/v1/units/BA-017/usable").json()["answer"] == usable["answer"]


def test_numbers_and_dates_of_the_api_do_not_depend_on_the_language(client: httpx.Client) -> None:
    assert client.get("/api/v1/units", headers=RU).content == client.get("/api/v1/units").content
