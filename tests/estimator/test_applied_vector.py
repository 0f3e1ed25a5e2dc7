"""The vectors that a stand applies: golden figures from outside, and the exact stand against its linear errors."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import Site, StandErrors
from estimator.applied_vector import EARTH_RATE, gravity, stand_geometry, stand_vector
from estimator.session import ACCELEROMETER, CalibrationSession
from estimator.simulate import StandDraw, true_vectors
from tests.builders import ARCSEC, GRAVITY
from tests.estimator.calibration.bound import Happened, applied
from tests.estimator.calibration.cases import CASES, STAND, accelerometers, block

MIXED = next(case.schedule for case in CASES if case.name == "mixed-counts")


# Helmert's 1901 figures at the equator, 45° and the pole: 9.78030, 9.80616 and 9.83215 m/s² (Torge, Geodesy, on
# Helmert 1901: 978.030 Gal at the equator; flattening constants 0.005302 and 0.000007).
@pytest.mark.parametrize(("latitude_deg", "expected"), [(0.0, 9.78030), (45.0, 9.80616), (90.0, 9.83215)])
def test_gravity_at_sea_level(latitude_deg: float, expected: float) -> None:
    assert gravity(Site(latitude=np.radians(latitude_deg))) == pytest.approx(expected, abs=6e-6)


def test_gravity_falls_by_a_third_of_a_milligal_per_metre() -> None:
    here, above = (gravity(Site(latitude=0.9, height=h)) for h in (0.0, 1000.0))
    assert here - above == pytest.approx(3.086e-3, rel=1e-12)  # free air: 0.3086 mGal/m


def test_stated_gravity_is_used_as_it_is() -> None:
    assert gravity(Site(latitude=0.9, height=100.0, gravity=9.8)) == 9.8


def test_the_printed_formula_9_is_three_thousandths_of_g_wrong() -> None:
    phi = np.radians(55.8)
    printed = 9.78030 + 0.005302 * np.sin(phi) ** 2 - 0.000007 * np.sin(2 * phi) ** 2
    assert (gravity(Site(latitude=phi)) - printed) / 9.81 == pytest.approx(3.26e-3, abs=0.05e-3)


def test_reference_vector_without_errors() -> None:
    beta = np.array([0.0, np.pi / 2, np.pi])
    a = np.radians(40.0)
    expected = [
        [0, np.sin(a), np.cos(a)],
        [-np.cos(a), np.sin(a), 0],
        [0, np.sin(a), -np.cos(a)],
    ]
    assert np.allclose(stand_vector(a, beta), expected, atol=1e-15)


def test_levelling_is_a_constant_turn_of_beta() -> None:
    beta, a, tilt = np.linspace(0, 6, 7), np.radians(40.0), ARCSEC
    tilted = stand_vector(a, beta, StandErrors(theta_y=tilt))
    assert np.allclose(tilted, stand_vector(a, beta - tilt / np.cos(a)), atol=1e-10)


def test_flipped_run_sees_the_axis_turned_about_z() -> None:
    session = block(accelerometers(), mounting=np.eye(3))
    n = stand_geometry(session).n[:, 0]
    direct, flipped = n[:12], n[12:]
    e = np.array([0.3, 0.5, 0.8])
    assert np.allclose(flipped @ e, direct @ (e * [-1, -1, 1]), atol=1e-14)


@pytest.mark.parametrize("name", ["theta_x", "theta_y", "alpha", "latitude", "meridian"])
@pytest.mark.parametrize("kind", ["accelerometer", "gyroscope"])
def test_constant_errors_are_the_derivatives_of_a_chain_of_rotations(kind: str, name: str) -> None:
    sensor = next(i for i, s in enumerate(MIXED.sensors) if s.kind == kind)
    geometry = stand_geometry(MIXED)
    found = geometry.constant[geometry.constant_names.index(name), :, sensor]
    h = 1e-4
    numeric = (applied(MIXED, kind, Happened({name: h})) - applied(MIXED, kind, Happened({name: -h}))) / (2 * h)
    assert np.allclose(found, numeric, atol=1e-7 * geometry.norm[sensor])


def test_row_errors_are_the_derivative_by_beta() -> None:
    geometry, h = stand_geometry(MIXED), 1e-5
    ahead, behind = (stand_geometry(replace(MIXED, beta=MIXED.beta + s)).n for s in (h, -h))
    assert np.allclose(geometry.beta, (ahead - behind) / (2 * h), atol=1e-8)


def test_errors_of_the_count_time_stretch_what_pulse_gyros_see() -> None:
    geometry = stand_geometry(MIXED)
    stretched = geometry.constant[geometry.constant_names.index("count_time")]
    assert np.allclose(stretched[:, 3:], geometry.n[:, 3:] / 100.0)
    assert not stretched[:, :3].any()


def test_latitude_and_meridian_do_not_move_gravity() -> None:
    schedule: CalibrationSession = block(accelerometers())
    assert stand_geometry(schedule).constant_names == ("theta_x", "theta_y", "alpha")


def test_errors_of_zero_sigma_are_left_out() -> None:
    quiet = replace(block(accelerometers()), stand=replace(STAND, sigma=StandErrors(alpha=ARCSEC)))
    assert stand_geometry(quiet).constant_names == ("alpha",)


def test_gyros_meet_the_earth_rate_at_chi() -> None:
    geometry = stand_geometry(MIXED)
    assert np.allclose(np.linalg.norm(geometry.n[:, 4], axis=1), EARTH_RATE, rtol=1e-12)
    along_the_head = geometry.n[:, 4] @ (MIXED.mounting @ [0, 1, 0])
    assert np.allclose(np.abs(along_the_head), EARTH_RATE * np.sin(np.radians(39.0)), rtol=1e-12)


def test_the_simulated_stand_is_the_chain_of_rotations() -> None:
    errors = StandErrors(theta_x=2e-4, alpha=1e-4)
    beta = 1e-4 * np.random.default_rng(0).standard_normal(len(MIXED.beta))
    found = true_vectors(MIXED, StandDraw(errors, beta))
    happened = Happened({"theta_x": 2e-4, "alpha": 1e-4}, beta)
    assert np.allclose(found[:, 0], applied(MIXED, ACCELEROMETER, happened), atol=1e-12 * GRAVITY)
    assert np.allclose(found[:, 3], applied(MIXED, "gyroscope", happened), atol=1e-12 * EARTH_RATE)
