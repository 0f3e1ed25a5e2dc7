"""Questions of planning: a block on a cone or a stored type, a stand, tolerances, in practical units."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field

from estimator.planning import Request, ToleranceSet
from estimator.readiness import Allowed, Question
from estimator.readiness.question import USUAL
from estimator.results import ARCSEC
from estimator.session import ACCELEROMETER, GYROSCOPE, Array, CalibrationSession, Sensor, Site, Stand, StandErrors
from estimator.simulate import cone, stand_schedule
from service.kit.measures import MEASURES
from service.web.fields import Sought

HALF_ANGLE = float(np.arccos(1 / np.sqrt(3)))
"""54.7°: three of the axes are orthogonal."""
NOISE = {ACCELEROMETER: 2.5, GYROSCOPE: 0.002}
"""µg, °/h where none is stated: the quantisation of 0.6″ a pulse over 100 s for gyros."""
VARIATION = {ACCELEROMETER: 6.7, GYROSCOPE: 0.0133}
"""µg, °/h: of the published block, one sigma."""
SCALE = {ACCELEROMETER: 0.12, GYROSCOPE: 1 / (0.6 * ARCSEC)}
"""V per m/s²; pulses per rad at 0.6″ a pulse: of the published block."""
COUNT_TIME = 100.0
"""s, over which the pulses of a reading are counted."""
COUNT_TIME_SIGMA = 1e-5
"""s, one sigma."""
GYRO_STAND = (1.0, 5.0)
"""arcsec: errors of latitude and meridian."""


def blank(value: object) -> object:
    """An empty field of a form is unset."""
    return None if value == "" else value


LEAST, LARGEST = 1e-9, 1e9
"""Bounds of every amount in practical units: far beyond any instrument, and far from the limits of floating point."""


def _zero_below_least(value: float) -> float:
    """Zero for an error below any stand's."""
    return value if value >= LEAST else 0.0


Positive = Annotated[float, Field(ge=LEAST, le=LARGEST, allow_inf_nan=False)]
Amount = Annotated[Positive | None, BeforeValidator(blank)]
Elevation = Annotated[float, Field(ge=1, le=89, allow_inf_nan=False)]
Positions = Annotated[int, Field(ge=3, le=72)]
Arcsec = Annotated[float, Field(ge=0, le=3600, allow_inf_nan=False), AfterValidator(_zero_below_least)]


