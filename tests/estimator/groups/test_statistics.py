"""Statistics kept of a session: scores and information of its candidates, small, the record corrected first."""

import json
from dataclasses import replace

import numpy as np
import pytest

from estimator.calibration.calibrate import averaged
from estimator.causes.contract import SensorCause
from estimator.causes.sensor import CubicNonlinearity
from estimator.diagnosis.residuals.flipped_run import with_its_flip
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.groups import SessionStatistics, statistics_of
from estimator.groups.candidates import lasting_causes
from estimator.groups.session_statistics import contradicted
from tests.estimator.groups.cases import measured, world

SESSION = measured(world(), [], 5)
KEPT = statistics_of(SESSION)


def block(kept: SessionStatistics, cause: str, sensor: str) -> slice:
    """Columns of a candidate."""
    number = [(b.cause, b.sensor) for b in kept.blocks].index((cause, sensor))
    return slice(int(kept.starts[number]), int(kept.starts[number + 1]))


def test_score_and_information_are_those_of_the_diagnosis() -> None:
    residuals = WhitenedResiduals.of(with_its_flip(averaged(SESSION)))
    cause = CubicNonlinearity()
    trace = residuals.trace(cause.placed(residuals.baseline.setting, 2, ()))[:, 0]
    (own,) = range(*block(KEPT, "cubic-nonlinearity", "A3").indices(len(KEPT.size)))
    assert KEPT.size[own] == pytest.approx(np.linalg.norm(trace), rel=1e-9)
    assert KEPT.score[own] == pytest.approx(trace @ residuals.z / np.linalg.norm(trace), rel=1e-6)


def test_the_record_comes_back_from_its_json() -> None:
    again = SessionStatistics.from_dict(json.loads(json.dumps(KEPT.to_dict())))
    assert again.blocks == KEPT.blocks
    assert np.array_equal(again.information, KEPT.information)
    assert np.array_equal(again.score, KEPT.score)


def test_a_record_of_another_format_is_refused() -> None:
    with pytest.raises(ValueError, match="imu-session-statistics/2"):
        SessionStatistics.from_dict({"format": "imu-session-statistics/0"})


def test_the_record_is_small() -> None:
    assert len(json.dumps(KEPT.to_dict())) < 200_000


def test_a_reading_that_does_not_belong_is_left_out() -> None:
    readings = SESSION.readings.copy()
    readings[7, 1] += 30 * np.hypot(SESSION.standard_errors[7, 1], SESSION.readings[:, 1].std() * 1e-5)
    spoilt = statistics_of(replace(SESSION, readings=readings))
    assert spoilt.put_right == (f"{SESSION.sensors[1].name} left out, rows 8 to 8",)
    assert spoilt.energy.sum() / spoilt.freedom.sum() < 1.5


def test_noise_that_the_readings_contradict_is_taken_as_they_show_it() -> None:
    stated = replace(
        SESSION,
        standard_errors=SESSION.standard_errors / 5,
        sensors=tuple(replace(s, bias_repeatability=s.bias_repeatability / 5) for s in SESSION.sensors),
    )
    kept = statistics_of(stated)
    assert np.all(kept.noise_factor > 2)
    assert kept.shrink.min() < 1
    (own,) = range(*block(kept, "cubic-nonlinearity", "A3").indices(len(kept.size)))
    assert kept.size[own] < 2.5 * KEPT.size[own]


@pytest.mark.parametrize(("energy", "claims"), [(0.7, []), (60.0, [[1]])])
def test_one_sensor_alone_is_never_believed_more_than_stated(energy: float, claims: list[list[int]]) -> None:
    scatter, freedom = np.full(6, 10.5), np.full(6, 10.5)
    scatter[1] = energy
    assert contradicted(with_its_flip(averaged(SESSION)), scatter, freedom) == claims


def test_a_kind_of_which_half_scatter_more_than_stated_is_not_believed() -> None:
    freedom = np.full(6, 10.5)
    scatter = np.array([60.0, 60.0, 60.0, 10.5, 10.5, 10.5])
    assert contradicted(with_its_flip(averaged(SESSION)), scatter, freedom) == [[0, 1, 2, 3, 4, 5]]


ALIKE = [c for c in lasting_causes() if isinstance(c, SensorCause) and c.alike]


@pytest.mark.parametrize("known", ALIKE, ids=[c.identifier for c in ALIKE])
def test_courses_of_time_temperature_and_angle_are_the_same_on_every_sensor(known: SensorCause) -> None:
    setting = with_its_flip(averaged(SESSION)).setting
    grid: list[tuple[float, ...]] = [(600.0,)] if known.nonlinear_units else [()]
    each = [known.terms(setting, i, grid) for i in range(6)]
    assert all(np.array_equal(one, each[0]) for one in each)
