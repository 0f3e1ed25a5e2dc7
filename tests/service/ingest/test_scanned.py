"""Whoever waits for a long file hears how far it is, and nothing once the answer follows."""

import pytest

from service.ingest import apart as scanned
from service.ingest.apart import Teller


@pytest.fixture
def told(monkeypatch: pytest.MonkeyPatch) -> tuple[Teller, list[tuple[int, int]]]:
    """One that tells all of it, and what it told."""
    monkeypatch.setattr(scanned, "PAUSE", 0.0)
    heard: list[tuple[int, int]] = []
    return Teller(lambda *how_far: heard.append(how_far)), heard


def test_it_counts_how_often_all_was_read(told) -> None:
    teller, heard = told
    for done in (40, 100, 40, 100, 40):
        teller.at(done, 100)
    assert heard == [(40, 0), (100, 0), (40, 1), (100, 1), (40, 2)]


def test_it_is_silent_before_the_answer(told) -> None:
    teller, heard = told
    teller.silence()
    teller.at(40, 100)
    assert heard == []


def test_it_tells_now_and_then_only() -> None:
    heard: list[tuple[int, int]] = []
    teller = Teller(lambda *how_far: heard.append(how_far))
    for done in range(100):
        teller.at(done, 100)
    assert len(heard) == 1
