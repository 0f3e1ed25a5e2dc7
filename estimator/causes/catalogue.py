"""The catalogue: every cause the diagnosis knows. Adding a cause is one class and one line here.

Where two causes leave the very same trace the earlier one is named first: what only gyros have stands before what all
blocks have.
"""

from estimator.causes import environment, fixture, gyro, lag, record, sensor, shared, stand, turntable, vibration
from estimator.causes.contract import Cause
from estimator.causes.sensor import ExcessNoise

CATALOGUE: tuple[Cause, ...] = (
    gyro.GSensitivity(),
    gyro.LatitudeEntry(),
    gyro.OffMeridian(),
    sensor.CubicNonlinearity(),
    sensor.ScaleAsymmetry(),
    sensor.CrossCoupling(),
    environment.BiasTemperature(),
    environment.ScaleTemperature(),
    environment.BiasRamp(),
    environment.WarmUp(),
    environment.BiasJump(),
    sensor.Hysteresis(),
    sensor.Saturation(),
    sensor.OddQuadratic(),
    sensor.BiasAsymmetry(),
    sensor.CrossAxisQuadratic(),
    environment.ScaleRamp(),
    environment.AxisCreep(),
    environment.TemperatureRate(),
    lag.ThermalLag(),
    environment.BiasTemperatureCurve(),
    environment.ScaleTemperatureCurve(),
    vibration.VibrationRectification(),
    sensor.BiasPerPosition(),
    sensor.ReadingOutlier(),
    ExcessNoise(),
    stand.BetaEccentricity(),
    stand.BetaSecondHarmonic(),
    stand.BetaScale(),
    stand.AxisWobble(),
    stand.LevellingY(),
    stand.AlphaShift(),
    fixture.FlipMisalignment(),
    stand.StandDrift(),
    record.PositionsSwapped(),
    record.ChannelsSwapped(),
    record.SignReversed(),
    record.RunsSwapped(),
    record.BetaReversed(),
    record.AlphaEntry(),
    record.GravityEntry(),
    record.SensorDrift(),
    fixture.RemountRotation(),
)

ON_TURNTABLE: tuple[Cause, ...] = (turntable.LeverArm(),)
"""Causes that are looked for in alignments; `CATALOGUE` in calibrations."""
OF_SEVERAL: tuple[Cause, ...] = (shared.SharedCourse(),)
"""Causes that only several sensors together show."""
UNEXPLAINED = "unexplained"


def find(identifier: str) -> Cause | None:
    """The cause called ``identifier``; None where the catalogue holds none, as of a result of another version."""
    return next((c for c in (*CATALOGUE, *ON_TURNTABLE, *OF_SEVERAL) if c.identifier == identifier), None)


def cause(identifier: str) -> Cause:
    """The cause called ``identifier``; KeyError if the catalogue holds none."""
    return {c.identifier: c for c in (*CATALOGUE, *ON_TURNTABLE, *OF_SEVERAL)}[identifier]
