"""Θ's parts: whose noise it is, which directions count, which blocks are used, and the distribution of χ²."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import null_space

from estimator.parity.blocks import BlockSelection, select, wanted
from estimator.parity.check import ParityAccumulator
from estimator.parity.flight import AEROBATIC, Manoeuvre
from estimator.parity.hypotheses import ParityEvidence
from estimator.parity.ledger import Ledger
from estimator.parity.regression import excited, regress, sensor_noise
from estimator.session import Array
from tests.estimator.parity.cases import STILL, block, recording
from tests.estimator.parity.test_ledger import placed, reference

GROUPS = 32


def selection(groups: int = GROUPS) -> BlockSelection:
    """Ten blocks a group; only the groups are looked at."""
    blocks = placed(list(range(10 * groups)))
    mask = np.zeros(len(blocks), dtype=bool)
    return BlockSelection(blocks, np.repeat(np.arange(groups), 10), mask, mask, (), {}, len(blocks))


def directions(swing: Array) -> Array:
    """Directions that (1, n/g) excites, swinging by (320, 3) about z."""
    x = np.column_stack([np.ones(len(swing)), swing + np.array([0.0, 0.0, 1.0])])
    return excited(x, np.ones(len(x)), selection(), GROUPS)


def test_a_direction_counts_from_a_fiftieth_of_g_on() -> None:
    turn = 2 * np.pi * 17 * np.arange(320) / 320
    found = directions(np.sqrt(2) * np.column_stack([0.025 * np.sin(turn), 0.015 * np.cos(turn), 0 * turn]))
    assert found.shape == (4, 2)
    assert found.T @ found == pytest.approx(np.eye(2))
    assert np.linalg.norm(found[1]) == pytest.approx(1.0, abs=1e-3)
    assert np.linalg.norm(found[2]) < 1e-3


def test_a_direction_that_changes_in_one_group_only_does_not_count() -> None:
    """The residuals of such a direction would not show the noise."""
    swing = np.zeros((320, 3))
    swing[:10, 0] = np.tile([1.0, -1.0], 5)
    assert directions(swing).shape == (4, 1)
    swing[10:20] = swing[:10]
    assert directions(swing).shape == (4, 2)


def test_the_mean_of_what_is_applied_is_always_excited() -> None:
    assert directions(np.zeros((320, 3)))[:, 0] ** 2 == pytest.approx([0.5, 0.0, 0.0, 0.5])


DRAWN = 6.0
"""Groups that the mean of all sensors weighs."""


def parts_of(sigma: Array, groups: int, seed: int = 1) -> tuple[Array, Array]:
    """(groups, d) parts of sensors with these standard errors, and V."""
    V = null_space(np.random.default_rng(0).standard_normal((len(sigma), 3)).T)
    return sigma * np.random.default_rng(seed).standard_normal((groups, len(sigma))) @ V, V


def noise_of(sigma: Array, groups: int, seed: int = 1) -> tuple[Array, Array]:
    """`sensor_noise` (m, 1, 1) of these, and V."""
    parts, V = parts_of(sigma, groups, seed)
    return sensor_noise(parts[:, None, :], V, groups), V


def test_each_sensor_has_the_noise_of_its_own() -> None:
    sigma = np.array([1.0, 1.0, 4.0, 1.0, 2.0, 1.0, 1.0, 1.0])
    found, _ = noise_of(sigma, 20_000)
    assert np.sqrt(found[:, 0, 0] / 20_000) == pytest.approx(sigma, rel=0.05)


def test_few_groups_draw_each_sensor_towards_the_mean() -> None:
    """The mean weighs as much as six groups beside the sensor's own."""
    groups, sigma = 20, np.array([1.0, 1.0, 4.0, 1.0, 2.0, 1.0, 1.0, 1.0])
    many = [noise_of(sigma, groups, seed) for seed in range(400)]
    V = many[0][1]
    found = np.mean([omega[:, 0, 0] for omega, _ in many], axis=0) / groups
    weight = groups * (V**2).sum(axis=1)
    mean = ((V @ V.T) ** 2 @ sigma**2).sum() / (V**2).sum()
    loud = (weight * sigma**2 + DRAWN * mean) / (weight + DRAWN)
    assert found[2] == pytest.approx(loud[2], rel=0.05)


