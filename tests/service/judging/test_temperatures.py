"""The effect of temperature on a session that was measured outside those of earlier sessions."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from estimator.results import Residuals
from service.judging.reservations import Covered, covered_by, worth_of
from service.outlook.store import ChangeRow, ReferenceRow
from service.sessions.decision import Verdict
from service.sessions.records import StoredSession

START = datetime(2024, 1, 10, tzinfo=UTC)
STAND = "two-axis-stand"
TOLERANCE = 5e-4
NOTHING = np.zeros((4, 1))
SESSION = StoredSession(
    id="a", unit="BA-017", sha256="", filename="a.json", size=1, programme=STAND, stand=None, operator="", notes="",
    started_at=START, uploaded_at=START, verdict=Verdict.PASS, reason="", is_reference=False, simulated=False,
)  # fmt: skip
SEASONS = (20.0, 24.0, 16.0, 23.0, 17.0, 24.5, 15.5, 22.0, 18.0, 24.0)


def unit(per_degree: float, temperatures: tuple[float, ...] = SEASONS) -> Covered:
    """A unit whose zero follows the temperature by so much, m/s² per °C, at 35 °C after sessions at others."""
    rng = np.random.default_rng(5)
    noise = 0.02 * TOLERANCE
    rows = tuple(
        ChangeRow(
            at=START + timedelta(days=60 * (k + 1)), block="accelerometer", programme=STAND, sensor="A1",
            kind="accelerometer", parameter="bias", tolerance=TOLERANCE,
            change=[per_degree * (t - 20.0) + noise * float(rng.standard_normal())], own=[noise], origin=[noise],
            dof=None, temperature=t,
        )
        for k, t in enumerate(temperatures)
    )  # fmt: skip
    reference = ReferenceRow(START, "accelerometer", STAND, 20.0)
    return Covered(min(temperatures), max(temperatures), 20.0, 35.0, rows, (reference,))


def test_a_law_says_what_the_step_is_worth() -> None:
    found = worth_of(unit(2e-5))
    assert found is not None
    assert (found[0].sensors, found[0].parameter) == (("A1",), "bias")
    assert found[0].value == pytest.approx(15 * 2e-5, rel=0.1)


def test_a_sensor_that_does_not_follow_the_temperature_is_known_not_to() -> None:
    found = worth_of(unit(0.0))
    assert found is not None
    assert found[0].value + 2 * (found[0].sigma or 0.0) < TOLERANCE / 3


def test_sessions_at_one_temperature_tell_nothing() -> None:
    assert worth_of(unit(2e-5, (20.0, 20.5, 19.5, 20.2, 19.8, 20.1))) is None


def test_few_sessions_tell_nothing() -> None:
    assert worth_of(unit(2e-5, (15.0, 25.0))) is None


def residuals(celsius: float | None) -> Residuals:
    """A reference session's, at a temperature or at one that nobody wrote down."""
    rows = None if celsius is None else np.full(4, celsius)
    return Residuals(value=NOTHING, sigma=NOTHING, beta=None, flipped=None, time=None, temperature=rows)


@pytest.mark.parametrize(
    ("reference", "earlier", "now", "outside"),
    [
        pytest.param(20.0, (), 35.0, 15.0, id="warmer than the reference"),
        pytest.param(20.0, (), 8.0, -12.0, id="colder"),
        pytest.param(20.0, ((33.0, Verdict.PASS),), 35.0, 2.0, id="one before was within tolerance there"),
        pytest.param(20.0, ((35.0, Verdict.FAIL),), 35.0, 15.0, id="one before was out of tolerance there"),
        pytest.param(None, (), 35.0, None, id="the reference's is not known"),
        pytest.param(20.0, (), None, None, id="its own is not known"),
    ],
)
def test_the_reference_and_sessions_within_tolerance_cover_their_temperatures(
    reference: float | None, earlier: tuple[tuple[float, Verdict], ...], now: float | None, outside: float | None
) -> None:
    before = [replace(SESSION, temperature=t, verdict=verdict) for t, verdict in earlier]
    found = covered_by(replace(SESSION, temperature=now), residuals(reference), before)
    assert (None if found is None else found.outside) == outside
