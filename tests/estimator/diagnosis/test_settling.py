"""A cold start of a unit that has earlier sessions is one finding; sensors that changed for good are no course."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import Diagnosis, diagnose, read_session
from estimator.causes.catalogue import CATALOGUE
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.common_start import baselines
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.settling import Difference, Settling, settling_in, spread, with_open_change
from tests.blind.courses import BLOCKS, BOTH, CHANGED, COLD, Life, draw_life
from tests.blind.steps import Block

STAND, TWELVE = BLOCKS[0], BLOCKS[2]
ZERO = 1
"""Place among a sensor's five parameters."""


def found_in(life: Life) -> Diagnosis:
    """Diagnosis of the last session, with the others as history."""
    *earlier, last = map(read_session, life.sessions)
    return diagnose(last, earlier)


def changed(found: Diagnosis) -> set[str]:
    return {name for f in found.findings if f.cause == "sensor-drift" for name in f.sensors}


@pytest.mark.parametrize("block", [STAND, TWELVE], ids=["stand", "orientations"])
@pytest.mark.parametrize("kind", [COLD, BOTH, CHANGED])
def test_a_cold_start_is_one_course_and_lasting_changes_are_of_their_sensors(block: Block, kind: str) -> None:
    life = draw_life(block, kind, 15.0, np.random.default_rng((61, 3)))
    found = found_in(life)
    courses = [f for f in found.findings if f.shared is not None]
    assert changed(found) <= set(life.changed)
    assert bool(changed(found)) == (kind != COLD)
    assert [f.cause for f in courses] == ["warm-up"] * (kind != CHANGED)
    assert kind == CHANGED or len(found.findings) == 1 + len(life.changed)
    for shared in (f.shared for f in courses if f.shared is not None):
        assert abs(shared.shape["s"] - life.tau) < 4 * shared.shape_sigma["s"]


@pytest.mark.parametrize("block", [STAND, TWELVE], ids=["stand", "orientations"])
@pytest.mark.parametrize("kind", [COLD, BOTH])
def test_the_same_where_nobody_says_when_it_was_switched_on(block: Block, kind: str) -> None:
    life = draw_life(block, kind, 15.0, np.random.default_rng((61, 3)))
    silent = [{k: v for k, v in file.items() if k != "time_since_power_on_s"} for file in life.sessions]
    found = found_in(replace(life, sessions=tuple(silent)))
    assert [f.cause for f in found.findings if f.shared is not None] == ["warm-up"]
    assert changed(found) == set(life.changed)


def differing(rng: np.random.Generator, sensors: int, zeros: float) -> Difference:
    """Two sessions whose noise is much the same in all parameters, and whose zeros vary by so many of its sigmas."""
    P = 5 * sensors
    mixed = rng.standard_normal((P, P)) / np.sqrt(P)
    noise = np.eye(P) + 20 * mixed @ mixed.T
    moved = rng.multivariate_normal(np.zeros(P), noise)
    moved[ZERO::5] += zeros * rng.standard_normal(sensors)
    information = np.linalg.inv(noise)
    return Difference(information, information @ moved)


def places(sensors: int) -> np.ndarray:
    """(1, P) places of the zeros of all sensors."""
    return np.array([np.tile(np.arange(5) == ZERO, sensors) * 1.0])


@pytest.mark.parametrize("zeros", [0.0, 3.0, 30.0])
def test_how_far_zeros_vary_is_found_in_correlated_noise(zeros: float) -> None:
    rng = np.random.default_rng(11)
    found = [float(differing(rng, 12, zeros).multiples(places(12))[0]) for _ in range(40)]
    assert np.sqrt(np.mean(found)) == pytest.approx(zeros, rel=0.15, abs=1.5)


def test_a_sensor_that_changed_for_good_does_not_widen_what_the_others_may() -> None:
    rng, widest = np.random.default_rng(12), []
    for _ in range(10):
        known = differing(rng, 6, 0.0)
        change = np.zeros(30)
        change[5 * 3 + ZERO] = 40.0
        widest.append(spread(Difference(known.information, known.score + known.information @ change), places(6)).max())
    assert np.median(widest) < 5


def openness(session: Baseline) -> float:
    """The largest of the zeros of a session, dimensionless."""
    return 0.0 if session.unsettled is None else float(session.unsettled[:, ZERO].max())


@pytest.fixture(scope="module")
def cold() -> tuple[Life, Settling]:
    """A unit, and the course of its cold start, which is its last session."""
    life = draw_life(STAND, COLD, 15.0, np.random.default_rng((61, 3)))
    course = settling_in(baseline_of(read_session(life.sessions[-1])), CATALOGUE)
    assert course is not None
    return life, course


@pytest.mark.parametrize(("constants", "is_open"), [(1.0, True), (None, False), (40.0, False)])
def test_what_one_session_tells_of_settling_holds_for_others_that_say_when_they_were_switched_on(
    cold: tuple[Life, Settling], constants: float | None, *, is_open: bool
) -> None:
    life, course = cold
    first, _, second, third = map(read_session, life.sessions)
    assert second.time is not None
    on = None if constants is None else float(second.time[0]) - constants * life.tau
    raised = second.readings + 0.01 * np.array([s.nominal_scale for s in second.sensors], dtype=float)
    moved = replace(second, switched_on=on, readings=raised)
    now, earlier = baselines(baseline_of(moved), [baseline_of(first), baseline_of(third)])
    opened, others = with_open_change(now, earlier, [None, None, course])
    assert (openness(opened) > 1e-6) == is_open
    assert openness(others[1]) > 1e-6
