"""Step: a checked session → its calibration under the model in force.

A recording in service has none of its own: it is compared with its unit's calibration, which is moved by the change
that the recording shows.
"""

from dataclasses import dataclass, replace

from estimator.groups.fixed import calibrate_with
from estimator.parity import ParityResult, parity_check
from estimator.parity.as_calibration import parity_calibration
from estimator.programmes import calibrate as calibrate_baseline
from estimator.results import Calibration, Estimate, SensorCalibration
from estimator.session import CALIBRATIONS, IN_SERVICE, CalibrationSession
from service.ingest.checked import Checked
from service.judging.reference import calibration_to_compare_with
from service.kit.lock_order import outside_writing
from service.models.records import Model
from service.sessions.records import ALL_PARAMETERS, ParameterValue
from service.storage.queries import Store


@dataclass(frozen=True, eq=False)
class CalibrationBasis:
    """Stored basis of a session's calibration."""

    model: Model
    compared_with: Calibration | None
    """A recording in service: its unit's calibration; None for every other programme."""


@dataclass(frozen=True, eq=False)
class ReferenceComparison:
    """A recording in service beside the calibration that its unit's readings are corrected by."""

    reference: Calibration
    result: ParityResult
    started_at: str | None = None
    """Start of the recording, UTC; None where its file does not state it."""


@dataclass(frozen=True, eq=False)
class Calibrated:
    """A checked session with its calibration."""

    checked: Checked
    model: Model
    """Model of the calibration."""
    calibration: Calibration
    comparison: ReferenceComparison | None
    """Comparison of a recording in service; None for every other programme."""


def basis_of(store: Store, new: Checked, model: Model) -> CalibrationBasis:
    """The stored basis of a calibration under a model; ScheduleError for a recording of an uncalibrated unit."""
    is_recording = new.session.programme == IN_SERVICE
    return CalibrationBasis(model, calibration_to_compare_with(store, new) if is_recording else None)


@outside_writing
def calibrate(new: Checked, basis: CalibrationBasis) -> Calibrated:
    """The calibration of a session, computed without access to the store; SessionError where the session does not
    determine what its programme requires.
    """
    if basis.compared_with is None:
        return Calibrated(new, basis.model, _under(basis.model, new.session), None)
    found = ReferenceComparison(
        basis.compared_with, parity_check(new.session, basis.compared_with), new.session.started_at
    )
    moved = replace(parity_calibration(found.result, found.reference), screening=new.session.screening)
    return Calibrated(new, basis.model, moved, found)


def rests_on_model(programme: str) -> bool:
    """Whether accepted causes change the results of sessions of a programme: by their own fit, or by the calibration
    that they are compared with.
    """
    return programme in CALIBRATIONS or programme == IN_SERVICE


def _under(model: Model, session: CalibrationSession) -> Calibration:
    """The calibration under a model; where a session does not show one of its causes, without that cause."""
    if (model.causes or model.fixed) and session.programme in CALIBRATIONS:
        return calibrate_with(session, model.fixed, model.causes)
    return calibrate_baseline(session)


def parameter_values(calibration: Calibration) -> tuple[ParameterValue, ...]:
    """Every parameter that the session concerns; one that was not observed has neither value nor uncertainty."""
    return tuple(
        _value(index, sensor, parameter)
        for index, sensor in enumerate(calibration.sensors)
        for parameter in ALL_PARAMETERS
        if parameter in sensor.observable
    )


def _value(index: int, sensor: SensorCalibration, parameter: str) -> ParameterValue:
    if parameter == "axis":
        axis = None if sensor.axis is None else (float(sensor.axis[0]), float(sensor.axis[1]), float(sensor.axis[2]))
        return ParameterValue(sensor.name, index, sensor.kind, parameter, None, sensor.axis_sigma, axis)
    estimate: Estimate = getattr(sensor, parameter)
    return ParameterValue(sensor.name, index, sensor.kind, parameter, estimate.value, estimate.sigma, None)
