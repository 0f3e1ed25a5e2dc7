"""The rows that a session under way still lacks."""

import math

import numpy as np
import pytest

from estimator.errors import ScheduleError
from estimator.planning import Missing, missing, rank_of_orientations
from estimator.reading import read_session
from tests import builders
from tests.builders import Document

STAND = builders.accelerometer_block(positions=12)
FREE = builders.arbitrary_orientations()


def rows(document: Document, *kept: int) -> Document:
    """The document with some of its rows."""
    return document | {"table": {name: [column[j] for j in kept] for name, column in document["table"].items()}}


def after(document: Document, *kept: int, **how: int | bool) -> Missing:
    """The missing rows after these."""
    return missing(read_session(rows(document, *kept)), **how)


def test_of_a_run_half_done_the_rest_is_to_come_and_then_the_other_run() -> None:
    found = after(STAND, *range(5))
    assert (found.done, found.positions) == (5, 12)
    direct = [("direct", 30 * k) for k in range(5, 12)]
    flipped = [("flipped", 30 * k) for k in range(12)]
    assert [(run, round(math.degrees(beta), 6)) for run, beta in found.settings] == direct + flipped


def test_what_was_left_out_in_between_is_missing() -> None:
    found = after(STAND, *(j for j in range(24) if j not in (7, 15)))
    assert [(run, round(math.degrees(beta), 6)) for run, beta in found.settings] == [("direct", 210), ("flipped", 90)]


def test_a_whole_session_lacks_nothing() -> None:
    found = after(STAND, *range(24))
    assert (found.is_complete, found.unseen) == (True, ())


def test_one_run_alone_leaves_parameters_open_until_the_block_is_flipped() -> None:
    assert "A1 bias" in after(STAND, *range(12)).unseen
    assert after(STAND, *range(13)).unseen == ()


def test_where_the_block_is_not_flipped_one_run_is_all() -> None:
    assert after(STAND, *range(12), both_runs=False).is_complete


def test_settings_follow_from_the_first_angle() -> None:
    turned = STAND | {"table": STAND["table"] | {"beta_deg": [b + 10 for b in STAND["table"]["beta_deg"]]}}
    found = after(turned, *range(11))
    assert round(math.degrees(found.settings[0][1]), 6) == 340


def test_a_row_a_little_off_its_setting_stands_there() -> None:
    off = STAND | {"table": STAND["table"] | {"beta_deg": [b + 0.5 * (b == 90) for b in STAND["table"]["beta_deg"]]}}
    assert after(off, *range(24), positions=12).is_complete


def test_more_positions_may_be_wanted_than_the_steps_say() -> None:
    assert len(after(STAND, *range(12), positions=24).settings) == 36


def test_steps_that_are_no_parts_of_a_turn_ask_for_the_number() -> None:
    odd = STAND | {"table": STAND["table"] | {"beta_deg": [0, 47.3, *STAND["table"]["beta_deg"][2:]]}}
    with pytest.raises(ScheduleError, match="number of positions"):
        after(odd, 0, 1)


def test_orientations_are_asked_for_until_everything_is_identified() -> None:
    assert after(FREE, *range(12)).is_complete
    session = read_session(rows(FREE, *range(5)))
    found = missing(session)
    assert 0 < len(found.directions) <= 4
    angles = found.directions @ found.directions.T
    assert np.allclose(np.diag(angles), 1)
    known = builders.directions_on_sphere(len(FREE["table"]["A1"]))[:5]
    assert rank_of_orientations(session.sensors, np.vstack([known, found.directions])).full


def test_a_log_is_looked_at_by_its_rests() -> None:
    found = missing(read_session(builders.raw_log(6, orientations=6)))
    assert found.done == 6
    assert len(found.directions) == 3
