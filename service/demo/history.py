"""A member's life: times of measurement, true parameters at each, and the session files."""

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import datetime, timedelta

import numpy as np

from estimator.arrays import unit
from estimator.parameters import SensorParameters
from estimator.results import ARCSEC
from estimator.session import (
    ACCELEROMETER,
    AS_FOUND,
    AS_LEFT,
    GYROSCOPE,
    ROTATION_ALIGNMENT,
    SIMULATED,
    Array,
    CalibrationSession,
)
from estimator.simulate import scattered, simulate
from estimator.writing import session_document
from service.demo.blocks import (
    DEGREE_PER_HOUR,
    ELEMENT,
    ELEVATION_DEG,
    MICRO,
    SENSORS,
    TYPE_NAME,
    ParameterMove,
    norms,
    schedule_of,
    sensors_of,
    step_of,
    with_effect,
)
from service.demo.cast import (
    CAST,
    CUBIC,
    ECCENTRIC_STAND,
    ECCENTRICITY,
    END,
    START,
    WAVE,
    WAVY_STAND,
    YEARS,
    DemoMember,
)
from service.demo.other_programmes import alignment, recording, turntable_truth
from service.kit.measures import YEAR

SEED = 20261112
"""Fixed, so that the demonstration is always the same."""
STANDS = ("ODG-1", "ODG-2", "ODG-3")
"""Invented, as the operators are."""
OPERATORS = ("A. Lindqvist", "K. Ito", "M. Okafor", "R. Duarte")
POSITIONS = (12, 24)
"""A run: a short session and a full one."""
STEEP_DEG = 65.0
"""Elevation of short sessions on the eccentric stand, degrees: at one elevation an eccentric scale looks like a
wobbling axis.
"""
NOISE = {ACCELEROMETER: 3e-6, GYROSCOPE: 0.3}
"""One sigma of an averaged reading: V; pulses."""
WANDER = {
    ACCELEROMETER: (3e-6, 1.5e-6, 0.0, ARCSEC, ARCSEC),
    GYROSCOPE: (60e-6, 0.0008 * DEGREE_PER_HOUR, 0.0, 8 * ARCSEC, 8 * ARCSEC),
}
"""One sigma of every sensor's random walk in a year, dimensionless."""
TURNED_STAND, TURNED_AT = "ODG-3", START + 2.2 * YEAR
TURN = np.array([4.0, -7.0, 11.0]) * ARCSEC
"""Turn of every block since then by the seat of that stand, rad: nobody noticed."""
FLOWN_AFTER = timedelta(days=8, hours=3)
"""Time from a calibration to the recording in service."""
TURNTABLE_TYPE = "RT-3"
"""Type of the unit that is aligned on a turntable."""
AROUND_SERVICE = timedelta(days=4)
"""Time from a session as found to the service, and from there to the session as left."""
NOTES = "Simulated session of the demonstration fleet."
"""Note in every file, so that none passes for a measurement."""


@dataclass(frozen=True)
class DemoFile:
    """One simulated session as a user would upload it."""

    name: str
    content: bytes
    at: datetime


def files_of(
    member: DemoMember, rng: np.random.Generator | None = None, shift: timedelta = timedelta()
) -> Iterator[DemoFile]:
    """The member's sessions in order, so much later than its story says; the same bytes every time."""
    if rng is None:
        rng = np.random.default_rng([SEED, CAST.index(member)])
    if member.programme == ROTATION_ALIGNMENT:
        yield from _alignments(member, rng)
        return
    norm = norms(member.kind, SENSORS)
    dates = _dates(member, rng)
    start = scattered(sensors_of(member.kind, SENSORS), norm, rng)
    for number, (at, walked) in enumerate(zip(dates, _walk(member.kind, dates, rng), strict=True)):
        changed = step_of(_changes(member, at), SENSORS, member.kind)
        truth = start.stepped(walked + changed, norm)
        session = _measured(member, at, truth, NOISE[member.kind] * _roughness(member, number), rng)
        session = replace(session, stage=_stage(member, at))
        if member.hidden is not None and number == member.sessions - 1:
            session = with_effect(session, member.hidden)
        yield _file(session, at + shift)
    if member.flown is not None:
        now = truth.stepped(step_of((member.flown,), SENSORS, member.kind), norm)
        flight = recording(member.serial, sensors_of(member.kind, SENSORS), now, rng)
        yield _file(replace(flight, unit_type=TYPE_NAME[member.kind], notes=NOTES), at + FLOWN_AFTER)


def _alignments(member: DemoMember, rng: np.random.Generator) -> Iterator[DemoFile]:
    """Alignments before use, of a block that wanders a little and drifts as its story says."""
    dates = _dates(member, rng)
    wander = np.cumsum(0.5 * rng.standard_normal((len(dates), 3)), axis=0)
    for at, walked in zip(dates, wander, strict=True):
        moved = step_of(_changes(member, at), SENSORS, ACCELEROMETER)[:3, ELEMENT["bias"]] / MICRO
        truth = turntable_truth(walked + moved, 0.001 * rng.standard_normal(3), rng)
        aligned = alignment(member.serial, truth, rng)
        operator = OPERATORS[rng.integers(len(OPERATORS))]
        yield _file(replace(aligned, unit_type=TURNTABLE_TYPE, operator=operator, notes=NOTES), at)


