"""Rotations: vector and matrix, how one moves with the other, and a start that outliers do not drag."""

import numpy as np
import pytest

from estimator.rotations import common_turn, left_jacobian, turn_of, vector_of
from estimator.session import Array


def unit_vectors(n: int, seed: int) -> Array:
    """(n, 3) anyhow."""
    drawn = np.random.default_rng(seed).standard_normal((n, 3))
    return drawn / np.linalg.norm(drawn, axis=1, keepdims=True)


def test_a_rotation_vector_comes_back() -> None:
    vector = np.array([0.3, -1.2, 0.4])
    assert vector_of(turn_of(vector)) == pytest.approx(vector)


def test_a_quarter_turn_about_z_takes_x_to_y() -> None:
    assert turn_of(np.array([0.0, 0.0, np.pi / 2])) @ [1.0, 0.0, 0.0] == pytest.approx([0.0, 1.0, 0.0])


@pytest.mark.parametrize("size", [0.0, 3e-5, 2e-4, 0.09, 2.0])
def test_the_left_jacobian_is_the_numerical_derivative(size: float) -> None:
    vector, step = size * np.array([0.6, 0.0, -0.8]), 1e-6
    inverse = turn_of(vector).T
    columns = [vector_of(turn_of(vector + step * k) @ inverse) / step for k in np.eye(3)]
    assert left_jacobian(vector) == pytest.approx(np.stack(columns, axis=1), abs=3e-6)


def test_one_vector_that_moved_far_does_not_drag_the_common_turn() -> None:
    """The plain least squares start would be dragged by a quarter of its 5 degrees."""
    vectors, turn = unit_vectors(6, 1), turn_of(np.array([0.05, -0.02, 0.07]))
    others = vectors @ turn.T
    others[2] = turn_of(np.radians([0.0, 4.0, 3.0])) @ others[2]
    assert vector_of(common_turn(vectors, others) @ turn.T) == pytest.approx(np.zeros(3), abs=1e-5)
