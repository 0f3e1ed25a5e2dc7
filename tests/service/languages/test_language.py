"""The language that somebody gets."""

import pytest

from service.languages.language import Language, asked, of_environment

RUSSIAN, ENGLISH = Language.RUSSIAN, Language.ENGLISH


def language(header: str = "", cookie: str = "", query: str = "") -> Language:
    headers = [(b"accept-language", header.encode()), (b"cookie", cookie.encode())]
    return asked({"headers": [pair for pair in headers if pair[1]], "query_string": query.encode()})


@pytest.mark.parametrize(
    ("header", "expected"),
    [
        ("ru", RUSSIAN),
        ("ru-RU,ru;q=0.9,en;q=0.8", RUSSIAN),
        ("en;q=0.3, ru;q=0.7", RUSSIAN),
        ("en-GB,ru;q=0.9", ENGLISH),
        ("de, ru;q=0.5", RUSSIAN),
        ("ru;q=0", ENGLISH),
        ("*", ENGLISH),
        ("ru;q=much", ENGLISH),
        ("", ENGLISH),
    ],
)
def test_the_browser_s_wish_by_its_weights(header: str, expected: Language) -> None:
    assert language(header) is expected


def test_a_choice_by_hand_comes_before_the_browser_s_wish() -> None:
    assert language("ru", cookie="session=x; language=en") is ENGLISH


def test_the_address_comes_before_everything() -> None:
    assert language("en", cookie="language=en", query="page=2&lang=ru") is RUSSIAN


@pytest.mark.parametrize("cookie", ["language=tlh", "language", '"'])
def test_what_is_no_language_of_ours_chooses_none(cookie: str) -> None:
    assert language("ru", cookie=cookie, query="lang=de") is RUSSIAN


@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({"LANG": "ru_RU.UTF-8"}, RUSSIAN),
        ({"LANG": "ru_RU.UTF-8", "LC_ALL": "C.UTF-8"}, ENGLISH),
        ({"LANGUAGE": "de:ru", "LANG": "en_GB.UTF-8"}, RUSSIAN),
        ({"LANGUAGE": "", "LC_MESSAGES": "ru"}, RUSSIAN),
        ({}, ENGLISH),
    ],
)
def test_a_process_speaks_the_system_s_language(variables: dict[str, str], expected: Language) -> None:
    assert of_environment(variables) is expected
