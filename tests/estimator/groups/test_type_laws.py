"""Temperature laws that a type's units have in common, and their worth to a unit with few sessions."""

from functools import cache

import numpy as np
import pytest

from estimator.groups.type_laws import FEWEST_UNITS, UnitHistory, type_laws
from estimator.health import judge
from estimator.health.temperature_law import Seen, temperature_steps
from estimator.health.type_law import TypeLaw
from estimator.session import ACCELEROMETER, Array
from tests.estimator.health.cases import TOLERANCES, calibration, sensor

BIAS = TOLERANCES[ACCELEROMETER, "bias"]
U = 0.04 * BIAS
SENSORS = 3
SLOPE, TYPICAL = 0.15, 0.1
"""T per °C: spread and mean."""
ROUGH = 0.1
"""T, about a law."""


def seen(bias: Array, celsius: float, years: float, rng: np.random.Generator) -> Seen:
    """A session of sensors with biases, T."""
    read = bias * BIAS + rng.normal(0, U, SENSORS)
    scale = 0.12 * (1 + rng.normal(0, 4e-6, SENSORS))
    each = (sensor(f"A{i + 1}", scale=(float(scale[i]), 0.12 * 4e-6), bias=(float(read[i]), U)) for i in range(SENSORS))
    return Seen(years, celsius, calibration(*each))


def unit(sessions: int, rng: np.random.Generator, now: float | None = None) -> list[Seen]:
    """Sessions four months apart of a unit of the type, from 20 °C on, the last one at a temperature that is asked."""
    slope = rng.normal(TYPICAL, SLOPE, SENSORS)
    warm = [20.0, *rng.uniform(10, 36, sessions - 1), *(() if now is None else (now,))]
    return [
        seen(slope * (celsius - 20) + rng.normal(0, ROUGH, SENSORS), float(celsius), i / 3, rng)
        for i, celsius in enumerate(warm)
    ]


@cache
def laws(units: int = 12) -> tuple[TypeLaw, ...]:
    rng = np.random.default_rng(1)
    histories = [unit(10, rng) for _ in range(units)]
    return type_laws([UnitHistory(own[0].calibration, own) for own in histories], TOLERANCES)


def test_mean_spread_and_scatter_are_those_of_the_type() -> None:
    law = next(one for one in laws() if one.parameter == "bias")
    assert (law.units, law.sensors) == (12, 12 * SENSORS)
    assert law.mean[0] == pytest.approx(TYPICAL, abs=3 * SLOPE / np.sqrt(law.sensors))
    assert law.sigma[0] == pytest.approx(SLOPE, rel=0.4)
    assert law.sigma[1] < 0.002
    assert law.usual_scatter == pytest.approx(ROUGH, rel=0.4)


def test_few_units_tell_nothing_of_their_type() -> None:
    assert laws(FEWEST_UNITS - 1) == ()


@pytest.mark.slow
@pytest.mark.parametrize("sessions", [5, 8])
def test_a_unit_of_the_type_is_decided_with_few_sessions(sessions: int) -> None:
    """U is as honest as it states, and more sessions are decided than by their own laws."""
    covered, decided = [], {False: 0, True: 0}
    for seed in range(40):
        *lived, last = unit(sessions, np.random.default_rng((2, seed)), now=33.0)
        reference = lived[0].calibration
        for known in (False, True):
            own = temperature_steps(lived, reference, (20.0, 33.0), TOLERANCES, laws() if known else ())
            found = [j for j in judge(last.calibration, reference, TOLERANCES, steps=own) if j.parameter == "bias"]
            taken = [j.temperature_correction for j in found]
            decided[known] += sum(one is not None and one.expanded <= BIAS for one in taken)
            if known:
                covered += [abs(one.corrected) <= one.expanded for one in taken if one is not None]
    assert decided[True] > max(decided[False], 50)
    assert 0.9 <= np.mean(covered) <= 1.0


def test_a_sensor_that_moved_beside_the_law_fails() -> None:
    *lived, last = unit(8, np.random.default_rng(3), now=33.0)
    moved = last.calibration.sensor("A2").bias.value or 0.0
    broken = calibration(
        *(
            sensor(s.name, bias=(moved + 4 * BIAS if s.name == "A2" else s.bias.value or 0.0, U))
            for s in last.calibration.sensors
        )
    )
    steps = temperature_steps(lived, lived[0].calibration, (20.0, 33.0), TOLERANCES, laws())
    found = judge(broken, lived[0].calibration, TOLERANCES, steps=steps)
    assert [j.sensor for j in found if j.verdict == "fail"] == ["A2"]
