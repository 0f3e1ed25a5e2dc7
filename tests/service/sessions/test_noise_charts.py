"""Bands beside residuals: the noise that the file states, and what the calibration reckons with where that is more."""

import json

import numpy as np
import pytest

from estimator import calibrate, read_session
from estimator.results import Calibration
from service.sessions.charts import noise_of, residual_charts
from service.sessions.words.readings import bands_in_words
from tests.builders import arbitrary_orientations
from tests.service.made_sessions import session_bytes


def calibrated(stated: float, **changes: object) -> Calibration:
    """A session whose file states so many times its true noise, on a stand whose β is exact."""
    document = json.loads(session_bytes()) | changes
    document["stand"]["sigma_arcsec"]["beta"] = 0.0
    for sensor in document["sensors"]:
        sensor.pop("bias_repeatability_m_s2", None)
        document["table"][f"{sensor['name']}_se"] = [3e-6 * stated] * len(document["table"]["run"])
    return calibrate(read_session(document))


@pytest.mark.parametrize("stated", [1.0, 0.2])
def test_the_band_is_the_stated_noise_whatever_the_readings_scatter(stated: float) -> None:
    found = calibrated(stated)
    noise = noise_of(found.residuals, found)
    np.testing.assert_allclose(noise.stated, stated * 3e-6 / 0.12, rtol=1e-3)


def test_noise_that_explains_the_readings_is_drawn_once() -> None:
    found = calibrated(1.0)
    assert noise_of(found.residuals, found).times is None
    assert bands_in_words(found, None) == "The band is ±2σ of the stated noise."
    assert len({len(one.spec["layer"]) for one in residual_charts(found)}) == 1


def test_noise_that_is_stated_five_times_too_small_is_drawn_beside_what_is_found() -> None:
    found = calibrated(0.2)
    times = noise_of(found.residuals, found).times
    assert times == pytest.approx(5.0, rel=0.1)
    assert "the dashed lines are ±2σ of the noise that the calibration uses" in bands_in_words(found, times)
    point = residual_charts(found)[0].panels[0].datasets["points"][0]
    assert point["found"] == pytest.approx(times * point["band"], rel=1e-3)
    assert len(residual_charts(found)[0].spec["layer"]) == len(residual_charts(calibrated(1.0))[0].spec["layer"]) + 2


def test_readings_outside_are_counted_against_the_stated_noise() -> None:
    described = residual_charts(calibrated(0.2))[0].panels[0].description
    outside = int(described.partition(", ")[2].split()[0])
    assert outside > 48 / 2


def test_estimated_noise_is_not_called_stated() -> None:
    found = calibrate(read_session(arbitrary_orientations(se=None)))
    assert bands_in_words(found, None).startswith("The file does not state all noise")


def test_what_rounding_leaves_of_a_fit_through_every_reading_is_nothing() -> None:
    found = calibrate(read_session(arbitrary_orientations(3, orientations=9, se=None)))
    (drawn,) = residual_charts(found)
    assert {panel.description for panel in drawn.panels} == {"rms 0\u202fµg"}