def _file(session: CalibrationSession, at: datetime) -> DemoFile:
    dated = replace(session, started_at=f"{at:%Y-%m-%dT%H:%M:%SZ}", origin=SIMULATED)
    return DemoFile(f"{session.unit}-{at:%Y-%m-%d}.json", json.dumps(session_document(dated)).encode(), at)


def _dates(member: DemoMember, rng: np.random.Generator) -> list[datetime]:
    """Irregular dates from the member's first day to the last, by day, in working hours."""
    first = START + member.joined * YEAR
    last = END if member.left == YEARS else START + member.left * YEAR
    pace = (last - first) / (member.sessions - 1)
    jitter = rng.uniform(-0.3, 0.3, member.sessions)
    jitter[0], jitter[-1] = 0.0, -abs(jitter[-1])
    days = [(number + shift) * pace.days for number, shift in enumerate(jitter)]
    hours = rng.integers(0, 8, member.sessions)
    dates = [first + timedelta(days=int(day), hours=int(hour)) for day, hour in zip(days, hours, strict=True)]
    for service in (service for service in member.services if service.measured):
        before = max(number for number, at in enumerate(dates) if at < service.at)
        dates[before], dates[before + 1] = service.at - AROUND_SERVICE, service.at + AROUND_SERVICE
    return dates


def _stage(member: DemoMember, at: datetime) -> str | None:
    """Stage of a session: as found before a measured service, as left after it; None otherwise."""
    stages = dict.fromkeys((s.at - AROUND_SERVICE for s in member.services if s.measured), AS_FOUND)
    stages |= dict.fromkeys((s.at + AROUND_SERVICE for s in member.services if s.measured), AS_LEFT)
    return stages.get(at)


def _walk(kind: str, dates: list[datetime], rng: np.random.Generator) -> Array:
    """(sessions, m, 5) the random walk since the first session, dimensionless."""
    years = np.diff([(at - dates[0]) / YEAR for at in dates], prepend=0.0)
    steps = rng.standard_normal((len(dates), SENSORS, 5)) * np.array(WANDER[kind])
    return np.asarray(np.cumsum(np.sqrt(years)[:, None, None] * steps, axis=0))


def _changes(member: DemoMember, at: datetime) -> tuple[ParameterMove, ...]:
    """The drifts, jumps and service adjustments of the unit up to a time."""
    years = (at - START) / YEAR
    drifted = tuple(
        replace(drift.change, amount=drift.change.amount * (min(years, drift.ends) / YEARS) ** drift.power)
        for drift in member.drifts
    )
    jumped = tuple(jump.change for jump in member.jumps if jump.at <= years)
    return drifted + jumped + tuple(c for service in member.services if service.at <= at for c in service.changes)


def _roughness(member: DemoMember, number: int) -> float:
    """Factor on the reading noise of one session."""
    return member.noise.get(number, member.noise.get(number - member.sessions, 1.0))


def _measured(
    member: DemoMember, at: datetime, truth: SensorParameters, noise: float, rng: np.random.Generator
) -> CalibrationSession:
    """The member on one of the stands."""
    stand, positions = STANDS[rng.integers(len(STANDS))], POSITIONS[rng.integers(len(POSITIONS))]
    elevation = STEEP_DEG if stand == ECCENTRIC_STAND and positions == POSITIONS[0] else ELEVATION_DEG
    schedule = schedule_of(member.kind, SENSORS, stand, elevation, positions)
    rows = len(schedule.readings)
    schedule = replace(
        schedule,
        unit=member.serial,
        unit_type=TYPE_NAME[member.kind],
        operator=OPERATORS[rng.integers(len(OPERATORS))],
        notes=NOTES,
        temperature=np.round(21.0 + 0.3 * rng.standard_normal() + 0.02 * np.sqrt(np.arange(rows)), 2),
    )
    seated = _turned(truth) if stand == TURNED_STAND and at >= TURNED_AT else truth
    stated = schedule.beta
    assert stated is not None
    measured = simulate(replace(schedule, beta=stated + _off(stand, stated)), seated, rng, noise=noise)
    readings = measured.readings + (_bent(measured, truth) if member.kind == ACCELEROMETER else 0.0)
    return replace(measured, beta=stated, readings=readings)


def _off(stand: str, beta: Array) -> Array:
    """(R,) rad, by which the head truly stands further than its scale says."""
    if stand == ECCENTRIC_STAND:
        return ECCENTRICITY[0] * np.cos(beta) + ECCENTRICITY[1] * np.sin(beta)
    return WAVE * np.sin(3 * beta) if stand == WAVY_STAND else np.zeros_like(beta)


def _bent(session: CalibrationSession, truth: SensorParameters) -> Array:
    """(R, m) reading units: the cubic term that all accelerometers of the type have."""
    return np.asarray(truth.scale * CUBIC * (session.readings / truth.scale) ** 3)


def _turned(truth: SensorParameters) -> SensorParameters:
    """The block on the stand whose seat has turned."""
    return replace(truth, axis=unit(truth.axis + np.cross(TURN, truth.axis)))
