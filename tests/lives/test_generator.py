"""The lives are what they are said to be: deterministic, readable, cheap, and of all kinds."""

from collections import Counter

import numpy as np
import pytest

from estimator import calibrate, read_session
from tests.lives.generator.crew import accepted, entries
from tests.lives.generator.epochs import epochs
from tests.lives.generator.kinds import KINDS
from tests.lives.generator.life import Plan, Sensors, draw_life, draw_type
from tests.lives.generator.sessions import draw_block, session_of
from tests.lives.generator.workshop import draw_stands


def test_the_same_seed_gives_the_same_life() -> None:
    first, second = (_entered(7) for _ in range(2))
    assert [(one.day, one.what, one.document) for one in first] == [(o.day, o.what, o.document) for o in second]


def _entered(seed: int) -> tuple:
    rng = np.random.default_rng(seed)
    return entries(draw_life("LV-007", draw_type(1, "accelerometers", rng), rng), rng)


def test_kinds_come_in_their_shares() -> None:
    rng = np.random.default_rng(3)
    type_, stands = draw_type(1, "accelerometers", rng), draw_stands(rng)
    plan = Plan().bad(0.2)
    found = Counter(draw_life("LV", type_, rng, plan, stands).kind() for _ in range(400))
    assert 0.74 < found["stable"] / 400 < 0.86
    assert set(found) == set(KINDS)


@pytest.mark.parametrize("sensors", ["accelerometers", "gyros", "both"])
def test_every_session_is_calibrated_and_what_moved_is_seen(sensors: Sensors) -> None:
    """The estimator sees a parameter move by what the life says, within the uncertainty it states."""
    rng = np.random.default_rng(5)
    type_ = draw_type(1, sensors, rng)
    life = draw_life("LV", type_, rng, Plan(shares=(("ramp", 1.0),), services=0.0))
    move, block = life.moves[0], draw_block(life, rng)
    bias = next(k for k, name in enumerate(life.names) if name == move.sensor)
    found = [
        calibrate(read_session(session_of(life, block, one, rng))) for one in (life.sessions[0], life.sessions[-1])
    ]
    assert all(len(one.sensors) == len(life.names) for one in found)
    if move.parameter in ("bias", "scale", "quadratic"):
        first, last = (getattr(one.sensors[bias], move.parameter) for one in found)
        true = move.days[life.sessions[-1].day] * type_.tolerances[move.sensor[0], move.parameter]
        true *= first.value if move.parameter == "scale" else 1.0
        assert abs(last.value - first.value - true) < 5 * np.hypot(last.sigma, first.sigma)


def test_an_epoch_carries_the_error_of_its_reference() -> None:
    """Deviations of stable parameters scatter by both sessions' uncertainties, and all of an epoch share one offset."""
    rng = np.random.default_rng(11)
    type_, stands = draw_type(1, "accelerometers", rng), draw_stands(rng)
    plan = Plan(shares=(("stable", 1.0),), services=0.3)
    made = [
        epoch for _ in range(60) for many in epochs(draw_life("LV", type_, rng, plan, stands), 3, rng) for epoch in many
    ]
    z = np.concatenate([one.value[1:] / np.hypot(one.sigma[1:], one.sigma[0]) for one in made])
    assert 0.9 < float(np.std(z)) < 1.1
    shared = [float(one.truth[0]) / one.sigma[0] for one in made]
    assert 0.85 < float(np.std(shared)) < 1.15


def test_what_was_entered_wrong_is_put_right_in_the_end() -> None:
    """One upload of every session and one record of every service counts in the end."""
    rng = np.random.default_rng(13)
    type_ = draw_type(1, "accelerometers", rng)
    for i in range(10):
        life = draw_life(f"LV-0{i}", type_, rng)
        made = entries(life, rng)
        assert [one.day for one in made] == sorted(one.day for one in made)
        assert len(accepted(made)) == len(life.sessions) + len(life.services)
        assert {one.document["unit"] for one in accepted(made) if "unit" in one.document} == {life.serial}
