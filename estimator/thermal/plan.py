"""Predicts the result of a thermal session before it is measured: curves of highest order with their bands.

The bands follow from the schedule and the noise; the readings, here simulated, hardly matter.
"""

import numpy as np

from estimator.parameters import nominal
from estimator.results import Calibration
from estimator.session import Array, CalibrationSession
from estimator.simulate import simulate
from estimator.thermal.begin import begin
from estimator.thermal.calibrate import widest
from estimator.thermal.orders import Orders
from estimator.thermal.report import result


def expected(schedule: CalibrationSession, noise: Array) -> Calibration:
    """The calibration to expect of a schedule still to be measured.

    Parameters
    ----------
    schedule : of the thermal programme, with directions.
    noise : (m,) one sigma of an averaged reading, reading units.

    Raises
    ------
    ScheduleError : the schedule does not determine curves.
    """
    measured = simulate(schedule, nominal(schedule.sensors), np.random.default_rng(0), noise=noise)
    begun = begin(measured)
    solved = widest(begun, quadratic=False)
    order = np.full((len(begun.at), 2), begun.order)
    (k, p) = solved.free.shape
    return result(begun, solved, Orders(order, solved.free, np.zeros((k, p, p))), ())
