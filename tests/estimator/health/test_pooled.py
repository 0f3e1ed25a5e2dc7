"""The prior of a type: learned from its histories, nearly the general one from few."""

import numpy as np
import pytest

from estimator.health.fits import PART_KINDS, WALKS
from estimator.health.pooled import Evidence, Prior, general_prior, learn
from estimator.health.prognosis import evidence
from estimator.health.shapes import Kind
from tests.estimator.health.histories import dates, measured, walk


def of_type(kind: str, count: int, sessions: int = 10) -> list[Evidence]:
    """Histories of a type in which a quarter jumps, or all walk, or nothing happens."""
    rng = np.random.default_rng([3, count, *map(ord, kind)])
    found = []
    for i in range(count):
        t = dates(rng, sessions)
        jump = 0.8 * (t > rng.uniform(0.5, 2.5)) * (kind == "jump" and i % 4 == 0)
        found.append(evidence(measured(rng, t, jump + walk(rng, t, 0.25 * (kind == "walk")), sigma=0.05)))
    return found


def rate(prior: Prior, kind: Kind) -> float:
    return float(prior.rate[kind == PART_KINDS].sum())


def test_nothing_known_is_the_general_prior() -> None:
    assert learn([]).histories == 0
    assert learn([]).walk == pytest.approx(general_prior().walk)


def test_parts_are_all_that_can_happen() -> None:
    assert general_prior().parts(np.array([0.0, 1.0, 30.0])).sum(axis=1) == pytest.approx(1.0)


def test_the_rate_of_jumps_is_learned() -> None:
    """Every fourth history has one in about three years: 0.085 a year."""
    years = np.mean([h.span for h in of_type("jump", 80)])
    assert rate(learn(of_type("jump", 80)), Kind.JUMP) == pytest.approx(0.25 / years, rel=0.4)


def test_histories_that_drift_from_their_start_do_not_dilute_the_rate_of_jumps() -> None:
    """They can show no jump beside it, so the rate is that of the others alone."""
    rng = np.random.default_rng(17)
    times = [dates(rng, 10) for _ in range(80)]
    drifting = [evidence(measured(rng, t, 0.4 * t, sigma=0.05)) for t in times]
    alone, beside = (rate(learn([*of_type("jump", 80), *more]), Kind.JUMP) for more in ([], drifting))
    assert beside == pytest.approx(alone, rel=0.2)


def test_what_wanders_is_not_expected_to_drift_where_it_is_one_or_the_other() -> None:
    rng = np.random.default_rng(18)
    times = [dates(rng, 10) for _ in range(40)]
    drifting = [evidence(measured(rng, t, rng.choice([-0.4, 0.4]) * t, sigma=0.05)) for t in times]
    prior = learn([*of_type("walk", 40), *drifting])
    assert prior.walk @ WALKS > 0.15
    assert prior.moving @ WALKS < 0.05


def test_a_type_in_which_nothing_happens_expects_less_than_units_in_general() -> None:
    quiet = learn(of_type("still", 80))
    assert rate(quiet, Kind.JUMP) < rate(general_prior(), Kind.JUMP) / 2
    assert quiet.usual_walk == 0.0


def test_the_walk_of_a_type_that_walks_is_learned() -> None:
    assert learn(of_type("walk", 80)).usual_walk == pytest.approx(0.25, abs=0.1)


def test_one_history_hardly_moves_the_general_prior() -> None:
    assert learn(of_type("walk", 1)).walk == pytest.approx(general_prior().walk, abs=0.1)
