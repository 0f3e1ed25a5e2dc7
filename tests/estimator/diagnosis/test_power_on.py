"""Settling after switching on is counted from there, where the session says when it was."""

from dataclasses import replace
from functools import cache
from math import exp

import numpy as np
import pytest

from estimator import Diagnosis, diagnose
from estimator.causes import cause
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.groups.session_statistics import statistics_of
from estimator.session import ACCELEROMETER, CalibrationSession
from tests.estimator.causes.hiding import change, scene, with_readings

TAU = 900.0
"""s, of the effect that is hidden."""
EARLIER = 1800.0
"""s before the clock's zero."""


def warming(seed: int = 1) -> CalibrationSession:
    """A session on whose clock A2 has settled from time 0 on."""
    where = scene(ACCELEROMETER, 0)
    return with_readings(where.measured(seed), change("warm-up", where) * where.world.truth.scale)


@cache
def diagnosed(switched_on: float | None) -> Diagnosis:
    """Diagnosis when the unit was switched on at this time of the session's clock."""
    return diagnose(replace(warming(), switched_on=switched_on))


def test_the_amplitude_is_that_at_switching_on() -> None:
    plain, (finding,) = diagnosed(None).findings[0], diagnosed(-EARLIER).findings
    assert (finding.cause, finding.sensors) == ("warm-up", plain.sensors)
    tau = finding.nonlinear["s"]
    assert abs(tau / plain.nonlinear["s"] - 1) < 0.1
    assert np.isclose(finding.amplitude[0] * exp(-EARLIER / tau), plain.amplitude[0], rtol=0.05)


def test_a_clock_that_began_at_power_on_says_the_same() -> None:
    plain, known = diagnosed(None).findings[0], diagnosed(0.0).findings[0]
    assert np.allclose(known.amplitude, plain.amplitude)
    assert (known.nonlinear, plain.since_power_on) == (plain.nonlinear, None)
    first = warming().time
    assert first is not None
    assert known.since_power_on == first[0]


def test_the_advice_says_how_long_to_wait() -> None:
    advice = diagnosed(0.0).findings[0].advice
    wait = int(advice.partition("Begin ")[2].partition(" min")[0]) * 60
    tau = diagnosed(0.0).findings[0].nonlinear["s"]
    assert 3 * tau < wait < 3 * tau + 120


@pytest.mark.parametrize("hours", [10, 1000])
def test_what_settles_long_after_switching_on_is_no_warming_up(hours: float) -> None:
    found = diagnosed(-3600.0 * hours)
    assert "warm-up" not in [f.cause for f in found.findings]
    assert found.findings or found.structures


def test_a_unit_that_has_been_on_for_days_cannot_show_it() -> None:
    (limit,) = (one for one in diagnosed(-3600.0 * 1000).limits if one.cause == "warm-up")
    assert (limit.amplitude, limit.reason) == (None, "the session lacks the time soon after switching on")


def test_the_limit_is_of_what_is_left_at_the_first_row() -> None:
    known, plain = (
        next(one.amplitude for one in diagnosed(on).limits if one.cause == "warm-up") for on in (-EARLIER, None)
    )
    assert known is not None
    assert plain is not None
    assert 0.5 < known[0] / plain[0] < 2


def test_sessions_of_one_unit_have_one_amplitude() -> None:
    """Columns count from power-on in each, so that what is left is the smaller the later a session began."""
    columns = []
    for on in (0.0, -EARLIER):
        setting = baseline_of(replace(warming(), switched_on=on)).setting
        columns.append(cause("warm-up").term(setting, 0, (TAU,)))  # type: ignore[attr-defined]  # it acts on a sensor
    assert np.allclose(columns[1], columns[0] * exp(-EARLIER / TAU))


def test_every_record_of_a_group_is_a_number_however_long_the_unit_was_on() -> None:
    record = statistics_of(replace(warming(), switched_on=-1.6e7, started_at="2026-03-01T09:00:00Z"))
    assert all(np.isfinite(getattr(record, name)).all() for name in ("size", "score", "correlation"))


@pytest.mark.slow
@pytest.mark.parametrize(("now", "before"), [(-EARLIER, None), (None, -EARLIER), (-EARLIER, -EARLIER)])
def test_what_an_earlier_session_has_too_is_not_new_though_one_of_them_says_no_power_on(
    now: float | None, before: float | None
) -> None:
    earlier = replace(warming(seed=2), switched_on=before, started_at="2026-02-01T09:00:00Z")
    found = diagnose(replace(warming(), switched_on=now), history=[earlier])
    (finding,) = (f for f in found.findings if f.cause == "warm-up")
    assert finding.new is False
    gain = found.gain.session
    assert gain is not None
    assert gain.after.rms < gain.before.rms
