"""Rests end where gyros stop being quiet."""

import numpy as np
import pytest

from estimator.hand_turns.quiet import quiet_ends


def log(tail):
    """Noise of 400 samples at 100 Hz, of three gyros, with a turn that begins ``tail`` samples before the end."""
    readings = 0.001 * np.random.default_rng(0).standard_normal((400, 3))
    readings[400 - tail :, 0] += 0.1
    return readings


def ends(tail, *, labelled):
    start, stop = quiet_ends(log(tail), np.array([0]), np.array([400]), 0.01, labelled=labelled)
    return int(start[0]), int(stop[0])


@pytest.mark.parametrize("tail", [5, 20, 40])
def test_a_turn_that_has_begun_is_cut_off(tail):
    first, last = ends(tail, labelled=True)
    assert first == 0
    assert 400 - tail - 40 <= last <= 400 - tail


def test_a_labelled_rest_that_is_quiet_stays():
    assert ends(0, labelled=True) == (0, 400)


def test_a_rest_that_was_found_loses_a_margin():
    assert ends(0, labelled=False) == (20, 380)


def test_readings_that_never_change_are_quiet():
    start, stop = quiet_ends(np.ones((300, 3)), np.array([0]), np.array([300]), 0.01, labelled=True)
    assert (start[0], stop[0]) == (0, 300)
