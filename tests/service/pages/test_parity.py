"""The page of a recording in service speaks of agreement, of what would have been detected, and of what never is."""

import json
from functools import cache
from html import unescape

import numpy as np
import pytest

from tests.blind.flight import Setting, draw_block, fly, tumble
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import session_bytes, session_id
from tests.service.recordings import recording_bytes, recording_document


def page_of(holding: Holding, recording: bytes) -> str:
    """The page of a recording whose unit has a calibration."""
    return holding(session_bytes(), recording).get(f"/sessions/{session_id(recording)}").text


@pytest.fixture
def page(holding: Holding) -> str:
    """The page of a recording in which A3 has moved."""
    return page_of(holding, recording_bytes(a3_moved=400.0))


def test_it_says_that_the_sensors_do_not_agree(page: str) -> None:
    assert "The sensors do not agree with one another as at the calibration." in page


def test_it_says_from_what_size_a_change_would_have_been_seen(page: str) -> None:
    assert "What would have been detected" in page
    assert '<td data-label="Share">50 %</td>' in page


def test_it_says_what_parity_never_sees(page: str) -> None:
    assert "Parity observes 12 of 24 parameters. It cannot observe" in page
    assert "more or other positions would show it" not in page


def test_a_recording_of_one_orientation_is_told_to_turn(holding: Holding) -> None:
    assert "The recording has too little rotation" in page_of(holding, recording_bytes(still=True))


@cache
def moving_block() -> tuple[bytes, bytes]:
    """A calibration, and a smooth flight of its block, sound, whose sensors sit apart in places that are not stated."""
    setting = Setting(seconds=150.0, arm=0.05, delay=1.0, vibration=0.02)
    rng = np.random.default_rng([5, 7])
    block = draw_block(rng, setting)
    calibration, flight = tumble(block, rng), fly(block, setting, rng)
    return tuple(  # type: ignore[return-value]
        json.dumps(document | {"started_at": f"2026-0{month}-01T09:00:00Z"}).encode()
        for month, document in ((3, calibration), (5, flight))
    )


def test_a_block_that_moves_too_much_is_told_so_and_what_to_do(holding: Holding) -> None:
    calibration, flight = moving_block()
    client = holding(calibration, flight)
    page = unescape(client.get(f"/sessions/{session_id(flight)}").text)
    assert "Too much motion for a verdict." in page
    assert "Too much motion for a verdict: the sensors disagree, possibly because of lever arms, delays" in page
    assert "hold the unit still for 15 s while recording, or state where its sensors are (position_m)" in page


def test_nothing_is_lost_for_a_block_that_moves_too_much(holding: Holding) -> None:
    calibration, flight = moving_block()
    client = holding(calibration, flight)
    answer = client.get(f"/api/v1/sessions/{session_id(flight)}").json()
    parity = client.get(f"/api/v1/sessions/{session_id(flight)}/calibration").json()["parity"]
    assert (answer["verdict"], parity["isolated"], parity["detected"], parity["moving"]) == (
        "undecidable", None, False, True,
    )  # fmt: skip
    assert parity["p_value_unmoved"] < 1e-4
    assert parity["suspects"]
    page = client.get(f"/sessions/{session_id(flight)}").text
    assert f"χ² would be {parity['chi2_unmoved']:.1f} for {parity['dof']} numbers" in page


def test_a_channel_that_is_cut_off_at_times_is_said_to_be(holding: Holding) -> None:
    """The share of its samples is in the verdict that names it and on the page."""
    document = recording_document(a3_moved=400.0)
    readings = np.array(document["table"]["A3"])
    document["table"]["A3"] = np.minimum(readings, np.quantile(readings, 0.96)).tolist()
    page = page_of(holding, json.dumps(document).encode())
    assert "A3 has changed since the calibration" in page
    assert page.count("A3 was at the end of its range in 4.0 % of the samples") == 2
