"""Sets of sensors solved as one stack give what they give one by one."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from estimator.health.changes import Changes
from estimator.health.moved import fit, is_majority
from estimator.health.who_moved import Sets, residuals
from estimator.session import Array


def changes_of(rng: np.random.Generator, m: int, rows: int, *, degenerate: bool) -> Changes:
    """Correlated changes of microradians; degenerate ones are known along the common change only."""
    n = m * rows
    design = np.ones((n, 1)) if rows == 1 else rng.standard_normal((n, 3))
    own, origin = (1e-12 * root @ root.T for root in rng.standard_normal((2, n, n + 2)))
    if degenerate:
        own, origin = 1e-12 * design @ design.T, np.zeros((n, n))
    y = 4e-6 * rng.standard_normal(n)
    return Changes(tuple(f"A{i}" for i in range(m)), y, own, origin, design, scatter=1e-6)


def near(changes: Changes, j: int, out: set[int]) -> Iterator[set[int]]:
    """Sets within one removal, addition or exchange of the one that was found."""
    everyone = set(range(len(changes.names)))
    for less, more in product([set(), *({i} for i in out)], [set(), *({i} for i in everyone - out - {j})]):
        if is_majority(changes, sorted((out - less) | more)):
            yield (out - less) | more


def one_by_one(sets: Sets, j: int, out: set[int]) -> tuple[Array, Array]:
    """Mean and covariance of the mixture, as the head of `who_moved` writes it."""
    changes, everyone = sets.changes, set(range(len(sets.changes.names)))
    at, logs, seen, known = changes.where([j]), [], [], []
    for moved in near(changes, j, out - {j}):
        rest = everyone - moved
        inside = rest - {j} if len(rest - {j}) >= changes.rows + 1 else rest
        stays = -fit(changes, sorted(rest)).chi2 / 2
        goes = sets.cost(j) - fit(changes, sorted(inside)).chi2 / 2
        logs.append(sum(map(sets.cost, moved)) + (stays if inside == rest else np.logaddexp(stays, goes)))
        drag = changes.design[at] @ fit(sets.weighing, sorted(inside)).gain
        left = np.eye(len(changes.y))[at] - drag
        others = np.delete(drag, at, axis=1)
        seen.append(left @ changes.y)
        known.append(left @ (changes.current + changes.origin) @ left.T + changes.scatter**2 * others @ others.T)
    weights = np.exp(np.array(logs) - max(logs))
    weights /= weights.sum()
    weights = np.where(weights > 1e-4, weights, 0.0) / weights[weights > 1e-4].sum()
    mean = sum(w * s for w, s in zip(weights, seen, strict=True))
    spread = [c + np.outer(s - mean, s - mean) for s, c in zip(seen, known, strict=True)]
    return np.asarray(mean), np.asarray(sum(w * c for w, c in zip(weights, spread, strict=True)))


@pytest.mark.parametrize("degenerate", [False, True])
@pytest.mark.parametrize(("m", "rows"), [(3, 1), (4, 2), (6, 1), (6, 2), (9, 2)])
def test_what_each_sensor_did_is_that_of_sets_solved_one_by_one(m: int, rows: int, degenerate: bool) -> None:
    rng = np.random.default_rng([m, rows, degenerate])
    for out in (set(), {m - 1} if m > 4 - (rows == 1) else set()):
        changes = changes_of(rng, m, rows, degenerate=degenerate)
        sets = Sets(changes, replace(changes, scatter=2e-6), reach=float(rng.choice([0.0, 2e-5])))
        for j, found in enumerate(residuals(sets, out).values()):
            mean, covariance = one_by_one(sets, j, set(out))
            assert found.vector == pytest.approx(mean, rel=0, abs=1e-12 * np.abs(mean).max())
            assert found.covariance == pytest.approx(covariance, rel=0, abs=1e-12 * np.abs(covariance).max())
