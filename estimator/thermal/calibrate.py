"""The thermal programme: a block held still in orientations, known or not, at temperatures over its range.

Every sensor's bias and scale factor become curves over temperature (`estimator.curves`); axes and quadratic terms are
constant. At the reference temperature the result is a calibration like every other.
"""

from dataclasses import replace

import numpy as np

from estimator.calibration.calibrate import averaged
from estimator.calibration.free.optional import USEFUL_QUADRATIC
from estimator.results import Calibration
from estimator.session import CORRECTED, CalibrationSession
from estimator.thermal.begin import Begun, begin
from estimator.thermal.orders import Orders, orders_of
from estimator.thermal.report import ratio_of, result
from estimator.thermal.solve import ThermalFit, is_determined, search_with_noise
from estimator.thermal.structure import with_forms


def calibrate_thermal(session: CalibrationSession, *, quadratic: bool | None = None) -> Calibration:
    """The calibration at the reference temperature, with the curves over temperature.

    Parameters
    ----------
    session : of the thermal programme; a raw log is averaged over its rests first.
    quadratic : whether the second-order term is estimated; None: where the rows tell every one to 100 µg/g².

    Raises
    ------
    ScheduleError : no temperatures, too narrow a range, or orientations that do not determine every curve.
    """
    begun = begin(averaged(session, CORRECTED))
    solved, forms = with_forms(widest(begun, quadratic), begun.course, begun.order, stated=begun.stated)
    orders = orders_of(solved, begun.order, ratio_of(solved, stated=begun.stated))
    return result(begun, of_orders(begun, solved, orders), orders, forms)


def widest(begun: Begun, quadratic: bool | None) -> ThermalFit:
    """The fit with polynomials of highest order."""
    live, with_terms = ~begun.rows.gyro, begun.free(quadratic=True)
    if quadratic is not False and live.any() and is_determined(begun.rows, begun.state, with_terms):
        solved = search_with_noise(begun.rows, begun.state, with_terms, stated=begun.stated)
        variance = np.diagonal(solved.covariance).reshape(with_terms.shape)[live, -3]
        if quadratic or np.all(variance * ratio_of(solved, stated=begun.stated) < USEFUL_QUADRATIC**2):
            return solved
    return search_with_noise(begun.rows, begun.state, begun.free(quadratic=False), stated=begun.stated)


def of_orders(begun: Begun, solved: ThermalFit, orders: Orders) -> ThermalFit:
    """The fit without the terms that the readings do not ask for."""
    q, state, gyro = begun.order + 1, solved.state, solved.rows.gyro
    state = replace(
        state,
        scale=np.where(orders.free[:, :q] | gyro[:, None], state.scale, 0.0),
        bias=np.where(orders.free[:, q:-3], state.bias, 0.0),
    )
    return search_with_noise(solved.rows, state, orders.free, stated=begun.stated)
