"""The session page's context."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.results import KnownCombination
from service.pages.session.pages import session_page
from service.sessions.words.readings import combination_in_words, fit_in_words
from tests.builders import Document, accelerometer_block, gyro_block
from tests.service.pages.records import session_report


def test_cell_shows_value_deviation_tolerance_and_verdict() -> None:
    reference = session_report().calibration
    page = session_page(session_report(accelerometer_block(seed=2), reference))
    bias = page.sensors[0].cells[1]
    assert bias.value.endswith("µg")
    assert "±" in bias.deviation
    assert bias.tolerance == "±50\u202fµg"
    assert bias.condition is not None


def test_scale_is_written_with_its_relative_uncertainty() -> None:
    scale = session_page(session_report()).sensors[0].cells[0]
    assert "V per g ±" in scale.value
    assert scale.value.endswith("ppm")


@pytest.mark.parametrize(
    ("document", "unit"), [(gyro_block(), "pulse/s per °/s"), (gyro_block(count_time_s=None), "V per °/s")]
)
def test_a_gyro_s_scale_is_in_what_it_is_read_in(document: Document, unit: str) -> None:
    scale = session_page(session_report(document)).sensors[0].cells[0]
    assert f"{unit} ±" in scale.value


def test_what_is_not_observable_is_said_with_what_is_known() -> None:
    page = session_page(session_report(accelerometer_block(runs=("direct",), positions=3)))
    unseen = [c.parameter for s in page.sensors for c in s.cells if not c.observable]
    assert unseen
    assert any(s.known for s in page.sensors)


def test_known_combination_is_written_in_peoples_units() -> None:
    g = 9.80665
    known = KnownCombination({"bias": 2.0, "quadratic": -g * g}, value=20e-6 * g, sigma=1e-6 * g)
    assert combination_in_words(known, "accelerometer") == "bias − 0.5 × quadratic = 10.0\u00a0±\u00a01.0\u202fµg"


def test_known_readings_are_written_per_g() -> None:
    g = 9.80665
    known = KnownCombination({"zero_reading": 0.5, "sensitivity_y": g, "quadratic_reading": 0.0}, 2.0, 0.005)
    assert combination_in_words(known, "accelerometer") == "0.5 × K·b + K·e_y = 2.000\u00a0±\u00a00.010"


@pytest.mark.parametrize(
    ("p", "says"), [(0.6, "explains"), (0.01, "larger than usual"), (1e-6, "more than"), (None, "no standard errors")]
)
def test_fit_is_judged_in_words(p: float | None, says: str) -> None:
    known = session_report().calibration
    calibration = replace(known, fit=replace(known.fit, p_value=p))
    assert says in fit_in_words(calibration).headline


@pytest.mark.parametrize(("dof", "says"), [(1, "for 1 degree of freedom;"), (2, "for 2 degrees of freedom;")])
def test_one_degree_of_freedom_is_said_as_one(dof: int, says: str) -> None:
    known = session_report().calibration
    assert says in fit_in_words(replace(known, fit=replace(known.fit, dof=dof))).detail


def test_enlarged_uncertainties_are_a_warning() -> None:
    known = session_report().calibration
    calibration = replace(known, fit=replace(known.fit, covariance_factor=4.0))
    assert any("multiplied by 2.00" in w for w in fit_in_words(calibration).warnings)


def test_orientations_that_are_missing_are_a_warning() -> None:
    known = session_report().calibration
    calibration = replace(known, fit=replace(known.fit, rank=29, add=((0.0, -0.6, 0.8),)))
    (warning,) = fit_in_words(calibration).warnings
    assert "29 of 30 parameters" in warning


def test_one_run_is_told_to_measure_the_other() -> None:
    known = session_report().calibration
    one_run = replace(known.residuals, flipped=np.zeros(24, dtype=bool))
    calibration = replace(known, fit=replace(known.fit, rank=29), residuals=one_run)
    assert fit_in_words(calibration).warnings[0].endswith("measure the same positions in the other run too.")


def test_residuals_are_charted_by_angle_and_in_order() -> None:
    page = session_page(session_report())
    assert [c.heading for c in page.charts] == ["By the angle β of the head", "In the order measured"]
    assert [len(c.panels) for c in page.charts] == [6, 6]
    assert len(page.residuals.rows) == 24
