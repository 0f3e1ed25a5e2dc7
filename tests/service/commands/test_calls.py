"""Every command that makes one call of the API calls what the API has."""

import re

import pytest

from service.app import create_app
from service.commands import api, long_work
from service.commands.calls import Call
from service.settings import Settings

CALLS = {words: row for words, row in (api.COMMANDS | long_work.COMMANDS).items() if isinstance(row, Call)}


@pytest.fixture(scope="module")
def operations() -> set[str]:
    """Methods with addresses, whatever their parts in braces are called."""
    paths = create_app(Settings()).openapi()["paths"]
    return {f"{method.upper()} {re.sub('{.*?}', '{}', path)}" for path, ways in paths.items() for method in ways}


@pytest.mark.parametrize("words", CALLS)
def test_a_command_calls_what_the_api_has(words: str, operations: set[str]) -> None:
    method, path = CALLS[words].request.split()
    assert f"{method} /api/v1{re.sub('{.*?}', '{}', path)}" in operations


@pytest.mark.parametrize("words", CALLS)
def test_the_names_in_an_address_are_parameters(words: str) -> None:
    row = CALLS[words]
    assert set(re.findall("{(.*?)}", row.request)) <= set(row.parameters)
