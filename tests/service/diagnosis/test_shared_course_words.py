"""A shared course in words: its one shape with U, and those that follow it faintly."""

from dataclasses import replace

import pytest

from estimator.diagnosis.results import Shared
from service.diagnosis.words.amplitudes import more_of, shape_of
from service.kit.measures import HARD, THIN
from tests.service.findings import JUMP

WARM = replace(
    JUMP,
    cause="warm-up",
    nonlinear_each=({"s": 690.0},) * 2,
    shared=Shared("some", {"s": 690.0}, {"s": 20.0}, ("A4",), (2e-5,), (1e-5,), "A1", (), (), ()),
)


def test_the_time_constant_has_its_uncertainty() -> None:
    assert shape_of(WARM).startswith(f"time constant 690{HARD}±{HARD}40{THIN}s; ")


@pytest.mark.parametrize(
    ("since", "words"),
    [
        (None, "size at the session's start"),
        (39.2, "size at switching on, 40 seconds before the first reading"),
        (2400.0, "size at switching on, 40 min before the first reading"),
        (18_600.0, "size at switching on, 5 h 10 min before the first reading"),
        (864_000.0, "size at switching on, 10 days before the first reading"),
    ],
)
def test_it_is_told_where_the_size_is_counted_from(since: float | None, words: str) -> None:
    assert shape_of(replace(WARM, since_power_on=since)).endswith(f"; {words}")


def test_a_row_has_none() -> None:
    assert WARM.shared is not None
    jump = replace(WARM, cause="bias-jump", shared=replace(WARM.shared, shape={"row": 14.0}, shape_sigma={}))
    assert shape_of(jump) == "from row 14"


def test_where_each_may_have_its_own_it_is_said() -> None:
    assert WARM.shared is not None
    doubtful = replace(WARM, cause="bias-jump", shared=replace(WARM.shared, shape={"row": 14.0}, shape_in_doubt=True))
    assert shape_of(doubtful) == "from row 14; whether each sensor has its own cannot be told from this session"


def test_who_follows_faintly_is_told_with_its_size() -> None:
    [size] = more_of(WARM)
    assert size.startswith("A4: 2.0")
    assert more_of(JUMP) == ()
