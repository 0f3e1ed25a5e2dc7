"""A stand that shifts for every unit is flagged; a unit that was dropped is not its fault."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy import stats

from estimator.health.stands import StandMotion, StandShift, StandState, stand_states
from estimator.session import Array

Seating = Callable[[str, str, float], Array]
SIGMA, SEATING = 1.0, 0.5
SHIFT = np.array([0.0, 6.0, -8.0])


def fleet(rng: np.random.Generator, added: Seating, units: int = 8) -> list[StandMotion]:
    """Twelve sessions of every unit on three stands over three years, the first its reference."""
    made = []
    for unit in range(units):
        reference = None
        for time in np.sort(rng.uniform(0, 3, 12)):
            stand = f"S{rng.integers(3)}"
            value = SEATING * rng.standard_normal(3) + added(stand, f"U{unit}", float(time))
            seen = value + SIGMA * rng.standard_normal(3)
            reference = seen if reference is None else reference
            covariance = np.zeros((3, 3)) if seen is reference else 2 * SIGMA**2 * np.eye(3)
            made.append(StandMotion(stand, f"U{unit}", float(time), seen - reference, covariance))
    return made


def flagged(found: tuple[StandState, ...]) -> dict[str, StandShift]:
    """The most evident shift of every stand that is named."""
    return {one.stand: one.worst for one in found if one.shifts and one.worst is not None}


def still(stand: str, unit: str, time: float) -> Array:
    return np.zeros(3)


def fitted(stand: str, unit: str, time: float) -> Array:
    """Each block sits in each stand's fixture in its own way, ten sigmas away from the others."""
    return 10 * SIGMA * np.random.default_rng([int(stand[1:]), int(unit[1:])]).standard_normal(3)


def reseated(stand: str, unit: str, time: float) -> Array:
    """The block sits otherwise every time it is mounted, by ten sigmas."""
    return 10 * SIGMA * np.random.default_rng([int(stand[1:]), int(unit[1:]), int(1e6 * time)]).standard_normal(3)


def shifted(stand: str, unit: str, time: float) -> Array:
    return SHIFT if stand == "S1" and time > 2.0 else np.zeros(3)


def test_a_stand_that_shifts_is_flagged_with_date_and_size() -> None:
    found = [flagged(stand_states(fleet(np.random.default_rng(seed), shifted))) for seed in range(12)]
    assert sum(set(f) == {"S1"} for f in found) >= 11
    hits = [f["S1"] for f in found if "S1" in f]
    assert np.median([abs(s.since - 2.0) for s in hits]) < 0.15
    inside = [np.linalg.norm(np.array(s.value) - SHIFT) < 4 * np.sqrt(np.trace(np.array(s.covariance))) for s in hits]
    assert np.mean(inside) > 0.9


@pytest.mark.slow
def test_stands_that_stay_are_left_alone() -> None:
    alarms = sum(bool(flagged(stand_states(fleet(np.random.default_rng(100 + s), still)))) for s in range(30))
    assert alarms <= stats.binom.isf(1e-3, 30, 0.02)


def test_blocks_that_each_sit_otherwise_in_a_fixture_do_not_shift_the_stand() -> None:
    assert not any(flagged(stand_states(fleet(np.random.default_rng(s), fitted))) for s in range(6))


@pytest.mark.slow
@pytest.mark.parametrize("units", [3, 8])
@pytest.mark.parametrize("seating", [fitted, reseated])
def test_however_blocks_are_seated_a_stand_that_stays_is_left_alone(seating: Seating, units: int) -> None:
    """If the scatter of the typical date were taken for that of every date, 8 to 67 in a hundred fleets would be
    flagged.
    """
    alarms = sum(bool(flagged(stand_states(fleet(np.random.default_rng(300 + s), seating, units)))) for s in range(10))
    assert alarms <= stats.binom.isf(1e-3, 10, 0.01)


@pytest.mark.slow
def test_a_unit_that_was_dropped_is_no_fault_of_any_stand() -> None:
    def dropped(stand: str, unit: str, time: float) -> Array:
        return 30 * SHIFT if unit == "U3" and time > 1.5 else np.zeros(3)

    assert not any(flagged(stand_states(fleet(np.random.default_rng(s), dropped))) for s in range(6))


def test_two_units_are_too_few_to_tell() -> None:
    found = stand_states(fleet(np.random.default_rng(1), shifted, units=2))
    assert {(one.worst, one.has_shifted) for one in found} == {(None, False)}


def test_a_probability_of_a_stand_that_stays_is_no_more_than_one() -> None:
    found = [one.worst for s in range(5) for one in stand_states(fleet(np.random.default_rng(200 + s), still))]
    assert max(shift.p_value for shift in found if shift is not None) == 1


def test_nothing_measured_is_nothing_said() -> None:
    assert stand_states(()) == ()
