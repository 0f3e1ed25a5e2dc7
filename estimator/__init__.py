"""Estimation for redundant inertial measurement units: calibration, simulation, judgement.

This page is the one place that fixes frames, units, signs and symbols. Nothing else defines them.

Units
-----
Everything inside is SI: m/s², rad, rad/s, s; temperature in °C (a difference of 1 °C is 1 K).
People see µg, ppm, arcsec, °/h, µg/g²; those are made at the edge (files, pages, reports).

Frames
------
level     Z up, X the stand's tilt axis, Y level and orthogonal to X.
platform  Y along the rotation axis of the head, raised by α above the horizon.
block     axes of the unit's mounting bases; what axis orientation is reported in.
          ``mounting`` (3×3) takes platform components to block components: v_block = mounting · v_platform.

A two-axis-stand session has two runs: *direct*, and *flipped*, with the block turned 180° about the platform's
Z axis, so that in platform axes the input axis e becomes e* = (−e₁, −e₂, e₃). Here the block is left alone and the
applied vector is turned instead, F·n with F = diag(−1, −1, 1): the same products, one set of axes.

Applied vectors, platform axes, β counted from 0
------------------------------------------------
specific force at rest   n(α, β) = g·(−cos α sin β, sin α, cos α cos β)
Earth rate               ω(χ, β) = Ω·(−cos χ sin β, sin χ, cos χ cos β)
Stand errors, constant over a session: θ_x, θ_y (levelling), δα. To first order θ_x + δα raises α, and θ_y is a
constant β offset of −θ_y/cos α. δβ is drawn anew at every row. All act on n: they are common to all sensors.

Sensor model (baseline), sensor i, row j
----------------------------------------
u = K·(a + b + c·a²) + noise,  a = e·n
K  scale      reading unit per m/s² (per rad/s); a pulse gyro: pulses per rad
b  bias       m/s² (rad/s), at the input
c  quadratic  s²/m (s/rad)
e  axis       unit vector of the input axis, block axes

Array axes
----------
S sessions of one schedule, R rows (readings in the order measured), m sensors, P parameters.
Readings are (R, m); applied vectors (R, m, 3), because accelerometers and gyros of one block see different ones.
A parameter vector holds five elements a sensor, sensor after sensor: scale, bias, quadratic, axis_1, axis_2; the
last two are rotations of the axis along the two tangent vectors that the result states.
"""

from typing import TYPE_CHECKING

from estimator.on_demand import names_on_demand

if TYPE_CHECKING:
    from estimator.alignment import AlignmentResult, RateTableResult, align, rate_table
    from estimator.calibration import calibrate_many
    from estimator.diagnosis import Diagnosis, calibrate_extended
    from estimator.errors import FormatError, Problem, ScheduleError, SessionError
    from estimator.groups import (
        GroupDiagnosis,
        SessionStatistics,
        diagnose,
        diagnose_group,
        diagnose_statistics,
        statistics_of,
    )
    from estimator.parity import ParityAccumulator, ParityResult, parity_check
    from estimator.programmes import calibrate
    from estimator.reading import read_session
    from estimator.results import Calibration
    from estimator.session import CalibrationSession, Sensor, Site, Stand, StandErrors
else:
    __getattr__ = names_on_demand(
        __name__,
        {
            "alignment": "AlignmentResult RateTableResult align rate_table",
            "calibration": "calibrate_many",
            "diagnosis": "Diagnosis calibrate_extended",
            "errors": "FormatError Problem ScheduleError SessionError",
            "groups": "GroupDiagnosis SessionStatistics diagnose diagnose_group diagnose_statistics statistics_of",
            "parity": "ParityAccumulator ParityResult parity_check",
            "programmes": "calibrate",
            "reading": "read_session",
            "results": "Calibration",
            "session": "CalibrationSession Sensor Site Stand StandErrors",
        },
    )

__all__ = [
    "AlignmentResult",
    "Calibration",
    "CalibrationSession",
    "Diagnosis",
    "FormatError",
    "GroupDiagnosis",
    "ParityAccumulator",
    "ParityResult",
    "Problem",
    "RateTableResult",
    "ScheduleError",
    "Sensor",
    "SessionError",
    "SessionStatistics",
    "Site",
    "Stand",
    "StandErrors",
    "align",
    "calibrate",
    "calibrate_extended",
    "calibrate_many",
    "diagnose",
    "diagnose_group",
    "diagnose_statistics",
    "parity_check",
    "rate_table",
    "read_session",
    "statistics_of",
]
