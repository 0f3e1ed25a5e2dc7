"""The sessions on which every calibrator is held to the same contract, and their Monte Carlo trials."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

from estimator import Calibration, CalibrationSession, Sensor, Site, Stand, StandErrors, calibrate_many
from estimator.parameters import SensorParameters
from estimator.session import ACCELEROMETER, GYROSCOPE, TWO_AXIS_STAND, Array
from estimator.simulate import cone, orientation_schedule, scattered, simulate, stand_schedule
from tests.builders import ARCSEC, CONE_HALF_ANGLE, EARTH_RATE, GRAVITY

SITE = Site(latitude=np.radians(55.81), height=160.0, gravity=GRAVITY)
ERRORS = StandErrors(
    theta_x=ARCSEC / 3,
    theta_y=ARCSEC / 3,
    alpha=ARCSEC,
    beta=ARCSEC,
    latitude=ARCSEC,
    meridian=20 * ARCSEC,
    count_time=1e-5,
)
STAND = Stand("ODG-1", alpha=np.radians(40.0), chi=np.radians(39.0), sigma=ERRORS)
FIXTURE = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""The paper's mounting (10)."""


def accelerometers(m: int = 6, **own: object) -> tuple[Sensor, ...]:
    """A cone of accelerometers in volts, zero repeatable to 2e-5 g (3σ)."""
    axes = cone(m, CONE_HALF_ANGLE)
    made = [Sensor(f"A{i + 1}", ACCELEROMETER, axes[i], 0.12, "V", 6.5e-5) for i in range(m)]
    return tuple(replace(sensor, **own) for sensor in made)


def gyros(m: int = 6, scale: float = 1 / (0.6 * ARCSEC), unit: str = "pulse") -> tuple[Sensor, ...]:
    """A cone of gyros, zero repeatable to 0.04 °/h (3σ); the default counts pulses of 0.6″."""
    axes = cone(m, CONE_HALF_ANGLE)
    return tuple(Sensor(f"G{i + 1}", GYROSCOPE, axes[i], scale, unit, 6.5e-8) for i in range(m))


@dataclass(frozen=True, eq=False)
class Case:
    """One schedule, the sensors' truth and noise, and how many sessions its Monte Carlo takes."""

    name: str
    schedule: CalibrationSession
    noise: Array
    """(m,) one sigma of a reading, reading units."""
    sessions: int = 600
    quadratic: float = 1e-5

    @property
    def norm(self) -> Array:
        """(m,) length of the applied vector."""
        return np.array([GRAVITY if s.kind == ACCELEROMETER else EARTH_RATE for s in self.schedule.sensors])

    @cached_property
    def truth(self) -> SensorParameters:
        """(m,) scattered about the nominal values; without a net turn of the axes where only they hold the frame."""
        rng = np.random.default_rng(7)
        found = scattered(self.schedule.sensors, self.norm, rng, quadratic=self.quadratic)
        if self.on_stand:
            return found
        nominal = np.stack([s.nominal_axis for s in self.schedule.sensors])
        return replace(found, axis=Rotation.align_vectors(nominal, found.axis)[0].apply(found.axis))

    @property
    def on_stand(self) -> bool:
        """Whether the stand holds the frame."""
        return self.schedule.programme == TWO_AXIS_STAND

    def simulated(self, count: int, seed: int = 1) -> list[CalibrationSession]:
        """Measured sessions, each with its own stand errors and noise."""
        rng = np.random.default_rng(seed)
        return [simulate(self.schedule, self.truth, rng, noise=self.noise) for _ in range(count)]

    def trials(self) -> "Trials":
        """The Monte Carlo of this case, without the calibrations: a thousand take 60 MB."""
        results = calibrate_many(self.simulated(self.sessions))
        seen = np.isfinite(np.diagonal(results[0].covariance))
        return Trials(
            errors=np.stack([errors(r, self.truth) for r in results])[:, seen],
            covariance=np.stack([r.covariance for r in results])[:, seen][:, :, seen],
            p_values=np.array([r.fit.p_value for r in results]),
            converged=all(r.fit.converged for r in results),
            seen=seen,
        )


