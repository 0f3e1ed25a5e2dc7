"""Many sessions in one call."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import Calibration, ScheduleError, calibrate, calibrate_many
from estimator.calibration import batch
from estimator.calibration.stand import calibrate_stand
from estimator.calibration.stand_report import Reports
from estimator.session import RATE_TABLE
from tests.estimator.calibration.cases import CASES

STAND, THREE, FREE = CASES[0], CASES[1], CASES[-1]


def test_results_come_in_the_order_of_the_sessions() -> None:
    a, b, c = STAND.simulated(3), THREE.simulated(3), FREE.simulated(1)
    mixture = [a[0], b[0], c[0], a[1], b[1], b[2], a[2]]
    named = [replace(s, unit=f"unit {k}") for k, s in enumerate(mixture)]
    results = calibrate_many(named)
    assert [r.unit for r in results] == [s.unit for s in named]
    assert [len(r.sensors) for r in results] == [len(s.sensors) for s in named]


def test_a_result_is_built_when_it_is_first_read(monkeypatch: pytest.MonkeyPatch) -> None:
    built: list[int] = []
    whole = Reports.__getitem__

    def noted(reports: Reports, k: int) -> Calibration:
        built.append(k)
        return whole(reports, k)

    monkeypatch.setattr(Reports, "__getitem__", noted)
    results = calibrate_many(STAND.simulated(3))
    assert built == []
    assert results[-1] is results[2]
    assert built == [2]


def test_no_sessions_no_results() -> None:
    assert not calibrate_many([])


def test_sessions_of_one_schedule_are_solved_in_few_calls(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[int] = []
    whole = calibrate_stand

    def counted(sessions: list) -> Reports:
        calls.append(len(sessions))
        return whole(sessions)

    monkeypatch.setattr(batch, "calibrate_stand", counted)
    calibrate_many(STAND.simulated(68))
    assert sum(calls) == 68
    assert len(calls) == 2


def test_names_are_each_sessions_own() -> None:
    first, second = STAND.simulated(2)
    renamed = replace(second, sensors=tuple(replace(s, name=f"B{i}") for i, s in enumerate(second.sensors)))
    assert calibrate_many([first, renamed])[1].names[0] == "B0.scale"


def test_one_bad_session_does_not_move_the_others() -> None:
    sessions = STAND.simulated(3)
    bad = replace(sessions[1], readings=np.random.default_rng(0).standard_normal((48, 6)))
    results = calibrate_many([sessions[0], bad, sessions[2]])
    for k in (0, 2):
        alone = calibrate(sessions[k])
        assert results[k].fit.iterations == alone.fit.iterations
        assert np.allclose(results[k].covariance, alone.covariance, rtol=1e-9, atol=0)


def test_what_does_not_calibrate_is_refused() -> None:
    with pytest.raises(ScheduleError, match="rate-table does not calibrate"):
        calibrate_many([replace(STAND.schedule, programme=RATE_TABLE)])
