"""A sound unit far from the temperature of its history has not drifted for certain."""

import numpy as np
import pytest

from estimator import diagnose, read_session
from tests.blind.warmth import at_temperature, draw_law, draw_unit_at_room, stepped

OF_TEMPERATURE = {"bias-temperature", "scale-temperature", "unexplained"}


@pytest.mark.parametrize("number", range(2))
def test_no_drift_is_named_at_another_temperature_without_temperature_beside_it(number: int) -> None:
    rng = np.random.default_rng((13, number))
    world = draw_unit_at_room(rng)
    law = draw_law(4, rng, curved=number == 1)
    reference = at_temperature(world, law, 20.0, "2026-01-10", rng)
    found = diagnose(read_session(at_temperature(world, law, 35.0, "2026-04-10", rng)), [read_session(reference)])
    drifts = [f for f in found.findings if f.cause == "sensor-drift"]
    assert drifts
    assert all(OF_TEMPERATURE & set(f.alternatives) for f in drifts)
    assert all("20 °C" in f.advice and "replacement" not in f.advice for f in drifts)


def test_a_sensor_that_moved_at_the_same_temperature_is_named_as_ever() -> None:
    rng = np.random.default_rng((14, 0))
    world = draw_unit_at_room(rng)
    nothing = 0 * draw_law(4, rng, curved=False)
    reference = at_temperature(world, nothing, 20.0, "2026-01-10", rng)
    moved, sensor = stepped(world, rng)
    found = diagnose(read_session(at_temperature(moved, nothing, 22.0, "2026-04-10", rng)), [read_session(reference)])
    (drift,) = [f for f in found.findings if f.cause == "sensor-drift"]
    assert drift.sensors == (sensor,)
    assert not OF_TEMPERATURE & set(drift.alternatives)
