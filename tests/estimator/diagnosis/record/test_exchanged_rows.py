"""Exchanged rows are found and put right."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import CalibrationSession
from estimator.causes import RecordCorrection, cause
from estimator.causes.record import exchange_rows
from estimator.diagnosis.record.exchanged_rows import exchange_gains, exchanged_rows, weighted_square
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.session import ACCELEROMETER
from tests.estimator.causes.hiding import scene

SESSION = scene(ACCELEROMETER, 0).measured(1)
ROWS = (2, 11)
KNOWN = [c for c in [cause("positions-swapped")] if isinstance(c, RecordCorrection)]


def blind(session: CalibrationSession) -> CalibrationSession:
    """The session with no noise stated."""
    return replace(session, standard_errors=np.full(session.readings.shape, np.nan))


@pytest.mark.parametrize("session", [SESSION, blind(SESSION)], ids=["noise stated", "noise not stated"])
def test_exchanged_rows_are_found_and_put_right(session: CalibrationSession) -> None:
    found = exchanged_rows(baseline_of(exchange_rows(session, *ROWS)), KNOWN)
    assert found is not None
    assert found.undone.places == ROWS
    assert np.array_equal(found.undone.session.readings, session.readings)


def test_the_right_exchange_leads_by_far() -> None:
    found = exchanged_rows(baseline_of(exchange_rows(SESSION, *ROWS)), KNOWN)
    assert found is not None
    assert found.posterior()[0][1] > 0.999


@pytest.mark.parametrize("session", [SESSION, blind(SESSION)], ids=["noise stated", "noise not stated"])
def test_a_sound_record_is_left_alone(session: CalibrationSession) -> None:
    assert exchanged_rows(baseline_of(session), KNOWN) is None


def test_without_the_cause_nothing_is_exchanged() -> None:
    assert exchanged_rows(baseline_of(exchange_rows(SESSION, *ROWS)), []) is None


def test_the_linear_screen_foretells_what_the_right_exchange_takes_away() -> None:
    baseline = baseline_of(exchange_rows(SESSION, *ROWS))
    (gain,) = exchange_gains(baseline, [ROWS])
    assert gain == pytest.approx(weighted_square(baseline) - weighted_square(baseline_of(SESSION)), rel=0.01)
