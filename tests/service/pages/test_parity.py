"""The page of a recording in service speaks of agreement, of what would have been seen, and of what never is."""

import pytest

from tests.conftest import Holding
from tests.service.recordings import recording_bytes
from tests.service.sessions import session_bytes, session_id


def page_of(holding: Holding, recording: bytes) -> str:
    """The page of a recording whose unit has a calibration."""
    return holding(session_bytes(), recording).get(f"/sessions/{session_id(recording)}").text


@pytest.fixture
def page(holding: Holding) -> str:
    """The page of a recording in which A3 has moved."""
    return page_of(holding, recording_bytes(a3_moved=400.0))


def test_it_says_that_the_sensors_do_not_agree(page: str) -> None:
    assert "The sensors do not agree with one another as they did at the calibration." in page


def test_it_says_from_what_size_a_change_would_have_been_seen(page: str) -> None:
    assert "What would have been seen" in page
    assert '<td data-label="Share">50 %</td>' in page


def test_it_says_what_parity_never_sees(page: str) -> None:
    assert "Parity sees 12 of 24 numbers that can change. It never sees" in page
    assert "more or other positions would tell it" not in page


def test_a_recording_of_one_orientation_is_told_to_turn(holding: Holding) -> None:
    assert "The recording turns too little" in page_of(holding, recording_bytes(still=True))