@dataclass(frozen=True, eq=False)
class Trials:
    """Calibrations of many simulated sessions. n sessions, p observed elements of P."""

    errors: Array
    """(n, p) estimate minus truth, SI."""
    covariance: Array
    """(n, p, p) covariance as stated."""
    p_values: Array
    """(n,) p-values of the fits."""
    converged: bool
    """All of them."""
    seen: Array
    """(P,) bool."""


def estimates(result: Calibration) -> SensorParameters:
    """(m,) values; NaN where not observable."""

    def column(element: str) -> Array:
        return np.array([getattr(s, element).value for s in result.sensors], dtype=float)

    axes = np.stack([np.full(3, np.nan) if s.axis is None else s.axis for s in result.sensors])
    return SensorParameters(column("scale"), column("bias"), column("quadratic"), axes)


def errors(result: Calibration, truth: SensorParameters) -> Array:
    """(P,) estimate minus truth in the order of the covariance, SI; NaN where not observable."""
    found = estimates(result)
    frames = np.stack([s.axis_tangents for s in result.sensors])
    turned = ((found.axis - truth.axis)[:, None] @ frames)[:, 0]
    plain = [found.scale - truth.scale, found.bias - truth.bias, found.quadratic - truth.quadratic]
    return np.column_stack([*plain, turned]).ravel()


def at_rows(schedule: CalibrationSession, rows: Array) -> CalibrationSession:
    """The schedule with its rows picked, in that order."""
    columns = ("readings", "standard_errors", "flipped", "beta", "time", "temperature", "directions")
    picked = {name: getattr(schedule, name) for name in columns}
    return replace(schedule, **{name: column[rows] for name, column in picked.items() if column is not None})


def block(sensors: tuple[Sensor, ...], positions: int = 12, **how: object) -> CalibrationSession:
    """A schedule on the stand in the paper's fixture."""
    return stand_schedule(sensors, STAND, SITE, positions, **({"mounting": FIXTURE} | how))


def unequal() -> CalibrationSession:
    """Two runs over steps that are neither equal nor the same."""
    schedule = block(accelerometers(), 13)
    beta = np.sort(np.random.default_rng(3).uniform(0, 2 * np.pi, 26))
    return replace(schedule, beta=np.random.default_rng(4).permutation(beta))


def mixed() -> CalibrationSession:
    """Three accelerometers in raw counts about half the converter's range, and three pulse gyros."""
    counts = accelerometers(3, nominal_scale=1670.0, nominal_offset=32768.0, reading_unit="count")
    return block((*counts, *gyros(3)), count_time=100.0)


def sphere(count: int) -> Array:
    """(count, 3) directions drawn evenly, dimensionless."""
    v = np.random.default_rng(5).standard_normal((count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


VOLTS, PULSES = 3e-6, 1.0
GAPS = [0, 1, 2, 2, 2, 4, 5, 7, 9, 10, 11, 12, 13, 15, 16, 16, 18, 19, 20, 21, 23]

CASES: tuple[Case, ...] = (
    Case("stand", block(accelerometers(), 24), np.full(6, VOLTS)),
    Case("three-sensors", block(accelerometers(3)), np.full(3, VOLTS)),
    Case("48-sensors", block(accelerometers(48)), np.full(48, VOLTS), sessions=60),
    Case("gyro-rates", block(gyros(6, scale=1e4, unit="V")), np.full(6, 3e-4)),
    Case("gyro-pulses", block(gyros(), count_time=100.0), np.full(6, PULSES)),
    Case("mixed-counts", mixed(), np.array([0.05] * 3 + [PULSES] * 3)),
    Case("one-run", block(accelerometers(), 24, runs=(False,)), np.full(6, VOLTS), quadratic=1e-7),
    Case("unequal-steps", unequal(), np.full(6, VOLTS)),
    Case("missing-and-repeated", at_rows(block(accelerometers()), np.array(GAPS)), np.full(6, VOLTS)),
    Case(
        "shuffled-rows",
        at_rows(block(accelerometers()), np.random.default_rng(6).permutation(24)),
        np.full(6, VOLTS),
    ),
    Case(
        "arbitrary-orientations",
        orientation_schedule(accelerometers(4), SITE, sphere(24)),
        np.full(4, 10 * VOLTS),
        sessions=200,
        quadratic=0.0,
    ),
)
