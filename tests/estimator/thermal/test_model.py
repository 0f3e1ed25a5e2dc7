"""The model over temperature and its normal equations, against derivatives by differences and a full solution."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from estimator.arrays import tangents
from estimator.session import Array
from estimator.thermal.model import HOLDING, State, ThermalRows, cost, jacobian, linearise, residuals
from tests.estimator.thermal.physics import EARTH
from tests.estimator.thermal.sessions import model_y, rows_and_state

BOTH = pytest.mark.parametrize(("gyros", "stated"), [(0, False), (3, False), (0, True), (3, True)])


def moved(state: State, element: int, by: float) -> State:
    """The state moved by one of all unknowns: the sensors' first, then the settings'."""
    m, p = state.vector.shape
    step = np.zeros(m * p + 5 * len(state.directions))
    step[element] = by
    return state.stepped(step[: m * p].reshape(m, p), step[m * p :].reshape(-1, 5))


def differences(rows: ThermalRows, state: State) -> Array:
    """(R, m, N) derivatives of y by all unknowns."""
    sizes = np.r_[np.full(state.vector.size, 1e-5), np.tile([1e-5, 1e-5, 1e-9, 1e-9, 1e-9], len(state.directions))]
    columns = [(model_y(rows, moved(state, k, d)) - model_y(rows, moved(state, k, -d))) / (2 * d)
               for k, d in enumerate(sizes)]  # fmt: skip
    return np.stack(columns, axis=-1)


@BOTH
def test_residuals_are_readings_less_the_law_of_physics(gyros: int, stated: bool) -> None:
    rows, state = rows_and_state(gyros=gyros, stated=stated)
    assert residuals(rows, state) == pytest.approx(rows.y - model_y(rows, state), abs=1e-12)


def all_free(rows: ThermalRows) -> Array:
    """Gyros at rest tell of their bias alone."""
    free = np.ones((len(rows.gyro), rows.elements), dtype=bool)
    free[rows.gyro, :2] = free[rows.gyro, -3:] = False
    return free


@BOTH
def test_the_jacobian_is_the_derivative(gyros: int, stated: bool) -> None:
    rows, state = rows_and_state(gyros=gyros, stated=stated)
    numeric, (local, shared) = differences(rows, state), jacobian(rows, state)
    m, p = state.vector.shape
    for i in range(m):
        own = np.where(all_free(rows)[i], numeric[:, i, i * p : (i + 1) * p], 0.0)
        assert local[:, i] == pytest.approx(own, abs=1e-7)
        settings = numeric[:, i, m * p :].reshape(len(rows.y), -1, 5)
        assert shared[:, i] == pytest.approx(settings[np.arange(len(rows.y)), rows.setting], abs=1e-6)


@BOTH
def test_eliminating_the_settings_leaves_the_full_solution(gyros: int, stated: bool) -> None:
    rows, state = rows_and_state(gyros=gyros, stated=stated)
    m, p = state.vector.shape
    J = np.where(np.r_[all_free(rows).ravel(), np.ones(5 * len(rows.prior), bool)], differences(rows, state), 0.0)
    J = J / rows.sigma[..., None]
    e = (rows.y - model_y(rows, state)) / rows.sigma
    prior = np.column_stack([np.repeat(rows.prior[:, None], 2, 1), np.full((len(rows.prior), 3), 3 / EARTH**2)])
    off = np.einsum("gx,gxt->gt", rows.directions - state.directions, tangents(state.directions))
    pull = np.column_stack([rows.prior[:, None] * off, -state.rates * 3 / EARTH**2]).ravel()
    F = np.einsum("rmi,rmj->ij", J, J) + np.diag(np.r_[np.zeros(m * p), prior.ravel()])
    U = np.einsum("rmi,rm->i", J, e) + np.r_[np.zeros(m * p), pull]
    a, b = slice(0, m * p), slice(m * p, None)
    lean = np.linalg.pinv(F[b, b], hermitian=True, rcond=1e-16) @ F[b, a]
    linear, information, score = linearise(rows, state), F[a, a] - F[a, b] @ lean, U[a] - lean.T @ U[b]
    held = held_by(rows, state, information)
    assert linear.information == pytest.approx(information + held, rel=1e-4, abs=1e-5 * abs(information).max())
    assert linear.score == pytest.approx(score, rel=1e-4, abs=1e-5 * abs(score).max())
    step = 1e-3 * np.random.default_rng(2).standard_normal(m * p)
    rest = np.linalg.pinv(F[b, b], hermitian=True, rcond=1e-16) @ (U[b] - F[b, a] @ step)
    assert linear.settings(step) == pytest.approx(rest.reshape(-1, 5), rel=1e-4, abs=1e-7)


def held_by(rows: ThermalRows, state: State, information: Array) -> Array:
    """Weight of the frame's equations Σ nominal × δe = 0, where no stated directions hold it."""
    m, p = state.vector.shape
    rule, live = np.zeros((3, m, p)), np.flatnonzero(~rows.gyro)
    if rows.prior.any():
        return np.zeros_like(information)
    for i in live:
        rule[:, i, -2:] = np.cross(rows.nominal_axes[i], tangents(state.axes)[i].T).T
    flat = rule.reshape(3, -1)
    largest = np.diagonal(information).reshape(m, p)[live].max()
    return np.asarray(HOLDING * largest * flat.T @ flat)


@BOTH
def test_the_cost_is_chi_squared_of_everything_known(gyros: int, stated: bool) -> None:
    rows, state = rows_and_state(gyros=gyros, stated=stated)
    readings = float((((rows.y - model_y(rows, state)) / rows.sigma) ** 2).sum())
    tipped = np.linalg.norm(rows.directions - state.directions, axis=1) ** 2 @ rows.prior
    assert cost(rows, state) == pytest.approx(readings + tipped + 3 * (np.linalg.norm(state.rates) / EARTH) ** 2)


def test_a_common_turn_of_axes_and_directions_changes_no_reading_and_is_held_by_the_nominal_axes() -> None:
    rows, state = rows_and_state()
    turn = Rotation.from_rotvec([0.02, -0.05, 0.03])
    turned = replace(state, axes=turn.apply(state.axes), directions=turn.apply(state.directions))
    held = turned.held(rows)
    assert model_y(rows, held) == pytest.approx(model_y(rows, state), abs=1e-12)
    assert np.cross(rows.nominal_axes, held.axes).sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-12)


def test_the_frame_of_accelerometers_leaves_gyros_alone_and_stated_directions_hold_it() -> None:
    rows, state = rows_and_state(gyros=3)
    held = state.held(rows)
    assert (held.axes[rows.gyro] == state.axes[rows.gyro]).all()
    assert not np.allclose(held.axes[0], state.axes[0])
    stated, state = rows_and_state(stated=True)
    assert state.held(stated) is state
