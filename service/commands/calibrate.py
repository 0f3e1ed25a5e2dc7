"""`imu-health calibrate`: session files to calibrations, without a server."""

from pathlib import Path

from estimator import Calibration, CalibrationSession, calibrate
from service.commands.console import AsJson, Files, for_each, print_json, screen
from service.commands.tables import calibration_view
from service.ingest import read_file

Result = tuple[CalibrationSession, Calibration]


def calibrate_files(files: Files, as_json: AsJson = False) -> None:
    """Calibrate session files: scale factor, bias, quadratic term and axis of every sensor, with uncertainties."""
    for_each(files, _calibrated, _print_json if as_json else _print_table, "calibrating", quiet=as_json)


def _calibrated(file: Path) -> Result:
    session = read_file(file)
    return session, calibrate(session)


def _print_json(result: Result) -> None:
    print_json(result[1].to_dict())


def _print_table(result: Result) -> None:
    screen().print(calibration_view(*result))
