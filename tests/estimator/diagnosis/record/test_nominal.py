"""A wrong elevation is told from the nominal axes where there is no history."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.causes import CATALOGUE, Entry
from estimator.diagnosis.record.nominal import wrong_entry
from estimator.session import ACCELEROMETER
from tests.estimator.causes.hiding import scene

SESSION = scene(ACCELEROMETER, 0).measured(1)
WRONG = replace(SESSION, stand=replace(SESSION.stand, alpha=SESSION.stand.alpha - np.radians(0.5)))


def test_a_wrong_elevation_is_found_with_its_amount() -> None:
    entry = wrong_entry(WRONG, CATALOGUE)
    assert entry is not None
    assert entry.cause.identifier == "alpha-entry"
    assert abs(entry.amplitude - np.radians(0.5)) < 4 * entry.sigma


def test_the_session_is_corrected_by_that_amount() -> None:
    entry = wrong_entry(WRONG, CATALOGUE)
    assert entry is not None
    assert entry.corrected(WRONG).stand.alpha == pytest.approx(SESSION.stand.alpha, abs=4 * entry.sigma)


def test_axes_that_stray_as_they_do_are_no_wrong_entry() -> None:
    assert wrong_entry(SESSION, CATALOGUE) is None


def test_an_entry_missing_in_the_catalogue_is_not_named() -> None:
    assert wrong_entry(WRONG, [c for c in CATALOGUE if not isinstance(c, Entry)]) is None
