"""Record errors are undone one after another, only those of the catalogue, and hide no effect."""

import numpy as np
import pytest

from estimator import diagnose
from estimator.causes import CATALOGUE, RecordCorrection
from estimator.causes.record import exchange_rows
from estimator.diagnosis.record.undo import undo_record_errors
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.session import ACCELEROMETER
from tests.estimator.causes.hiding import scene, with_readings

SESSION = scene(ACCELEROMETER, 0).measured(1)
SIGN = next(c for c in CATALOGUE if isinstance(c, RecordCorrection) and c.identifier == "sign-reversed")
REVERSED = list(SIGN.corrected(SESSION))[2][1]


def test_two_errors_in_one_record_are_both_undone() -> None:
    errors, right = undo_record_errors(baseline_of(exchange_rows(REVERSED, 2, 11)), [], CATALOGUE)
    assert {e.undone.cause.identifier for e in errors} == {"sign-reversed", "positions-swapped"}
    assert np.array_equal(right.session.readings, SESSION.readings)


def test_an_error_missing_in_the_catalogue_is_not_named() -> None:
    errors, left = undo_record_errors(baseline_of(REVERSED), [], [c for c in CATALOGUE if c is not SIGN])
    assert SIGN not in {e.undone.cause for e in errors}
    assert not np.array_equal(left.session.readings, SESSION.readings)


def test_a_record_error_does_not_hide_an_effect() -> None:
    jump = 0.12 * 2e-3 * (np.arange(48) >= 20)[:, None] * np.eye(6)[2]
    wrong = next(iter(SIGN.corrected(with_readings(SESSION, jump))))[1]
    assert [f.cause for f in diagnose(wrong).findings] == ["sign-reversed", "bias-jump"]


def test_a_ranking_says_of_each_cause_once_how_likely_it_is() -> None:
    (finding,) = diagnose(exchange_rows(SESSION, 2, 11)).findings
    assert [line.cause for line in finding.ranking] == ["positions-swapped"]
    assert finding.ranking[0].probability == pytest.approx(1.0)
