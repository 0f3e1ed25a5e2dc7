"""Accelerometers that stand away from the turn axis, hidden by a generator that shares nothing with the estimator."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import align
from estimator.alignment.levers import coefficients, place_of, turning
from estimator.alignment.results import AlignmentResult
from estimator.alignment.simulate import TurntableProgramme, table_angle, turn_rates
from estimator.results import ARCSEC
from estimator.session import Array
from tests.estimator.alignment.cases import SHORT, TYPICAL, aligned, drawn
from tests.estimator.alignment.exact import PLACES, Run, turned

AWAY = Run(places=PLACES)


def errors(found: AlignmentResult, run: Run) -> Array:
    """Errors of ∇_x and ∇_y, in standard errors."""
    sigma = np.sqrt(np.diag(found.covariance)[8:10])
    return np.asarray((found.estimate[8:10] - run.zeros[:2]) / sigma)


@pytest.mark.parametrize("rate", [2.0, 6.0, 20.0])
def test_lever_arms_leave_no_error_in_the_zeros(rate: float) -> None:
    run = replace(AWAY, rates=(rate,))
    found = align(turned(run))
    assert np.abs(errors(found, run)).max() < 4
    assert found.fit.chi2 / found.fit.dof < 1.2


def test_an_alignment_that_takes_them_for_nothing_is_wrong() -> None:
    found = align(turned(replace(AWAY, rates=(20.0,))), lever_arms=False)
    assert found.fit.chi2 / found.fit.dof > 1000
    assert np.abs(found.estimate[8:10] - AWAY.zeros[:2]).max() > 25e-5


@pytest.mark.parametrize(("ramp", "row"), [(0.02, 0.1), (0.3, 0.1), (3.0, 0.1), (0.5, 0.5), (0.5, 1.0)])
def test_however_the_table_starts(ramp: float, row: float) -> None:
    found = align(turned(replace(AWAY, ramp=ramp, row=row)))
    assert found.fit.chi2 / found.fit.dof < 1.2


def test_stated_positions_leave_the_same_from_whatever_origin() -> None:
    near, far = (align(turned(AWAY, stated=np.array(PLACES) + origin)) for origin in (0.0, [0.3, -0.2, 5.0]))
    assert near.estimate[8:13] == pytest.approx(far.estimate[8:13], abs=1e-8)
    assert np.abs(errors(near, AWAY)).max() < 4


def test_stated_positions_are_taken_off() -> None:
    found = align(turned(AWAY, stated=np.array(PLACES)))
    assert found.estimate[19:23] == pytest.approx(np.zeros(4), abs=0.02)
    assert align(turned(AWAY)).estimate[19:23] == pytest.approx([0.04, 0.05, 0.08, -0.06], abs=0.02)


def test_not_knowing_where_sensors_stand_costs_little() -> None:
    known, unknown = (np.sqrt(np.diag(align(turned(Run()), lever_arms=known).covariance)) for known in (False, True))
    assert unknown[2:13] / known[2:13] == pytest.approx(1.0, abs=0.06)


@pytest.mark.slow
def test_the_errors_are_as_large_as_stated() -> None:
    """Mean normalised error squared of ∇, E, within its 99.8 % bounds over 40 sessions."""
    rng = np.random.default_rng(11)
    programme = replace(SHORT, ramp=1.0)
    squares = []
    for seed in range(40):
        away = replace(drawn(rng), positions=0.2 * rng.standard_normal((6, 3)))
        case = aligned(away, seed, programme=programme, noise=TYPICAL)
        error, told = case.error[6:10], case.covariance[6:10, 6:10]
        squares.append(float(error @ np.linalg.solve(told, error)) / 4)
    assert 0.69 < np.mean(squares) < 1.38


def test_a_row_of_an_even_change_is_averaged_exactly() -> None:
    ends = np.concatenate([np.zeros(5), np.linspace(0.0, 0.1, 11), np.full(5, 0.1)])
    found = turning(0.5 * (ends[1:] + ends[:-1]), 0.5)
    exact = (ends[1:] ** 2 + ends[1:] * ends[:-1] + ends[:-1] ** 2) / 3
    inside = [j for j in range(20) if j not in (4, 5, 13, 14, 15)]
    assert found.square[inside] == pytest.approx(exact[inside], abs=1e-12)
    assert found.faster[inside] == pytest.approx(np.diff(ends)[inside] / 0.5, abs=1e-12)
    assert found.faster.sum() * 0.5 == pytest.approx(0.1), "whatever the bends"


def test_the_place_follows_from_what_is_felt() -> None:
    axes = np.array([[0.6, 0.64, 0.48], [0.0, 0.8, -0.6]])
    places = np.array([[0.1, -0.3, 0.7], [0.2, 0.05, -1.0]])
    felt = coefficients(axes, places)
    assert [place_of(a) @ f for a, f in zip(axes, felt, strict=True)] == pytest.approx(places[:, :2])


def test_a_simulated_turn_starts_and_stops_evenly() -> None:
    programme = TurntableProgramme(angles=(0.0, np.pi, 0.5), dwell=20.0, ramp=2.0)
    angle, _ = table_angle(programme)
    rate = turn_rates(angle, programme.row)
    assert np.abs(rate).max() == pytest.approx(programme.rate, rel=0.01)
    assert np.abs(np.diff(rate)).max() == pytest.approx(programme.rate / 20, rel=0.02)
    assert rate[-1] == pytest.approx(0.0, abs=1e-9)
    assert np.trapezoid(rate, dx=programme.row) == pytest.approx(0.5)


def test_a_table_that_starts_at_once_is_as_before() -> None:
    angle, _ = table_angle(TurntableProgramme(dwell=10.0))
    assert np.unique(np.round(np.diff(angle), 9)).tolist() == [0.0, pytest.approx(np.radians(0.6), abs=1e-9)]


def test_mounting_errors_are_told_beside_lever_arms() -> None:
    truth = replace(drawn(np.random.default_rng(5)), positions=np.tile([0.2, 0.1, 0.0], (6, 1)))
    case = aligned(truth, programme=replace(SHORT, ramp=1.0, angles=(0.0, np.pi / 2, np.pi)))
    assert np.abs(case.error[8:10]).max() < 2 * ARCSEC
