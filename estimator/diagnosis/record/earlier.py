"""An earlier session of a unit, fitted for itself."""

from estimator.calibration.calibrate import averaged
from estimator.causes.contract import Cause
from estimator.content import remembered
from estimator.diagnosis.record.clipping import unclipped
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.session import CalibrationSession


@remembered
def earlier_baseline(session: CalibrationSession, catalogue: tuple[Cause, ...]) -> Baseline:
    """The baseline of an earlier session, without its clipped readings.

    Raises
    ------
    ScheduleError : the session cannot be calibrated at all.
    """
    return baseline_of(unclipped(averaged(session), catalogue)[1])
