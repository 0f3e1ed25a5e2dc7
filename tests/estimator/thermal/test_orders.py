"""The choice of orders, against fits made anew without the terms."""

import numpy as np
import pytest

from estimator.session import Array
from estimator.thermal.orders import OrderChoice, model, unsaid

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