class PlanQuestion(BaseModel):
    """The question; an omitted amount is proposed, taken from the block, or not judged."""

    model_config = ConfigDict(frozen=True)

    unit_type: Annotated[Sought | None, BeforeValidator(blank)] = Field(
        None, description="A stored unit type whose sensors and tolerances are planned with, instead of a cone."
    )
    kind: Literal["accelerometer", "gyroscope"] = Field(
        "accelerometer", description="Without a unit type: what the cone holds."
    )
    sensors: Annotated[int, Field(ge=3, le=12)] = Field(
        6, description="Sensors on the cone of 54.7° about the head's axis."
    )
    latitude: Annotated[float, Field(ge=-90, le=90, allow_inf_nan=False)] = Field(
        55.81, description="Latitude of the stand, degrees."
    )
    theta: Arcsec = Field(0.33, description="Levelling error, one sigma, arcsec.")
    alpha_error: Arcsec = Field(1.0, description="Error of the elevation, one sigma, arcsec.")
    beta_error: Arcsec = Field(1.0, description="Error of the turn β, one sigma, arcsec.")
    noise: Amount = Field(None, description="Noise of a reading, one sigma, µg (gyros: °/h).")
    variation: Amount = Field(
        None, description="Variation of the bias from position to position, one sigma, µg (gyros: °/h)."
    )
    elevation: Annotated[Elevation | None, BeforeValidator(blank)] = Field(
        None, description="Elevation of the head's axis, degrees; proposed where left out."
    )
    positions: Annotated[Positions | None, BeforeValidator(blank)] = Field(
        None, description="Positions a run; proposed where left out."
    )
    runs: Literal["both", "direct"] = Field("both", description="Both runs, or the direct one only.")
    minutes: Annotated[float, Field(ge=0.001, le=1440, allow_inf_nan=False)] = Field(
        2.0, description="Time that a position takes, minutes."
    )
    scale: Amount = Field(
        None, description="Tolerance of the scale factor, ppm; that of the unit type, or not judged, where left out."
    )
    bias: Amount = Field(None, description="Tolerance of the bias, µg (gyros: °/h).")
    quadratic: Amount = Field(None, description="Tolerance of the quadratic term, µg/g² (gyros: not judged).")
    axis: Amount = Field(None, description="Tolerance of the input axis, arcsec.")

    def request(self, kind: str) -> Request:
        """The request for blocks whose elevation is that of ``kind``."""
        return Request(
            elevation=None if self.elevation is None else float(np.radians(self.elevation)),
            positions=self.positions,
            runs=(False, True) if self.runs == "both" else (False,),
            wanted=self.wanted(kind),
            time_per_position=60 * self.minutes,
        )

    def wanted(self, kind: str) -> ToleranceSet:
        """The tolerances in SI."""

        def si(parameter: str) -> float | None:
            value: float | None = getattr(self, parameter)
            return None if value is None else value / MEASURES[kind, parameter].factor

        return ToleranceSet(si("scale"), si("bias"), si("quadratic"), si("axis"))

    def cone(self) -> CalibrationSession:
        """Equal sensors on a cone of 54.7° about the head's axis."""
        letter = "A" if self.kind == ACCELEROMETER else "G"
        unit = "V" if self.kind == ACCELEROMETER else "pulse"
        axes = cone(self.sensors, HALF_ANGLE)
        return self.block(
            tuple(Sensor(f"{letter}{i + 1}", self.kind, e, SCALE[self.kind], unit) for i, e in enumerate(axes))
        )

    def block(self, sensors: tuple[Sensor, ...]) -> CalibrationSession:
        """A schedule for sensors on the stand of the question."""
        site = Site(latitude=float(np.radians(self.latitude)))
        gyro = any(s.kind == GYROSCOPE for s in sensors)
        angle = float(np.radians(40.0))
        stand = Stand("planned", alpha=angle, chi=angle if gyro else None, sigma=self.stand_errors(gyro))
        repeatable = tuple(replace(s, bias_repeatability=self.spread(s.kind)) for s in sensors)
        return stand_schedule(repeatable, stand, site, 24, count_time=COUNT_TIME if gyro else None)

    def stand_errors(self, gyro: bool) -> StandErrors:
        """One sigmas in SI; latitude, meridian and count time act on gyros only."""
        theta, latitude, meridian = (x * ARCSEC for x in (self.theta, *GYRO_STAND))
        errors = StandErrors(theta, theta, self.alpha_error * ARCSEC, self.beta_error * ARCSEC)
        return replace(errors, latitude=latitude, meridian=meridian, count_time=COUNT_TIME_SIGMA) if gyro else errors

    def spread(self, kind: str) -> float:
        """Variation of the bias, SI."""
        stated = VARIATION[kind] if self.variation is None else self.variation
        return stated / MEASURES[kind, "bias"].factor

    def sigma(self, like: CalibrationSession) -> Array:
        """(m,) one sigma of a reading at the input, variation of the bias included."""
        noise = np.array([self._noise(s.kind) for s in like.sensors])
        return np.asarray(np.hypot(noise, [s.bias_repeatability for s in like.sensors]))

    def _noise(self, kind: str) -> float:
        stated = NOISE[kind] if self.noise is None else self.noise
        return stated / MEASURES[kind, "bias"].factor


MINUTE = 60.0
"""Seconds in a minute."""


class ReadyQuestion(BaseModel):
    """The question; omitted values are the unit type's, or the defaults."""

    model_config = ConfigDict(frozen=True)

    minutes: Annotated[Annotated[float, Field(ge=1, le=1440, allow_inf_nan=False)] | None, BeforeValidator(blank)] = (
        Field(None, description="How long the measurement will take, minutes; as the last session of the unit or type.")
    )
    unit_type: Annotated[Sought | None, BeforeValidator(blank)] = Field(
        None, description="A stored unit type by whose tolerances is judged; without it the one of the file's unit."
    )
    bias: Amount = Field(None, description="Tolerance of the bias, µg (gyros: °/h), instead of the type's.")
    scale: Amount = Field(None, description="Tolerance of the scale factor, ppm, instead of the type's.")
    coefficient: Amount = Field(
        None, description="Temperature coefficient of the biases at most, µg/K (gyros: °/h/K); without it none is used."
    )

    def question(self, kind: str, tolerances: Mapping[tuple[str, str], float], usual: float | None) -> Question:
        """The question in SI, for a record whose leading sensors are of a kind; ``usual``: usual duration of such
        sessions, s.
        """
        overrides = {
            name: getattr(self, name) / MEASURES[kind, name].factor for name in ("bias", "scale") if getattr(self, name)
        }
        limits = {
            (k, name): overrides.get(name, tolerance) if k == kind else tolerance
            for (k, name), tolerance in tolerances.items()
        }
        limits |= {(kind, name): tolerance for name, tolerance in overrides.items()}
        allowed = {
            k: Allowed(limits.get((k, "bias")), limits.get((k, "scale")), limits.get((k, "quadratic")))
            for k in (ACCELEROMETER, GYROSCOPE)
        }
        slope = None if self.coefficient is None else {kind: self.coefficient / MEASURES[kind, "bias"].factor}
        return Question(allowed, MINUTE * self.minutes if self.minutes else usual or USUAL, coefficient=slope)
