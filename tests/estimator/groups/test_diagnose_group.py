"""The answer about a group: whose effect it is, how large, since when, what it gains; and its JSON."""

import json
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.study.looks import e_process
from estimator import CalibrationSession, diagnose_group, diagnose_statistics, statistics_of
from estimator.groups.layout import pool_of
from estimator.groups.pool import GroupTerm
from estimator.groups.search import shown_by_one
from tests.blind.world import Effect
from tests.estimator.groups.cases import measured, worlds

SIZE = 2.5e-5
ECCENTRIC = [Effect("beta-eccentricity", (SIZE, -SIZE))]


@pytest.fixture(scope="module")
def sessions() -> list[CalibrationSession]:
    """Ten sessions on an eccentric head."""
    return [measured(w, ECCENTRIC, 80 + k) for k, w in enumerate(worlds(10))]


def test_an_eccentricity_is_the_stand_s_with_its_amplitude(sessions: list[CalibrationSession]) -> None:
    (finding,) = diagnose_group(sessions, "stand").findings
    assert (finding.cause, finding.level, finding.subject) == ("beta-eccentricity", "stand", sessions[0].stand.id)
    assert np.abs((np.array(finding.amplitude) - [SIZE, -SIZE]) / np.array(finding.sigma)).max() < 3.5
    assert len(finding.sessions) == 10
    assert finding.e_value > 100


def test_what_is_modelled_gains_on_later_sessions(sessions: list[CalibrationSession]) -> None:
    gain = diagnose_group(sessions, "unit").gain
    assert gain is not None
    assert (gain.fitted, gain.held_out) == (7, 3)
    assert gain.log_score > 0
    assert gain.chi2_per_dof_after < gain.chi2_per_dof_before
    assert gain.moved
    assert gain.before is not None
    assert gain.after is not None
    fall = [gain.after[kind][name] / error for kind, own in gain.before.items() for name, error in own.items()]
    assert len(fall) == len(sessions[-1].sensors)
    assert np.mean(fall) < 1
    assert min(fall) > 0


def test_the_picture_shows_the_effect_without_it_and_none_with_it(sessions: list[CalibrationSession]) -> None:
    picture = diagnose_group(sessions, "stand").findings[0].picture
    assert picture is not None
    before, after = (np.square(np.array(side) / picture.sigma).sum() for side in (picture.before, picture.after))
    n = len(picture.at)
    assert picture.variable == "β"
    assert after < n + 3 * np.sqrt(2 * n) < before


def test_the_answer_is_the_agreed_json(sessions: list[CalibrationSession]) -> None:
    found = json.loads(json.dumps(diagnose_group(sessions, "unit").to_dict(), allow_nan=False))
    assert found["format"] == "imu-fleet-diagnosis/1"
    assert {"level", "sessions", "findings", "terms", "unexplained", "limits", "gain"} <= set(found)
    one = found["findings"][0]
    assert {"cause", "sensors", "amplitude", "sigma", "spread", "e_value", "since", "alternatives", "advice"} <= set(
        one
    )
    assert set(one["sessions"][0]) == {"started_at", "unit", "amplitude", "sigma"}


def test_the_pool_sees_less_than_one_session(sessions: list[CalibrationSession]) -> None:
    limits = {x.cause: x for x in diagnose_group(sessions, "unit").limits}
    pool, one = map(np.array, (limits["beta-scale"].amplitude, limits["beta-scale"].one_session))
    assert np.all(pool < one)


def test_records_that_were_kept_tell_the_same_as_sessions(sessions: list[CalibrationSession]) -> None:
    kept = [statistics_of(s) for s in sessions]
    (one,), (other,) = diagnose_statistics(kept).findings, diagnose_group(sessions).findings
    assert (one.cause, one.amplitude) == (other.cause, other.amplitude)


def test_the_evidence_grows_with_the_sessions(sessions: list[CalibrationSession]) -> None:
    looks = e_process([statistics_of(s) for s in sessions])
    assert looks[0] < looks[-1]
    assert looks[-1] > np.log(100)


def test_another_level_is_refused(sessions: list[CalibrationSession]) -> None:
    with pytest.raises(ValueError, match="unit, type, stand"):
        diagnose_group(sessions[:1], "fleet")
    with pytest.raises(ValueError, match="needs a session"):
        diagnose_group([replace(sessions[0], programme="rate-table")])


SERIALS = [f"U{k % 4}" for k in range(12)]


def of_type(affected: set[str]) -> list[CalibrationSession]:
    """Three sessions of each of a type's four units, of which some have a cubic sensor."""
    cubic = Effect("cubic-nonlinearity", (6e-7,), (1,))
    every = enumerate(zip(SERIALS, worlds(12, seed=3), strict=True))
    drawn = [measured(w, [cubic] * (u in affected), k) for k, (u, w) in every]
    return [replace(s, unit=u, unit_type="T") for u, s in zip(SERIALS, drawn, strict=True)]


def test_a_type_is_accused_by_no_single_unit_however_often_it_was_measured() -> None:
    pool = pool_of([statistics_of(session) for session in of_type({"U1"})], "type")
    [place] = [
        p for h, p in pool.places.items() if (h.level, h.cause, h.sensor) == ("type", "cubic-nonlinearity", "A2")
    ]
    of_one = tuple(k for k, unit in enumerate(SERIALS) if unit == "U1")
    assert shown_by_one(pool.given(), GroupTerm(place, tuple(range(12)), True)) == of_one


@pytest.mark.parametrize(("affected", "accused"), [({"U1"}, False), ({"U0", "U1", "U2", "U3"}, True)])
def test_a_type_is_accused_where_its_units_agree(affected: set[str], accused: bool) -> None:
    found = diagnose_group(of_type(affected), "type").findings
    assert ("cubic-nonlinearity" in {f.cause for f in found if f.level == "type"}) is accused
