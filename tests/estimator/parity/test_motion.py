"""Effects of motion on sound sensors, and the results they lead to. The flights share no code with the estimator."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from estimator.calibration import calibrate
from estimator.parity import ParityResult, parity_check
from estimator.parity.blocks import select
from estimator.parity.check import ParityAccumulator
from estimator.parity.freed import freed
from estimator.parity.nuisance import nuisance_of
from estimator.parity.regression import regress
from estimator.reading import read_session
from tests.blind.flight import RATE, G, Setting, draw_block, fly, tumble

SMOOTH = Setting(seconds=150.0, arm=0.05, delay=1.0, vibration=0.02)
"""A flight in which lever arms and delays show most."""


@cache
def flown(seed: int, size: float = 0.0, **changes: Any) -> ParityResult:
    """A flight of a drawn block; the zero of A3 has moved by ``size``, m/s²."""
    setting = replace(SMOOTH, **changes)
    rng = np.random.default_rng([seed, 7])
    block = draw_block(rng, setting)
    known = calibrate(read_session(tumble(block, rng)), quadratic=False)
    return parity_check(read_session(fly(block.changed(2, "bias", size), setting, rng)), known)


@pytest.mark.slow
@pytest.mark.parametrize(("stated", "gyros"), [(False, False), (True, False), (False, True), (True, True)])
def test_lever_arms_and_delays_name_no_sensor(stated: bool, gyros: bool) -> None:
    found = [flown(seed, stated=stated, gyros=gyros) for seed in range(4)]
    assert [r.isolated for r in found] == [None] * 4
    assert sum(r.detected for r in found) <= 1


def test_some_of_these_flights_would_be_called_changed_if_motion_did_nothing() -> None:
    """The result then says that they move too much, with the sensors that would have been suspected."""
    found = [flown(seed, stated=False, gyros=False) for seed in range(4)]
    moving = [r for r in found if r.moving]
    assert moving
    for r in moving:
        assert r.p_value_unmoved < 0.01 < r.p_value
        assert r.suspects
        assert r.motion_share > 0.3


def test_a_change_beyond_what_motion_can_do_is_named_in_flight() -> None:
    assert [flown(seed, 0.1, stated=True, gyros=True).isolated for seed in range(3)] == ["A3"] * 3


def test_gyros_beside_show_smaller_changes() -> None:
    blind, seeing = (flown(1, stated=True, gyros=gyros).sensor("A1").bias.detectable for gyros in (False, True))
    assert blind is not None
    assert seeing is not None
    assert seeing < 0.5 * blind


def test_stated_places_show_smaller_changes() -> None:
    blind, seeing = (flown(1, stated=stated, gyros=False).sensor("A1").bias.detectable for stated in (False, True))
    assert blind is not None
    assert seeing is not None
    assert seeing < 0.8 * blind


def test_rest_keeps_its_power() -> None:
    """Rest holds no motion, so nothing is lost: less than a hundredth of the variance, half of that in sigma."""
    found = flown(3, rest=True, seconds=200.0)
    assert found.left_out["moving"] > 50
    assert found.motion_share < 0.01


def test_a_change_is_named_from_the_rest_of_a_flight() -> None:
    assert flown(4, 2e-3, rest=True, seconds=200.0).isolated == "A3"


def stream(**changes: Any) -> tuple[ParityAccumulator, Any]:
    """A flight taken in, and its block."""
    setting = replace(SMOOTH, noise=1e-6, gyros=True, **changes)
    rng = np.random.default_rng(11)
    block = replace(draw_block(rng, setting), rectification=np.zeros(6))
    session = read_session(fly(block, setting, rng))
    known = calibrate(read_session(tumble(block, rng, 1e-6)), quadratic=False)
    taken = ParityAccumulator("R-1", session.sensors, known, sample_rate=RATE, site=session.site)
    taken.add(session.readings)
    return taken, block


def test_the_delays_are_found() -> None:
    """Delays are in samples; those common to all sensors, along each axis of the block, are motion."""
    taken, block = stream(arm=0.0)
    chosen = select(taken.ledger, "any", G, RATE)
    unknown = nuisance_of(chosen.blocks, chosen.rest, taken.reference, G, RATE, arms=False)
    plain, cleared = regress(chosen, taken.reference, G), freed(chosen, taken.reference, G, unknown)
    assert cleared.residual_rms < 0.2 * plain.residual_rms
    true = unknown.moved(np.concatenate([block.delay / 4, np.zeros(6)])) @ taken.reference.parity
    p = chosen.blocks.mean @ taken.reference.parity
    assert np.corrcoef(true[:, 0], p[:, 0])[0, 1] > 0.99


def test_stated_places_take_their_lever_arms_off() -> None:
    taken, _ = stream(delay=0.0, stated=True)
    chosen = select(taken.ledger, "any", G, RATE)
    unknown = nuisance_of(chosen.blocks, chosen.rest, taken.reference, G, RATE)
    p, left = (a @ taken.reference.parity for a in (chosen.blocks.mean, chosen.blocks.mean - unknown.known))
    assert left.std() < 0.3 * p.std()
