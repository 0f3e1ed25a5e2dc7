"""Sensors that follow a course: the likeliest set, and each one's own evidence."""

import numpy as np
import pytest

from estimator.diagnosis.selection.membership import SIZES, Loadings, log_sets

KIND = "accelerometer"


def orthogonal(along: list[float]) -> Loadings:
    """Sensors whose traces do not overlap."""
    m = len(along)
    return Loadings(np.eye(m), np.array(along), (KIND,) * m, {KIND: m})


def brute_force(loadings: Loadings, chosen: tuple[int, ...]) -> float:
    """ln p of a set by its definition."""
    A, y = loadings.gram[np.ix_(chosen, chosen)], loadings.along[list(chosen)]
    values = []
    for g in SIZES:
        inverse = np.linalg.inv(A + np.eye(len(y)) / g)
        values.append(0.5 * y @ inverse @ y - 0.5 * np.linalg.slogdet(np.eye(len(y)) + g * A)[1])
    mean = float(np.logaddexp.reduce(values) - np.log(len(SIZES)))
    return mean - log_sets(loadings.counts, {KIND}, len(chosen))


def test_a_step_of_the_climb_is_the_definition_of_the_set_that_it_leads_to() -> None:
    rng = np.random.default_rng(1)
    traces = rng.standard_normal((30, 5))
    traces /= np.linalg.norm(traces, axis=0)
    loadings = Loadings(traces.T @ traces, rng.normal(0, 4, 5), (KIND,) * 5, {KIND: 5})
    values, value = loadings.steps((0, 2, 3))
    assert value == pytest.approx(brute_force(loadings, (0, 2, 3)))
    assert values[1] == pytest.approx(brute_force(loadings, (0, 1, 2, 3)))
    assert values[2] == pytest.approx(brute_force(loadings, (0, 3)))


def test_many_that_none_can_be_named_alone_share_a_course() -> None:
    members = orthogonal([2.4, -2.6, 2.5, 2.3, -2.5, 2.6] * 4).members()
    assert members.are_several
    assert len(members.chosen) == 24


def test_one_that_stands_out_shares_with_nobody() -> None:
    members = orthogonal([20.0, 0.5, -1.2, 0.3, 1.1, -0.7]).members()
    assert members.chosen == (0,)
    assert not members.are_several


@pytest.mark.parametrize("count", [2, 3, 4, 5, 6])
def test_those_that_follow_are_named_whatever_their_number(count: int) -> None:
    members = orthogonal([12.0] * count + [0.8] * (6 - count)).members()
    assert members.sure == tuple(range(count))


def test_who_shows_nothing_is_not_named_because_most_others_follow() -> None:
    members = orthogonal([12.0] * 23 + [1.5]).members()
    assert members.sure == tuple(range(23))


def test_all_of_a_kind_cost_no_more_than_all_of_the_block() -> None:
    both = {KIND: 24, "gyroscope": 24}
    assert log_sets(both, {"gyroscope"}, 24) == pytest.approx(np.log(3 * 24))
    assert log_sets(both, {KIND, "gyroscope"}, 48) == pytest.approx(np.log(3 * 48))
