"""The one door to every programme: a session, whatever it is, to the calibration that its programme gives."""

from dataclasses import replace
from typing import TYPE_CHECKING

from estimator.calibration import calibrate as calibrate_block
from estimator.on_demand import function_on_demand
from estimator.results import Calibration
from estimator.session import RATE_TABLE, ROTATION_ALIGNMENT, THERMAL, CalibrationSession

if TYPE_CHECKING:
    from estimator.alignment import align, rate_table
    from estimator.alignment.as_calibration import alignment_calibration, rate_table_calibration
    from estimator.thermal import calibrate_thermal
else:
    align = function_on_demand("estimator.alignment", "align")
    rate_table = function_on_demand("estimator.alignment", "rate_table")
    alignment_calibration = function_on_demand("estimator.alignment.as_calibration", "alignment_calibration")
    rate_table_calibration = function_on_demand("estimator.alignment.as_calibration", "rate_table_calibration")
    calibrate_thermal = function_on_demand("estimator.thermal", "calibrate_thermal")


def calibrate(session: CalibrationSession, *, quadratic: bool | None = None) -> Calibration:
    """Calibrates a session by its programme.

    Parameters
    ----------
    session : of any programme. Calibrations give every sensor's parameters; an alignment or a rate table gives biases
        and mounting errors of the block's axes; raw logs are averaged first.
    quadratic : whether arbitrary orientations estimate the second-order term; None lets the orientations decide.

    Raises
    ------
    ScheduleError : the rows cannot support the programme.
    """
    if session.programme == ROTATION_ALIGNMENT:
        return replace(alignment_calibration(align(session)), screening=session.screening)
    if session.programme == RATE_TABLE:
        return replace(rate_table_calibration(rate_table(session)), screening=session.screening)
    if session.programme == THERMAL:
        return calibrate_thermal(session, quadratic=quadratic)
    return calibrate_block(session, quadratic=quadratic)
