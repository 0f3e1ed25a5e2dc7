"""Orthonormal directions of a column beside others that many signatures share."""

import numpy as np

from estimator.diagnosis.signatures.directions import eigen_whitening, whitening

RNG = np.random.default_rng(1)
SHARED = RNG.standard_normal((2, 30, 5))
BESIDE = np.repeat([0, 1], 20)


def products(first: np.ndarray) -> np.ndarray:
    """(S, 6, 6) products of columns of norm one, the ``first`` (S, 30) beside the shared ones."""
    columns = np.concatenate([first[..., None], SHARED[BESIDE]], axis=-1)
    columns /= np.linalg.norm(columns, axis=1, keepdims=True)
    return np.swapaxes(columns, 1, 2) @ columns


def test_shared_columns_are_projected_out_as_eigenvectors_of_each_would() -> None:
    alike = products(RNG.standard_normal((40, 30)))
    found, live = whitening(alike, np.ones((40, 6), dtype=bool), 0.02, BESIDE)
    each, expected = eigen_whitening(alike, np.ones((40, 6), dtype=bool), 0.02)
    assert np.array_equal(live, expected)
    assert np.allclose(found @ np.swapaxes(found, 1, 2), each @ np.swapaxes(each, 1, 2), rtol=1e-9)


def test_a_column_within_the_shared_ones_is_no_direction_of_its_own() -> None:
    within = SHARED[BESIDE] @ np.ones(5) + 1e-4 * RNG.standard_normal((40, 30))
    alike, shown = products(within), np.ones((40, 6), dtype=bool)
    assert np.all(whitening(alike, shown, 0.02, BESIDE)[1] == 5)
    assert np.all(whitening(alike, shown, 1e-6, BESIDE)[1] == 6)
