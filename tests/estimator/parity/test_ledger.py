"""A recording as means of blocks in bounded memory, and the ends of each channel's range."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from estimator.parity.blocks import BlockSelection, grouped, select
from estimator.parity.ledger import Blocks, Ledger, Rails, empty_blocks
from estimator.parity.reference import ParityReference, reference_of
from estimator.session import ACCELEROMETER, Array
from tests.estimator.calibration.free_sessions import session
from tests.estimator.parity.cases import block


@cache
def reference() -> ParityReference:
    true, calibration = block(6)
    return reference_of(session(true, np.eye(3)).sensors, calibration, ACCELEROMETER)


def filled(samples: int, *, length: int = 2, most: int = 8) -> tuple[Ledger, Array]:
    """A ledger of white noise, and the inputs that went in."""
    readings = np.random.default_rng(1).standard_normal((samples, 6))
    ledger = Ledger(reference(), length, most)
    ledger.add(readings)
    return ledger, reference().inputs(readings)


def test_a_block_holds_mean_scatter_and_extremes_of_its_samples() -> None:
    ledger, inputs = filled(8, length=4)
    blocks = ledger.blocks()
    parts = inputs.reshape(2, 4, 6)
    assert blocks.mean == pytest.approx(parts.mean(axis=1))
    assert blocks.motion == pytest.approx(parts.var(axis=1))
    assert blocks.jitter == pytest.approx((np.diff(parts, axis=1) ** 2).mean(axis=1) / 2)


def test_neighbours_are_joined_when_there_are_too_many() -> None:
    ledger, inputs = filled(20)
    blocks = ledger.blocks()
    assert (ledger.length, blocks.first.tolist(), blocks.samples.tolist()) == (4, [0, 1, 2, 3, 4], [4.0] * 5)
    assert blocks.mean == pytest.approx(inputs.reshape(5, 4, 6).mean(axis=1))


def test_a_block_without_a_neighbour_weighs_as_many_samples_as_it_has() -> None:
    ledger, inputs = filled(18)
    blocks = ledger.blocks()
    assert blocks.samples.tolist() == [4.0, 4.0, 4.0, 4.0, 2.0]
    assert (blocks.samples[:, None] * blocks.mean).sum(axis=0) == pytest.approx(inputs.sum(axis=0))


def test_samples_wait_until_their_block_is_whole() -> None:
    ledger, _ = filled(7)
    assert len(ledger.blocks()) == 3


def test_an_empty_ledger_has_no_blocks() -> None:
    assert len(Ledger(reference(), 2).blocks()) == 0


def rails(readings: Array, sign: float = 1.0) -> float:
    """Value at which one channel is cut off, its samples given in three pieces."""
    ends = Rails(sign, 1)
    for part in np.array_split(readings[:, None], 3):
        ends.add(part)
    return float(ends.limit[0])


def test_a_channel_that_stands_ten_times_at_one_extreme_is_cut_off_there() -> None:
    noise = np.random.default_rng(2).uniform(-1, 1, 200)
    ends = np.concatenate([noise, np.full(10, 2.0)])
    assert rails(np.random.default_rng(3).permutation(ends)) == 2.0
    assert np.isnan(rails(ends[:-1]))


def test_the_lower_end_is_found_likewise() -> None:
    assert rails(np.maximum(np.random.default_rng(4).standard_normal(300), -1.0), sign=-1.0) == -1.0


def test_counts_that_thin_out_gently_are_no_end() -> None:
    """Ten at the top, three at the next: a coarse converter, not its end."""
    steps = np.repeat([0.0, 1.0, 2.0], [200, 3, 10])
    assert np.isnan(rails(np.random.default_rng(5).permutation(steps)))
    assert rails(np.repeat([0.0, 1.0, 2.0], [200, 1, 10])) == 2.0


def placed(first: list[int]) -> Blocks:
    """Blocks at these places; what grouping does not read is empty."""
    return replace(empty_blocks(6, len(first)), first=np.array(first))


def lengths(first: list[int], still: list[bool]) -> list[int]:
    """Blocks in each group."""
    counts: list[int] = np.bincount(grouped(placed(first), np.array(still))).tolist()
    return counts


def test_a_short_recording_is_a_group_a_block() -> None:
    assert lengths(list(range(10)), [False] * 10) == [1] * 10


def test_a_long_stretch_is_cut_into_a_thirtieth_of_the_recording() -> None:
    assert lengths(list(range(320)), [False] * 320) == [10] * 32


def test_a_rest_up_to_twice_as_long_as_a_group_is_one() -> None:
    still = [False] * 150 + [True] * 20 + [False] * 150
    assert lengths(list(range(320)), still) == [10] * 15 + [20] + [10] * 15


def test_a_gap_ends_a_group() -> None:
    first = [*range(155), *range(160, 325)]
    cuts = np.cumsum(lengths(first, [False] * 320))
    assert 155 in cuts


def selection() -> BlockSelection:
    """Selection from forty blocks of which the tenth moves."""
    rng = np.random.default_rng(6)
    readings = 1e-3 * rng.standard_normal((400, 6))
    readings[100:110] += rng.standard_normal((10, 6))
    ledger = Ledger(reference(), 10)
    ledger.add(readings)
    return select(ledger, "still")


def test_a_block_in_motion_is_left_out_where_rest_is_asked_for() -> None:
    found = selection()
    assert 10 not in found.blocks.first
    assert found.left_out["moving"] + len(found.blocks) == found.total == 40
