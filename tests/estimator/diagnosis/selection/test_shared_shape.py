"""One shape for all against one for each."""

import numpy as np
import pytest

from estimator.diagnosis.selection.shared_shape import APART, explained, log_shared, powers


def test_sensors_whose_likelihoods_agree_share_a_shape() -> None:
    each = [np.array([0.0, 20.0, 40.0, 20.0, 0.0])] * 3
    assert log_shared(np.sum(each, axis=0), 120.0, each, [40.0] * 3) == pytest.approx(2 * np.log(5), abs=0.01)


def test_sensors_whose_likelihoods_differ_do_not() -> None:
    first, second = np.array([60.0, 30.0, 0.0]), np.array([0.0, 30.0, 60.0])
    assert log_shared(first + second, 60.0, [first, second], [30.0, 30.0]) < APART


def test_where_no_shape_is_told_from_another_neither_is_likelier() -> None:
    flat = [np.full(10, 6.0)] * 24
    assert log_shared(np.full(10, 144.0), 144.0, flat, [6.0] * 24) == pytest.approx(0.0)


def test_what_a_trace_explains_beside_others_is_less_what_they_explain() -> None:
    z, beside = np.array([3.0, 4.0, 0.0]), np.array([[1.0], [0.0], [0.0]])
    assert powers(z, np.array([[1.0], [1.0], [0.0]]), beside) == pytest.approx([16.0])
    assert explained(np.eye(3)[:, :2], z, beside) == pytest.approx(16.0)
