"""A pattern for a session: the last one of a unit or of a type's units, or, without any, a simulated one."""

from dataclasses import replace
from datetime import date

import numpy as np

from estimator.arrays import unit
from estimator.calibration.calibrate import averaged
from estimator.errors import Problem, problem_at
from estimator.parameters import nominal
from estimator.session import CalibrationSession, Sensor
from estimator.simulate import simulate, stand_schedule
from service.ingest import read_upload
from service.kit.measures import MEASURES
from service.planning.question import PlanQuestion
from service.sessions.records import PARAMETERS
from service.sessions.store import Sessions
from service.stands.store import StandCertificates
from service.storage import Storage
from service.storage.queries import Store
from service.types.records import UnitType
from service.types.store import UnitTypes

MOST_SENSORS = 48
"""Most sensors of a planned block, as many as `imu-health simulate` makes."""


def why_not(unit_type: UnitType) -> tuple[Problem, ...]:
    """The reasons why units of a type cannot be planned on a two-axis stand; empty where they can."""
    if unit_type.gyro_tolerances is not None or unit_type.block not in ("accelerometer", "gyroscope"):
        return (
            problem_at(
                "unit_type", "{name} has accelerometers and gyros; plan from a session file of it", name=unit_type.name
            ),
        )
    if not 3 <= len(unit_type.sensors) <= MOST_SENSORS:
        return (
            problem_at(
                "unit_type",
                "{name} has {sensors} sensors; 3 to {most_sensors} can be planned",
                name=unit_type.name,
                sensors=len(unit_type.sensors),
                most_sensors=MOST_SENSORS,
            ),
        )
    if np.linalg.matrix_rank(np.array(unit_type.nominal_axes), tol=0.05) < 3:
        return (problem_at("unit_type", "the nominal axes of {name} lie in one plane", name=unit_type.name),)
    return ()


def sensors_of(unit_type: UnitType) -> tuple[Sensor, ...]:
    """The type's sensors with their nominal values."""
    specifications = zip(unit_type.sensors, unit_type.nominal_axes, unit_type.nominal_scales, strict=True)
    return tuple(
        Sensor(name, unit_type.block, unit(np.array([axis]))[0], scale, "") for name, axis, scale in specifications
    )


def completed(question: PlanQuestion, unit_type: UnitType) -> PlanQuestion:
    """The question with the type's kind, and its tolerances where no others are given."""
    values: dict[str, object] = {"kind": unit_type.block}
    for name in PARAMETERS:
        tolerance = getattr(unit_type.tolerances, name)
        if getattr(question, name) is None and tolerance is not None:
            values[name] = tolerance * MEASURES[unit_type.block, name].factor
    return question.model_copy(update=values)


LARGEST = 4 * 1024 * 1024
"""Bytes of a file that is read as a pattern: a session of positions has a hundredth, and a long log adds nothing."""
MOST_TYPES = 500
"""Offered for a choice."""
POSITIONS = 12
"""A run, of the simulated pattern: every 30°."""
SEED = 1
"""Seed of the pattern's noise: the same pattern every time."""
NOISE = 1e-5
"""m/s² or rad/s, one sigma: one µg, so that it looks measured."""


def type_names(store: Store) -> tuple[str, ...]:
    """Names of the stored types, for a choice."""
    return tuple(known.name for known in UnitTypes(store).page(0, MOST_TYPES))


def pattern(storage: Storage, serial: str, unit_type: str, question: PlanQuestion, today: date) -> CalibrationSession:
    """The expected form of the next session of the unit or type; NotFoundError for an unknown type. Of its stand's
    errors it states what the stand's certificate of today does."""
    last = earlier(storage, serial, unit_type)
    if last is not None:
        return as_certified(storage, last, today)
    if not unit_type:
        return _simulated(question.cone())
    with storage.database.reading() as store:
        stored_type = UnitTypes(store).get(unit_type)
    if why_not(stored_type):
        return _simulated(question.cone())
    complete = completed(question, stored_type)
    return replace(_simulated(complete.block(sensors_of(stored_type))), unit_type=unit_type)


def earlier(storage: Storage, serial: str, unit_type: str) -> CalibrationSession | None:
    """The last session of the unit, or else of the type."""
    with storage.database.reading() as store:
        stored = Sessions(store).latest_like(serial, None) if serial else None
        if stored is None and unit_type:
            stored = Sessions(store).latest_like(None, unit_type)
    if stored is None or stored.size > LARGEST:
        return None
    session = read_upload(storage.files.read(stored.sha256), stored.filename)
    return replace(averaged(session) if session.is_raw else session, unit_type=session.unit_type or unit_type or None)


def as_certified(storage: Storage, session: CalibrationSession, today: date) -> CalibrationSession:
    """A session whose stand has the errors that its certificate states; what that leaves open stays as it was."""
    if session.stand is None:
        return session
    with storage.database.reading() as store:
        errors = StandCertificates(store).errors_on(session.stand.id, today)
    sigma = replace(session.stand.sigma, **{error.name: error.sigma for error in errors})
    return replace(session, stand=replace(session.stand, sigma=sigma))


def _simulated(template: CalibrationSession) -> CalibrationSession:
    """Nominal sensors on the stand of the question, which has no name yet."""
    assert template.stand is not None, "a plan is for a stand"
    stand = replace(template.stand, id="")
    empty = stand_schedule(
        template.sensors, stand, template.site, POSITIONS, unit_name="", count_time=template.count_time
    )
    noise = NOISE * np.array([sensor.nominal_scale for sensor in template.sensors])
    return simulate(empty, nominal(template.sensors), np.random.default_rng(SEED), noise=noise, state_noise=False)
