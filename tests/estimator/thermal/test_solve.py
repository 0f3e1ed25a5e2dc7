"""The search for curves: where it ends, what it knows, what noise it finds."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.session import Array
from estimator.thermal.begin import begin
from estimator.thermal.model import ThermalRows, linearise
from estimator.thermal.solve import ThermalFit, inverse_of, is_determined, of_kind, search, search_with_noise
from tests.estimator.thermal.physics import G, Still, lived
from tests.estimator.thermal.sessions import model_y, rows_and_state, session_of


def fit_of(case: Still, seed: int, *, stated: bool = True) -> ThermalFit:
    begun = begin(session_of(lived(case, np.random.default_rng(seed))[0]))
    return search_with_noise(begun.rows, begun.state, begun.free(quadratic=True), stated=stated)


def free_of(rows: ThermalRows, gyros: int, *, quadratic: bool = True) -> Array:
    free = np.ones((4 + gyros, 8), dtype=bool)
    free[4:, :2] = free[4:, -3:] = False
    free[:, -3] &= quadratic
    return free


@pytest.mark.parametrize(("gyros", "stated"), [(0, False), (0, True), (3, True)])
def test_readings_without_noise_give_the_truth_from_a_start_far_off(gyros: int, stated: bool) -> None:
    rows, true = rows_and_state(gyros=gyros, stated=stated, settings=40)
    rates = np.zeros_like(true.rates)
    true = replace(true, rates=rates).held(rows)
    rows = replace(rows, y=model_y(rows, true), directions=true.directions if stated else rows.directions)
    rng = np.random.default_rng(5)
    off = 0.03 * rng.standard_normal(true.vector.shape) * free_of(rows, gyros)
    found = search(rows, true.stepped(off, np.zeros((40, 5))), free_of(rows, gyros))
    assert found.converged
    assert 1 < found.iterations < 12
    assert found.state.vector == pytest.approx(true.vector, abs=1e-5)
    assert found.state.axes[:4] == pytest.approx(true.axes[:4], abs=1e-5)
    assert found.chi2 < 1e-6


def test_elements_that_are_not_free_stay_as_they_are() -> None:
    rows, state = rows_and_state(settings=40)
    free = free_of(rows, 0, quadratic=False)
    found = search(rows, state, free)
    assert (found.state.quadratic == state.quadratic).all()
    assert not found.covariance.reshape(4, 8, 4, 8)[:, 5].any()
    assert found.covariance[0, 0] > 0


@pytest.mark.parametrize(
    ("gyros", "stated", "rest"), [(0, False, -80 + 3), (0, True, 0), (3, False, -80 + 3), (3, True, 0)]
)
def test_degrees_of_freedom_are_readings_less_unknowns(gyros: int, stated: bool, rest: int) -> None:
    """Two turns a setting where no direction is stated; three of all are a turn of the whole, which changes nothing."""
    rows, state = rows_and_state(gyros=gyros, stated=stated, settings=40)
    free = free_of(rows, gyros)
    found = search(rows, state, free)
    assert found.dof == 80 * (4 + gyros) - free.sum() + rest
    assert found.chi2 == pytest.approx(found.dof, abs=4 * np.sqrt(2 * found.dof) + 3 * 40 * (gyros > 0))


def test_of_gyros_alone_only_their_biases_are_unknown() -> None:
    rows, state = rows_and_state(gyros=3, settings=40)
    part = replace(
        rows, y=rows.y[:, 4:], sigma=rows.sigma[:, 4:], nominal_axes=rows.nominal_axes[4:], gyro=rows.gyro[4:]
    )
    state = replace(
        state, scale=state.scale[4:], bias=state.bias[4:], quadratic=state.quadratic[4:], axes=state.axes[4:]
    )
    free = free_of(rows, 3)[4:]
    assert search(part, state, free).dof == 80 * 3 - 9
    assert is_determined(part, state, free)


@pytest.mark.parametrize("stated", [False, True])
def test_what_the_fit_leaves_of_all_readings_is_its_degrees_of_freedom(stated: bool) -> None:
    """The trace of I − H is readings less unknowns; a stated direction far worse known than the readings tell it is
    unknown."""
    rows, state = rows_and_state(stated=stated, settings=40)
    rows = replace(rows, prior=rows.prior * 1e-6)
    found = search(rows, state, free_of(rows, 0))
    assert found.redundancy.sum() == pytest.approx(
        320 - found.free.sum() - 80 + 3 * (not stated), abs=3.1 * stated + 0.01
    )
    assert (found.redundancy < 80).all()


def test_what_a_sensor_leaves_is_what_noise_leaves_in_it() -> None:
    """E[energy] of a sensor is its redundancy."""
    rows, state = rows_and_state(gyros=3, settings=40)
    rng, exact, free = np.random.default_rng(8), model_y(rows, replace(state, rates=0 * state.rates)), free_of(rows, 3)
    energies = []
    for _ in range(30):
        spin = 7.292115e-5 / np.sqrt(3) * rng.standard_normal((40, 3)) @ state.axes[4:].T
        y = exact + rows.sigma * rng.standard_normal(rows.y.shape)
        y[:, 4:] += spin[rows.setting]
        found = search(replace(rows, y=y), state, free)
        energies.append(found.energy)
    mean, error = np.mean(energies, axis=0), np.std(energies, axis=0) / np.sqrt(30)
    assert (np.abs(mean - found.redundancy) < 4 * error).all()


def test_the_covariance_is_the_inverse_of_what_is_free() -> None:
    rows, state = rows_and_state(settings=40)
    free, linear = free_of(rows, 0, quadratic=False), linearise(rows, state)
    at = np.flatnonzero(free)
    identity = inverse_of(linear, free)[np.ix_(at, at)] @ linear.information[np.ix_(at, at)]
    assert identity == pytest.approx(np.eye(len(at)), abs=1e-6)


def test_few_orientations_determine_little() -> None:
    rows, state = rows_and_state(settings=40)
    assert is_determined(rows, state, free_of(rows, 0))
    few, its = rows_and_state(settings=6)
    assert not is_determined(few, its, free_of(few, 0))
    bias = np.zeros((4, 8), dtype=bool)
    assert is_determined(few, its, bias)
    assert is_determined(rows, state, np.roll(np.eye(4, 8, dtype=bool), 2, axis=1))


def test_without_a_direction_or_anything_else_the_frame_alone_is_unseen() -> None:
    """Two readings of each sensor at one setting determine a line of temperature at most."""
    rows, state = rows_and_state(settings=40)
    same = replace(rows, scale_basis=np.ones_like(rows.scale_basis))
    assert not is_determined(same, state, free_of(same, 0))


@pytest.mark.parametrize("noise", [2e-4, 5e-3])
def test_noise_that_is_not_stated_is_found_of_each_kind(noise: float) -> None:
    found = fit_of(Still(stated=False, gyros=3, noise=noise, gyro_noise=2e-4), 3, stated=False)
    assert found.rows.sigma[0, :6] * G == pytest.approx(np.full(6, noise), rel=0.3)
    assert np.mean(found.rows.sigma[0, :6]) * G == pytest.approx(noise, rel=0.1)
    assert np.mean(found.rows.sigma[0, 6:]) == pytest.approx(2e-4, rel=0.12)
    assert found.chi2 / found.dof == pytest.approx(1.0, rel=0.1)


def test_a_sensor_much_noisier_than_the_others_keeps_its_own_noise() -> None:
    document, _ = lived(Still(stated=False), np.random.default_rng(4))
    rough = np.array(document["table"]["A2"]) + 0.12 * 0.03 * np.random.default_rng(5).standard_normal(81)
    document["table"]["A2"] = rough.tolist()
    begun = begin(session_of(document))
    found = search_with_noise(begun.rows, begun.state, begun.free(quadratic=True), stated=False)
    assert found.rows.sigma[0, 1] * G == pytest.approx(0.03, rel=0.2)
    assert np.delete(found.rows.sigma[0], 1) * G == pytest.approx(np.full(5, 1e-3), rel=0.35)


def test_stated_noise_is_kept() -> None:
    begun = begin(session_of(lived(Still(), np.random.default_rng(4))[0]))
    found = search_with_noise(begun.rows, begun.state, begun.free(quadratic=True), stated=True)
    assert found.rows is begun.rows


def test_a_kind_has_its_own_share_of_chi_squared() -> None:
    rows, state = rows_and_state(gyros=3, settings=40)
    found = search(replace(rows, sigma=rows.sigma / np.where(rows.gyro, 3.0, 2.0)), state, free_of(rows, 3))
    ratio = of_kind(found)
    assert ratio[:4] == pytest.approx(np.full(4, found.energy[:4].sum() / found.redundancy[:4].sum()))
    assert ratio[:4] == pytest.approx(np.full(4, 4.0), rel=0.3)
    assert (ratio[4:] == ratio[4]).all()
