"""Commands with `--lang ru` say nothing in English, JSON apart."""

import re
from collections.abc import Iterator

import pytest

from tests.conftest import StockOf
from tests.databases import Databases
from tests.service.commands.conftest import Run
from tests.service.languages.test_pages import english_in
from tests.service.made_sessions import FAILED
from tests.serving import serving

COMMANDS = (
    ("fleet", "--table"), ("flags", "--table"), ("usable", "BA-017"), ("history", "BA-017", "--table"),
    ("usable", "ZZ-9"), ("upload", "/none.json", "/none.csv"),
)  # fmt: skip
CYRILLIC = re.compile("[а-яё]", re.IGNORECASE)
NAMES = {"BA", "hex", "cone", "ZZ", "json", "none", "imu", "health"}
"""Names of units, types and files."""


@pytest.fixture(scope="module")
def address(sqlite: Databases, stock_of: StockOf) -> Iterator[str]:
    """A running service with a unit out of tolerance."""
    with stock_of(sqlite).holding(*FAILED) as settings, serving(settings) as address:
        yield address


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_it_says_nothing_in_english(run: Run, address: str, words: tuple[str, ...]) -> None:
    ran = run("--lang", "ru", *words, "--server", address)
    assert english_in([ran.out, ran.err]) - NAMES == set()


def test_json_stays_english(run: Run, address: str) -> None:
    assert not CYRILLIC.search(run("--lang", "ru", "fleet", "--json", "--server", address).out)


def test_doctor_says_nothing_in_english(run: Run, tmp_path: object) -> None:
    ran = run("--lang", "ru", "doctor", "--data-folder", tmp_path)
    assert "библиотеки: все на месте" in ran.out
    assert "настройки: " in ran.out
