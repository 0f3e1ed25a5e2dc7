"""An effect that only all sessions of a unit show is named in the latest of them, unless that one lacks it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from estimator import CalibrationSession, Diagnosis, diagnose, statistics_of
from estimator.groups.lasting import ENDED, SURE, probability
from tests.blind.hide import strength_of
from tests.blind.strength import Lens
from tests.blind.world import Effect
from tests.estimator.groups.cases import measured, worlds

WEAK = {
    "cubic-nonlinearity": Effect("cubic-nonlinearity", (1e-7,), (2,)),
    "beta-eccentricity": Effect("beta-eccentricity", (1e-5, -1e-5)),
    "cross-coupling": Effect("cross-coupling", (1e-5, 1e-5), (1,)),
}
STRENGTH = 3.0
"""Standard errors in the twelfth: less than it shows by itself."""


@cache
def weak(cause: str, *, ended: bool = False) -> tuple[list[CalibrationSession], Effect]:
    """Twelve sessions with an effect, or eleven and one without."""
    drawn = worlds(12, seed=5)
    latest = strength_of(Lens(drawn[-1]), WEAK[cause])
    effect = replace(WEAK[cause], amplitude=tuple(a * STRENGTH / latest for a in WEAK[cause].amplitude))
    acting = [[effect]] * 11 + [[] if ended else [effect]]
    return [measured(w, e, 6000 + k) for k, (w, e) in enumerate(zip(drawn, acting, strict=True))], effect


@cache
def told(cause: str, *, ended: bool = False) -> Diagnosis:
    """The twelfth with the other eleven as history."""
    sessions, _ = weak(cause, ended=ended)
    return diagnose(sessions[-1], sessions[:-1])


@pytest.mark.slow
@pytest.mark.parametrize("cause", WEAK)
def test_the_twelfth_names_what_twelve_show_together_and_none_alone(cause: str) -> None:
    sessions, effect = weak(cause)
    assert not diagnose(sessions[-1]).findings
    (finding,) = told(cause).findings
    assert cause in (finding.cause, *finding.alternatives)
    assert finding.over_sessions is not None
    assert finding.over_sessions.sessions == 12
    assert finding.over_sessions.e_value > 100
    assert finding.sensors == tuple(sessions[0].sensors[i].name for i in effect.sensors)


def test_its_amplitude_is_that_of_all_sessions() -> None:
    _, effect = weak("beta-eccentricity")
    (finding,) = told("beta-eccentricity").findings
    assert np.abs((np.array(finding.amplitude) - effect.amplitude) / np.array(finding.sigma)).max() < 3.5
    assert max(finding.sigma) < max(map(abs, effect.amplitude)) / STRENGTH


def test_the_calibration_holds_it_with_what_is_not_known_of_it() -> None:
    found = told("cross-coupling")
    assert found.calibration.fit.chi2 < found.baseline.fit.chi2
    assert np.all(np.diagonal(found.calibration.covariance) >= 0.99 * np.diagonal(found.baseline.covariance))
    assert np.any(np.diagonal(found.calibration.covariance) > 1.001 * np.diagonal(found.baseline.covariance))


@pytest.mark.slow
@pytest.mark.parametrize("cause", ["cubic-nonlinearity", "beta-eccentricity"])
def test_what_has_ended_is_not_named(cause: str) -> None:
    found = told(cause, ended=True)
    assert cause not in {f.cause for f in found.findings}
    assert all(f.over_sessions is None for f in found.findings)


def test_that_it_has_ended_is_said() -> None:
    assert "11 earlier sessions together show it; this one does not" in told("cubic-nonlinearity", ended=True).notes[0]


def test_records_that_were_kept_tell_as_much_as_the_sessions() -> None:
    sessions, _ = weak("beta-eccentricity")
    (kept,) = diagnose(sessions[-1], records=[statistics_of(s) for s in sessions[:-1]]).findings
    (made,) = told("beta-eccentricity").findings
    assert kept.amplitude == pytest.approx(made.amplitude, rel=1e-6)


def test_a_cause_that_is_not_in_the_catalogue_is_not_named() -> None:
    sessions, _ = weak("beta-eccentricity")
    records = [statistics_of(s) for s in sessions[:-1]]
    assert not diagnose(sessions[-1], catalogue=(), records=records).findings


def test_sound_sessions_show_nothing_together() -> None:
    sessions = [measured(w, [], 700 + k) for k, w in enumerate(worlds(8, seed=3))]
    found = diagnose(sessions[-1], sessions[:-1])
    assert (found.findings, found.notes) == ((), ())


def test_readings_decide_whether_the_latest_has_it() -> None:
    assert probability(4.5, 11) > SURE > probability(-1.0, 11) > ENDED > probability(-6.0, 11)
    assert probability(0.0, 11) == pytest.approx(12 / 13)
