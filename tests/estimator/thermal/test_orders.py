"""The choice of orders, against fits made anew without the terms."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import read_session
from estimator.session import Array
from estimator.thermal.begin import begin
from estimator.thermal.orders import OrderChoice, model, orders_of, unsaid
from estimator.thermal.solve import ThermalFit, search_with_noise
from tests.estimator.thermal.physics import Still, lived

ROWS = 40
HIGHEST = (3, 3)


def line_fit(columns: Array, y: Array) -> tuple[Array, Array, float]:
    """Sizes, covariance and χ² of noise one."""
    C = np.linalg.inv(columns.T @ columns)
    size = C @ columns.T @ y
    return size, C, float(((y - columns @ size) ** 2).sum())


@pytest.mark.parametrize("pair", [(3, 3), (3, 1), (0, 3), (1, 2), (0, 0)])
def test_leaving_terms_out_is_the_fit_without_them(pair: tuple[int, int]) -> None:
    """Elements: four of scale, four of bias, three more."""
    rng = np.random.default_rng(1)
    X, y = rng.standard_normal((ROWS, 11)), rng.standard_normal(ROWS)
    theta, C, chi2 = line_fit(X, y)
    kept = np.r_[0 : pair[0] + 1, 4 : 4 + pair[1] + 1, 8:11]
    without, its_C, its_chi2 = line_fit(X[:, kept], y)
    found = model(theta, C, pair, HIGHEST, 4, ROWS)
    assert found.order == pair
    assert found.theta[kept] == pytest.approx(without)
    assert found.covariance[np.ix_(kept, kept)] == pytest.approx(its_C)
    out = np.setdiff1d(np.arange(11), kept)
    assert found.theta[out] == pytest.approx(np.zeros(len(out)), abs=1e-9)
    assert found.covariance[out] == pytest.approx(np.zeros((len(out), 11)), abs=1e-9)
    assert found.bic == pytest.approx(its_chi2 - chi2 - len(out) * np.log(ROWS))


def choice(order: tuple[int, int], bic: float, theta: Array, variance: float) -> OrderChoice:
    return OrderChoice(order, bic, theta, variance * np.eye(2))


def test_the_band_has_what_other_orders_say_by_their_weights() -> None:
    """Schwarz's weights exp(−BIC/2): with 2·ln 3 between two, a quarter."""
    best, larger = choice((1, 0), 0.0, np.array([1.0, 0.0]), 1.0), choice(
        (1, 1), 2 * np.log(3), np.array([1.5, -0.2]), 3.0
    )  # fmt: skip
    apart = np.array([0.5, -0.2])
    assert unsaid([best, larger], best) == pytest.approx((np.outer(apart, apart) + 2 * np.eye(2)) / 4)


@pytest.mark.parametrize("order", [(0, 0), (0, 3), (0, 1)])
def test_a_model_that_lacks_a_term_of_the_best_knows_nothing_less(order: tuple[int, int]) -> None:
    best, other = choice((1, 0), 0.0, np.zeros(2), 1.0), choice(order, 2 * np.log(3), np.array([0.5, 0.0]), 3.0)
    assert unsaid([best, other], best) == pytest.approx(np.diag([0.25, 0.0]) / 4)
    best = choice((0, 4), 0.0, np.zeros(2), 1.0)
    assert unsaid([best, other], best) == pytest.approx(np.diag([0.25, 0.0]) / 4)


def curved(case: Still, seed: int = 1) -> tuple[ThermalFit, int]:
    begun = begin(read_session(lived(case, np.random.default_rng(seed))[0]))
    return search_with_noise(begun.rows, begun.state, begun.free(quadratic=False), stated=True), begun.order


def test_each_sensor_gets_the_orders_that_its_curves_have() -> None:
    """Parabolas of all, but for sensors whose bias or scale is turned to a line or a cubic, far above the noise."""
    one, order = curved(Still(known=2e-3, gyros=3, quadratic=0.0))
    q, p = order + 1, one.free.shape[1]
    state = one.state
    scale, bias = state.scale.copy(), state.bias.copy()
    scale[1, 2], bias[2, 2:4], bias[3, 3], scale[4, 1:] = 0.0, 0.0, 0.1, 0.0
    scale[[0, 1, 2, 3, 5], 3], bias[[0, 1, 4, 5], 3] = 0.0, 0.0
    found = orders_of(replace(one, state=replace(state, scale=scale, bias=bias)), order, 1.0)
    assert found.order[:6].tolist() == [[2, 2], [1, 2], [2, 1], [2, 3], [0, 2], [2, 2]]
    assert found.order[6:].tolist() == [[0, 2]] * 3
    for i in range(9):
        kept = np.zeros(p, dtype=bool)
        if i < 6:
            kept[[*range(found.order[i, 0] + 1), -2, -1]] = True
        kept[q : q + found.order[i, 1] + 1] = True
        assert (found.free[i] == kept).all()


def test_in_noise_a_hundred_times_larger_less_is_asked_for() -> None:
    one, order = curved(Still(known=2e-3, quadratic=0.0))
    plain, doubted = orders_of(one, order, 1.0), orders_of(one, order, 1e4)
    assert plain.order.sum() > doubted.order.sum()
    assert (np.diagonal(doubted.spread, axis1=1, axis2=2) >= -1e-12).all()
