"""A stored unit type as the block of a plan: its sensors, and its tolerances where none are asked for."""

import numpy as np

from estimator.arrays import unit
from estimator.errors import Problem
from estimator.message import say
from estimator.session import Sensor
from service.kit.measures import MEASURES
from service.planning.question import PlanQuestion
from service.sessions.records import PARAMETERS
from service.types.records import UnitType

MOST_SENSORS = 48
"""As many as `imu-health simulate` makes; larger blocks are not tried."""


def why_not(unit_type: UnitType) -> tuple[Problem, ...]:
    """Why units of a type cannot be planned for on a two-axis stand."""
    if unit_type.gyro_tolerances is not None or unit_type.block not in ("accelerometer", "gyroscope"):
        return (
            Problem(
                "unit_type",
                say("{name} has accelerometers and gyros; plan from a session file of it", name=unit_type.name),
            ),
        )
    if not 3 <= len(unit_type.sensors) <= MOST_SENSORS:
        return (
            Problem(
                "unit_type",
                say(
                    "{name} has {sensors} sensors; 3 to {most_sensors} can be planned",
                    name=unit_type.name,
                    sensors=len(unit_type.sensors),
                    most_sensors=MOST_SENSORS,
                ),
            ),
        )
    if np.linalg.matrix_rank(np.array(unit_type.nominal_axes), tol=0.05) < 3:
        return (Problem("unit_type", say("the nominal axes of {name} lie in one plane", name=unit_type.name)),)
    return ()


def sensors_of(unit_type: UnitType) -> tuple[Sensor, ...]:
    """The type's sensors as its maker describes them."""
    described = zip(unit_type.sensors, unit_type.nominal_axes, unit_type.nominal_scales, strict=True)
    return tuple(Sensor(name, unit_type.block, unit(np.array([axis]))[0], scale, "") for name, axis, scale in described)


def asked_of(question: PlanQuestion, unit_type: UnitType) -> PlanQuestion:
    """The question with the type's kind, and its tolerances where no other ones are asked for."""
    filled: dict[str, object] = {"kind": unit_type.block}
    for name in PARAMETERS:
        tolerance = getattr(unit_type.tolerances, name)
        if getattr(question, name) is None and tolerance is not None:
            filled[name] = tolerance * MEASURES[unit_type.block, name].factor
    return question.model_copy(update=filled)
