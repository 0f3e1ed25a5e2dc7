"""Array helpers that several rooms share."""

import numpy as np
import pytest

from estimator.arrays import eigh
from estimator.session import Array


def test_eigenvectors_are_found_where_divide_and_conquer_gives_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """LAPACK does so on one machine and not on another, so that it is made to."""

    def gives_up(matrix: Array) -> None:
        raise np.linalg.LinAlgError("Eigenvalues did not converge")

    half = np.random.default_rng(1).standard_normal((2, 3, 5, 5))
    matrices = half + np.swapaxes(half, -1, -2)
    monkeypatch.setattr(np.linalg, "eigh", gives_up)
    values, vectors = eigh(matrices)
    assert (np.diff(values) > 0).all()
    assert matrices @ vectors == pytest.approx(vectors * values[..., None, :], abs=1e-12)
