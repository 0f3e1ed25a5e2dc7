"""Findings in two real recordings, whatever their errors are stated as."""

from dataclasses import replace
from functools import cache

import pytest

from benchmarks.diagnosed_recordings.still import adis16405, mpu6050
from benchmarks.diagnosed_recordings.subjects import sessions
from benchmarks.recordings.sets import folder
from estimator import Diagnosis, diagnose
from estimator.session import CalibrationSession

GYROS = {"Gx", "Gy", "Gz"}


@pytest.fixture(autouse=True)
def _recorded() -> None:
    if not folder().is_dir():
        pytest.skip(f"no recordings in {folder()}; set IMU_HEALTH_RECORDINGS to their folder")


@cache
def xsens() -> CalibrationSession:
    """The averaged rests of one Xsens MTi."""
    return sessions("imu-tk")[0].session


def with_errors(session: CalibrationSession, factor: float) -> Diagnosis:
    """The diagnosis with the stated errors multiplied."""
    return diagnose(replace(session, standard_errors=factor * session.standard_errors))


@pytest.mark.slow
@pytest.mark.parametrize("factor", [1 / 3, 1.0, 3.0])
def test_gyros_that_answer_to_gravity_are_named_whatever_their_errors_are_stated_as(factor: float) -> None:
    (found,) = with_errors(xsens(), factor).findings
    assert (found.cause, set(found.sensors)) == ("g-sensitivity", GYROS)
    assert found.ranking[0].probability > 0.99


@pytest.mark.slow
@pytest.mark.parametrize("factor", [1 / 3, 1.0, 3.0])
def test_a_zero_that_wanders_at_random_is_unexplained_and_has_no_name(factor: float) -> None:
    diagnosis = with_errors(adis16405(), factor)
    assert not diagnosis.findings
    assert {sensor for s in diagnosis.structures for sensor in s.sensors} == GYROS


def test_a_bias_on_a_parabola_over_temperature_is_neither_lag_nor_warm_up() -> None:
    diagnosis = with_errors(mpu6050(), 1.0)
    assert [f.cause for f in diagnosis.findings if "Gy" in f.sensors] == ["bias-temperature-curve"]
    assert not [s for s in diagnosis.structures if "Gy" in s.sensors]
