"""The seating of blocks on each stand, and what may have happened to the stand, on fleets of whole rotations."""

import numpy as np
import pytest
from scipy import stats

from benchmarks.stands.__main__ import dated, excursion, found, named, steady, turned
from benchmarks.stands.fleets import ARCSEC, Fleet, motions_of
from estimator.health.stand_events import EventTest
from estimator.health.stands import StandState, stand_states

FLEETS = 10


def told(fleet: Fleet, seed: int, fleets: int = FLEETS) -> list[tuple[StandState, ...]]:
    return [stand_states(motions_of(fleet, np.random.default_rng([seed, i]))) for i in range(fleets)]


def test_the_scatter_of_mountings_is_found_for_each_stand() -> None:
    every = told(Fleet(12, 8, 2, lambda _, s: 30.0 if s else 5.0, steady), 41, 10)
    tau = np.median([[state.seating for state in states] for states in every], axis=0) / ARCSEC
    assert tau == pytest.approx([5.0, 30.0], rel=0.15)
    assert sum(map(named, every)) <= stats.binom.isf(1e-3, 10, 0.01)


def test_a_stand_without_remountings_takes_what_is_typical_of_the_others() -> None:
    """Every unit was on S2 once, at the end; on S0 and S1 blocks sit to 10 arcsec."""
    motions = motions_of(Fleet(10, 9, 3, lambda _, __: 10.0, steady), np.random.default_rng(42))
    last = {m.unit: max(o.time for o in motions if o.unit == m.unit and o.stand == "S2") for m in motions}
    kept = [m for m in motions if m.stand != "S2" or m.time == last[m.unit]]
    state = stand_states(kept)[2]
    assert state.seating / ARCSEC == pytest.approx(10.0, rel=0.4)


@pytest.mark.slow
def test_a_turn_of_12_arcsec_is_found_beside_ten_units_seated_to_30() -> None:
    every = told(Fleet(20, 10, 2, lambda u, _: 30.0 if u < 10 else 5.0, turned), 43)
    assert sum(map(found, every)) >= stats.binom.ppf(1e-3, FLEETS, 0.95)
    sizes = [float(np.linalg.norm(states[0].shifts[0].value)) / ARCSEC for states in every if found(states)]
    assert np.median(sizes) == pytest.approx(12.0, abs=1.0)


@pytest.mark.slow
def test_a_stand_that_was_seated_badly_for_a_month_has_one_shift_with_both_dates() -> None:
    every = told(Fleet(40, 12, 2, lambda _, __: 5.0, excursion), 44, 5)
    assert sum(map(dated, every)) >= 4
    assert not any(state.has_shifted for states in every for state in states)


def twice(stand: int, time: float) -> float:
    """The first stand turns, and a year later turns on."""
    return 25.0 * ((time > 0.8) + (time > 2.0)) if stand == 0 else 0.0


def test_several_shifts_of_one_stand_are_told_apart() -> None:
    states = told(Fleet(20, 10, 2, lambda _, __: 5.0, twice), 45, 1)[0]
    assert [round(shift.since, 1) for shift in states[0].shifts] == pytest.approx([0.8, 2.0], abs=0.2)
    assert states[1].shifts == ()


def test_evidence_does_not_underflow() -> None:
    """The p-value of both is zero."""
    weak, strong = (EventTest(chi2, 40.0, 3, 100) for chi2 in (1e19, 1e22))
    assert (weak.p_value, strong.p_value) == (0.0, 0.0)
    assert weak.evidence < strong.evidence
