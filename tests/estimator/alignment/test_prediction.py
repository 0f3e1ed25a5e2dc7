"""Unmodelled mounting errors leave what the paper's equation (5) says, whatever the errors, latitude and heading."""

import numpy as np
import pytest

from benchmarks.papers_alignment.observability import mounting_effect
from estimator.alignment.simulate import Truth
from estimator.alignment.sins import InertialModel
from estimator.applied_vector import gravity
from estimator.results import ARCSEC
from estimator.session import Site
from tests.estimator.alignment.cases import QUIET, G, aligned

BLOCK_X_EAST = Truth(mounting=(4 * ARCSEC, 8 * ARCSEC))


def test_the_published_end_values_are_reached() -> None:
    """Liu et al., figures 1 and 2: −8″, +4″, about −2e-5 g and −4e-5 g."""
    error = aligned(BLOCK_X_EAST, model=InertialModel.TEN, noise=QUIET).error
    assert error[:2] / ARCSEC == pytest.approx([-8, 4], abs=0.05)
    assert error[6:8] / G == pytest.approx([-1.939e-5, -3.879e-5], abs=2e-7)


@pytest.mark.parametrize("seed", range(8))
def test_the_prediction_holds_for_any_mounting_error_latitude_and_heading(seed: int) -> None:
    rng = np.random.default_rng(seed)
    site, heading = Site(latitude=rng.uniform(-1.2, 1.2)), rng.uniform(0, 2 * np.pi)
    E_xz, E_yz = 30 * ARCSEC * rng.standard_normal(2)
    truth = Truth(mounting=(E_xz, E_yz), heading=heading)
    error = aligned(truth, model=InertialModel.TEN, noise=QUIET, site=site).error
    left = mounting_effect(E_xz, E_yz, gravity(site))
    back = np.array([[np.cos(heading), np.sin(heading)], [-np.sin(heading), np.cos(heading)]])
    assert back @ error[:2] / ARCSEC == pytest.approx([left["phi_E"] / ARCSEC, left["phi_N"] / ARCSEC], abs=0.02)
    assert error[6:8] / G == pytest.approx(np.array([left["nabla_x"], left["nabla_y"]]) / G, abs=1e-7)


def test_the_turntable_model_leaves_nothing_of_it() -> None:
    case = aligned(BLOCK_X_EAST)
    assert np.abs(case.error[:2]).max() < 4 * np.sqrt(np.diag(case.covariance)[:2]).max()
    assert case.result.parameter("E_xz").value == pytest.approx(4 * ARCSEC, abs=2.5 * ARCSEC)
    assert case.result.parameter("E_yz").value == pytest.approx(8 * ARCSEC, abs=2.5 * ARCSEC)
