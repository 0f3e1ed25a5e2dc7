"""The one door to every calibrator."""

from typing import TYPE_CHECKING

from estimator.calibration.cut_off import require_whole_range
from estimator.calibration.gross import without_gross
from estimator.calibration.stand import calibrate_stand
from estimator.errors import ScheduleError, problem_at
from estimator.on_demand import function_on_demand
from estimator.results import Calibration
from estimator.session import CALIBRATIONS, IN_SERVICE, TWO_AXIS_STAND, CalibrationSession

if TYPE_CHECKING:
    from estimator.calibration.free import calibrate_free, residual_per_freedom, tilt_response
    from estimator.static import average
else:
    average = function_on_demand("estimator.static", "average")
    calibrate_free = function_on_demand("estimator.calibration.free", "calibrate_free")
    residual_per_freedom = function_on_demand("estimator.calibration.free", "residual_per_freedom")
    tilt_response = function_on_demand("estimator.calibration.free", "tilt_response")


def calibrate(session: CalibrationSession, *, quadratic: bool | None = None) -> Calibration:
    """Calibrate a block from one session.

    Parameters
    ----------
    session : of any programme that calibrates; a raw log is averaged over its positions first.
    quadratic : whether arbitrary orientations estimate the second-order term; None lets the orientations decide.

    Raises
    ------
    ScheduleError : the programme does not calibrate, or its rows cannot support it.
    """
    rows = averaged(session)
    if session.programme == TWO_AXIS_STAND:
        return calibrate_stand([rows])[0]
    return calibrate_free(rows, quadratic=quadratic)


def averaged(session: CalibrationSession, programmes: tuple[str, ...] = CALIBRATIONS) -> CalibrationSession:
    """The session with one row a position, gross readings set aside; ScheduleError as `as_it_came`."""
    [rows] = without_gross([as_it_came(session, programmes)])
    if session.programme != TWO_AXIS_STAND:
        require_whole_range(rows)
    return rows


def as_it_came(session: CalibrationSession, programmes: tuple[str, ...] = CALIBRATIONS) -> CalibrationSession:
    """The session with one row a position; ScheduleError where its programme is none of those that calibrate."""
    if session.programme not in programmes:
        hint = "; compare it with a calibration: imu-health parity" if session.programme == IN_SERVICE else ""
        raise ScheduleError(
            [
                problem_at(
                    "programme", "{programme} does not calibrate a block{hint}", programme=session.programme, hint=hint
                )
            ]
        )
    return average(session, residual_per_freedom, tilt_response) if session.is_raw else session