def test_no_sensor_s_own_variance_is_below_nothing() -> None:
    """The share of the mean is the least that each has."""
    sigma = np.array([1e-3, 1.0, 1.0, 1.0, 1.0, 1.0])
    for seed in range(20):
        parts, V = parts_of(sigma, 8, seed)
        mean = ((parts @ V.T) ** 2).sum() / (V**2).sum()
        least = DRAWN * mean / (8 * (V**2).sum(axis=1) + DRAWN)
        assert (noise_of(sigma, 8, seed)[0][:, 0, 0] >= least * (1 - 1e-9)).all()


def used(motion: str, *, rest: int, spoilt: float, averaged: bool = False) -> Array:
    """Forty blocks, the first of them at rest; the others' parity is ``spoilt`` times as large."""
    rng = np.random.default_rng(3)
    mean = rng.standard_normal((40, 6))
    mean[rest:] *= spoilt
    blocks = replace(placed(list(range(40))), mean=mean)
    still = np.arange(40) < rest
    return wanted(blocks, Ledger(reference(), 1 if averaged else 10), still, np.ones(40, dtype=bool), motion)


def test_blocks_are_used_as_the_kind_of_motion_asks() -> None:
    assert used("any", rest=20, spoilt=9.0).sum() == 40
    assert used("still", rest=20, spoilt=1.0).tolist() == [True] * 20 + [False] * 20


def test_motion_is_left_out_where_it_spoils_parity_and_rest_is_enough() -> None:
    assert used("auto", rest=20, spoilt=3.0).tolist() == [True] * 20 + [False] * 20
    assert used("auto", rest=20, spoilt=1.2).sum() == 40
    assert used("auto", rest=11, spoilt=3.0).sum() == 40
    assert used("auto", rest=12, spoilt=3.0).sum() == 12


def test_rows_that_are_averages_are_all_used() -> None:
    assert used("still", rest=20, spoilt=9.0, averaged=True).sum() == 40


@pytest.mark.parametrize(("manoeuvres", "s", "dof"), [(STILL, 1, 12.0), (AEROBATIC, 4, 16.0), (AEROBATIC, 4, 40.0)])
def test_chi_square_by_a_covariance_from_few_groups_has_the_moments_that_are_stated(
    manoeuvres: tuple[Manoeuvre, ...], s: int, dof: float
) -> None:
    """Hotelling: three vectors of s numbers, each by a covariance from ``dof`` draws of its own."""
    rng = np.random.default_rng(s)
    y, draws = rng.standard_normal((40_000, 3, s)), rng.standard_normal((40_000, 3, int(dof), s))
    W = np.einsum("ndki,ndkj->ndij", draws, draws) / dof
    found = np.einsum("ndi,ndi->n", y, np.linalg.solve(W, y[..., None])[..., 0])
    scale, effective = evidence(manoeuvres, dof).moments(3 * s)
    assert scale * effective == pytest.approx(found.mean(), rel=0.02)
    assert 2 * scale**2 * effective == pytest.approx(found.var(), rel=0.15)


def evidence(manoeuvres: tuple[Manoeuvre, ...], dof: float) -> ParityEvidence:
    """Evidence of a flight of six sensors, with noise that is all its own and known from ``dof`` numbers."""
    true, calibration = block(6)
    flight = recording(true, manoeuvres=manoeuvres, seconds=120.0)
    stream = ParityAccumulator("T-1", flight.sensors, calibration, sample_rate=20.0, site=flight.site)
    stream.add(flight.readings)
    change = regress(select(stream.ledger, "any"), stream.reference, 9.81)
    return ParityEvidence(replace(change, dof=dof, known=np.zeros_like(change.known)))
