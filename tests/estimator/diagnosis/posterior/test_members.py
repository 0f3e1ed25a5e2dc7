"""The sensors of a shared course, against all sets there are."""

from itertools import combinations

import numpy as np
import pytest

from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.members import log_sets, members_of
from estimator.diagnosis.posterior.priors import SIZES


def test_the_shares_of_all_sets_are_one() -> None:
    shares = log_sets(5)
    assert sum(np.exp(shares[k - 1]) for k in range(1, 6) for _ in combinations(range(5), k)) == pytest.approx(1.0)


@pytest.mark.parametrize("seed", range(6))
def test_the_set_found_is_the_likeliest_of_all(seed: int) -> None:
    rng = np.random.default_rng(seed)
    root = np.eye(5) + 0.1 * rng.standard_normal((5, 5))
    gram = 1e12 * root @ root.T
    size = np.where(rng.random(5) < 0.6, rng.standard_normal(5) * 1e-5, 0.0)
    along = gram @ size + np.linalg.cholesky(gram) @ rng.standard_normal(5)
    info = InputInformation(gram, along, 1e3, 50.0, scaled=False)
    found = members_of(info, gram, along)
    sets, shares = [c for k in range(2, 6) for c in combinations(range(5), k)], log_sets(5) - np.log(len(SIZES))
    values = [
        float(info.log_evidence_of(gram[np.ix_(c, c)][None], along[list(c)][None], SIZES).max() + shares[len(c) - 1])
        for c in sets
    ]
    if np.isfinite(found.value):
        assert found.numbers == sets[int(np.argmax(values))]
        assert found.value == pytest.approx(max(values))


def test_a_course_of_one_sensor_is_not_shared() -> None:
    gram, along = 1e12 * np.eye(4), np.array([1e8, 1e5, -1e5, 1e5])
    assert members_of(InputInformation(gram, along, 1e5, 50.0, scaled=False), gram, along).value == -np.inf
