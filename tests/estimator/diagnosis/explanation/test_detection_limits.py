"""Detection limits of a session: an effect at its limit is found nineteen times of twenty."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import diagnose
from estimator.diagnosis.explanation.detection_limits import named_from, required
from estimator.diagnosis.results import Limit
from estimator.session import ACCELEROMETER
from tests.estimator.calibration.cases import accelerometers, at_rows, block
from tests.estimator.causes.hiding import Scene, scene, with_readings
from tests.estimator.causes.physics import ACTED, World
from tests.estimator.causes.worlds import truth_of, wandering

WHERE = scene(ACCELEROMETER, 0)


def limits(where: Scene) -> dict[str, Limit]:
    """Limits by cause."""
    return {x.cause: x for x in diagnose(where.measured(1)).limits}


@pytest.mark.slow
@pytest.mark.parametrize("cause", ["bias-ramp", "beta-scale"])
def test_an_effect_at_its_limit_is_found(cause: str) -> None:
    world, (limit,) = WHERE.world, limits(WHERE)[cause].amplitude
    added = ACTED[cause](world, np.array([limit]), 2, ()) - world.inputs(world.vectors())
    seen = [bool(diagnose(with_readings(WHERE.measured(s), added * world.truth.scale)).findings) for s in range(20)]
    assert sum(seen) >= 16, "95 % power: fewer than 16 of 20 has probability 3e-4"


@pytest.mark.slow
def test_half_the_limit_is_mostly_missed() -> None:
    world, (limit,) = WHERE.world, limits(WHERE)["beta-scale"].amplitude
    added = ACTED["beta-scale"](world, np.array([limit / 2]), 2, ()) - world.inputs(world.vectors())
    seen = [bool(diagnose(with_readings(WHERE.measured(s), added * world.truth.scale)).findings) for s in range(12)]
    assert sum(seen) <= 6


def test_rarer_causes_of_more_amplitudes_ask_for_more() -> None:
    assert named_from(1, -5.0) < named_from(1, -9.0) < named_from(3, -9.0)
    assert required(1, 15.0) < required(1, 25.0)


def test_an_effect_at_its_limit_passes_nineteen_times_of_twenty() -> None:
    strength = required(2, 20.0)
    drawn = np.random.default_rng(5).standard_normal((20000, 2)) + np.array([strength, 0.0])
    assert np.mean((drawn**2).sum(axis=1) > 20.0) == pytest.approx(0.95, abs=0.005)


def test_what_was_not_recorded_is_named_as_the_reason() -> None:
    world = replace(WHERE.world, session=replace(WHERE.world.session, temperature=None, time=None))
    found = limits(replace(WHERE, world=world))
    assert "temperature" in found["bias-temperature"].reason
    assert "time" in found["bias-ramp"].reason
    assert "history" in found["gravity-entry"].reason


def test_few_positions_see_less() -> None:
    session = wandering(at_rows(block(accelerometers(), 4), np.arange(8)))
    few = limits(Scene(World(session, truth_of(session)), WHERE.noise))["cubic-nonlinearity"].amplitude
    many = limits(WHERE)["cubic-nonlinearity"].amplitude
    assert few[0] > 2 * many[0]
