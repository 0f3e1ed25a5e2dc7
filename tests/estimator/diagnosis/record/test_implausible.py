"""Axes that no sensor can have: a record mixed up in a way that the catalogue does not know."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from estimator import diagnose
from estimator.diagnosis.record.implausible import implausible_axes
from estimator.diagnosis.residuals.fitted import baseline_of
from tests.estimator.diagnosis.small import measured

BASELINE = baseline_of(measured())
AXES = BASELINE.parameters.axis


@pytest.mark.parametrize("degrees", [0.0, 5.0, 14.0])
def test_a_block_may_sit_turned(degrees: float) -> None:
    turn = Rotation.from_rotvec(np.radians(degrees) * np.array([0.6, 0.0, 0.8]))
    assert implausible_axes(BASELINE, turn.apply(AXES)) is None


def test_a_block_turned_over_is_a_mixed_up_record() -> None:
    found = implausible_axes(BASELINE, Rotation.from_rotvec([0.0, np.pi, 0.0]).apply(AXES))
    assert found is not None
    assert found.sensors == ()
    assert found.angle == pytest.approx(np.pi, abs=1e-6)


def test_one_axis_far_off_is_named() -> None:
    expected = AXES.copy()
    expected[2] = -expected[2]
    found = implausible_axes(BASELINE, expected)
    assert found is not None
    assert 2 in found.sensors


@pytest.mark.parametrize("columns", [[1, 0, 2, 3], [0, 1, 3, 2]])
def test_no_cause_is_named_from_exchanged_columns_that_nothing_mends(columns: list[int]) -> None:
    session = measured(seed=2)
    mixed = replace(session, readings=session.readings[:, columns])
    found = diagnose(mixed, catalogue=[])
    assert not found.findings
    assert "mixed up" in found.structures[0].where
