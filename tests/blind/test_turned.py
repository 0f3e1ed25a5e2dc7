"""Pairs between which the block was turned by up to five degrees, simulated apart from the estimator."""

import pytest

from benchmarks.study.turned_pairs import PROGRAMMES, Programme, Wish
from benchmarks.study.turns import Turned, examine, examine_flipped, page


@pytest.mark.slow
@pytest.mark.parametrize(
    ("programme", "degrees"),
    [(p, 5.0) for p in PROGRAMMES] + [(p, 0.5) for p in PROGRAMMES[::3]],
    ids=lambda p: p.name if isinstance(p, Programme) else None,
)
def test_a_turn_of_the_block_is_no_change_of_its_sensors(programme: Programme, degrees: float) -> None:
    found = examine(Wish(programme, degrees), (11, int(10 * degrees)))
    assert (found.drifts, found.others, found.judged) == ((), (), ())
    assert found.remount == programme.shows_a_turn


@pytest.mark.slow
@pytest.mark.parametrize("programme", PROGRAMMES[::2], ids=lambda p: p.name)
def test_mountings_of_a_history_that_differ_are_no_change_of_the_sensors(programme: Programme) -> None:
    found = examine(Wish(programme, 5.0, earlier=3), (12,))
    assert (found.drifts, found.others, found.judged) == ((), (), ())


@pytest.mark.parametrize("programme", PROGRAMMES[:2], ids=lambda p: p.name)
def test_a_drift_beside_a_large_turn_is_found_and_blamed_on_nobody_else(programme: Programme) -> None:
    found: Turned = examine(Wish(programme, 5.0, drift=16.0), (13,))
    assert found.drifted in found.drifts + found.listed
    assert set(found.drifts + found.judged) <= {found.drifted}


@pytest.mark.slow
@pytest.mark.parametrize("programme", [p for p in PROGRAMMES if p.stand], ids=lambda p: p.name)
def test_a_block_turned_by_degrees_in_its_flipped_run_is_named_so_and_nothing_else(programme: Programme) -> None:
    found = examine_flipped(programme, 3.0, (15, 30))
    assert (found.named, found.others) == (True, ())


def test_the_page_counts_what_was_said() -> None:
    found = [examine(Wish(PROGRAMMES[1], 5.0), (14,)), examine(Wish(PROGRAMMES[1], 5.0, drift=16.0), (14,))]
    assert "| all | 0.0 % (0.0–79.3) of 1 |" in page(found)
