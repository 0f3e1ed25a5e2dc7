"""Observability in an alignment: E not by velocity alone, however it is turned; E with the turntable's direction."""

import numpy as np
import pytest

from benchmarks.papers_alignment.observability import Expected, expected, gramian, hidden, planned_path
from estimator.alignment.filtering import FilterSetting
from estimator.alignment.noise import FilterNoise
from estimator.alignment.simulate import TurntableProgramme
from estimator.alignment.sins import PHI, InertialModel, dynamics, earth_rate
from estimator.results import ARCSEC
from tests.estimator.alignment.cases import SITE, TYPICAL, G, aligned, drawn

LATITUDE = SITE.latitude or 0.0
NOISE = FilterNoise((5e-6 * G) ** 2 * np.eye(3), (0.06 * ARCSEC) ** 2 * np.eye(3), 0.0, stated=True)
SETTING = FilterSetting(LATITUDE, G, NOISE, wobble=0.5 * ARCSEC, table=0.5 * ARCSEC)
TURNS = {
    "two": (0.0, np.pi),
    "three": (0.0, np.pi / 2, np.pi),
    "there and back": (0.0, np.pi, 0.0),
    "five and a whole turn": (0.0, np.pi / 2, np.pi, 1.5 * np.pi, 2 * np.pi),
}


def told(angles: tuple[float, ...], model: InertialModel) -> Expected:
    """Expected result of 15 minutes."""
    return expected(planned_path(TurntableProgramme(angles, 900 / len(angles), row=1.0), LATITUDE, G), SETTING, model)


@pytest.mark.parametrize("angles", TURNS.values(), ids=TURNS)
def test_velocity_alone_does_not_tell_mounting_errors_from_biases(angles: tuple[float, ...]) -> None:
    found = told(angles, InertialModel.MOUNTING)
    assert found.rank < len(found.names)
    unseen = {name for name, seen in zip(found.names, found.observable, strict=True) if not seen}
    assert {"E_xz", "E_yz", "nabla_x", "nabla_y", "phi_E", "phi_N"} <= unseen
    assert found.sigma("E_xz") > 100 * ARCSEC


@pytest.mark.parametrize("angles", TURNS.values(), ids=TURNS)
def test_the_turntable_s_direction_tells_them(angles: tuple[float, ...]) -> None:
    found = told(angles, InertialModel.TURNTABLE)
    assert found.rank == len(found.names) == 11
    assert found.sigma("E_xz") < 0.5 * ARCSEC
    assert found.sigma("nabla_x") < 2e-6 * G


def test_more_positions_tell_more() -> None:
    sigmas = [
        told(TURNS[name], InertialModel.TURNTABLE).sigma("E_yz") for name in ("two", "three", "five and a whole turn")
    ]
    assert sigmas[0] > sigmas[1] > sigmas[2]


def test_one_position_tells_neither_heading_nor_biases() -> None:
    found = told((0.0,), InertialModel.TEN)
    assert found.rank == 5
    assert not found.observable[found.names.index("nabla_x")]


def test_the_hidden_error_obeys_the_model_but_for_the_azimuth() -> None:
    """φ turns with the block, f × φ + C∇ = 0, and only φ_U drifts, by Ω cos L·φ_E."""
    path = planned_path(TurntableProgramme(TURNS["three"], 20.0, row=0.1), LATITUDE, G, heading=0.7)
    F = dynamics(path, LATITUDE, G)[:, :13, :13]
    states = np.array([hidden(C, 4 * ARCSEC, 8 * ARCSEC, G) for C in path.mean])
    rates = np.einsum("kij,kj->ki", F, states)
    turned = np.gradient(states[:, PHI], path.step, axis=0)
    smooth = slice(2, 18)
    drift = earth_rate(LATITUDE)[1] * states[:, 2]
    assert np.abs(rates[:, :2]).max() < 1e-12
    assert rates[smooth, 2:4] == pytest.approx(turned[smooth, :2], abs=1e-10)
    assert rates[:, 4] == pytest.approx(drift, abs=1e-12)


def test_the_hidden_direction_is_the_weakest_of_the_gramian() -> None:
    path = planned_path(TurntableProgramme(TURNS["there and back"], 300.0, row=1.0), LATITUDE, G)
    weak = np.linalg.eigvalsh(gramian(path, SETTING, InertialModel.MOUNTING))
    strong = np.linalg.eigvalsh(gramian(path, SETTING, InertialModel.TURNTABLE))
    assert weak[1] < 100 < 1e4 < strong[0]


def test_the_expected_sigmas_are_those_that_the_alignment_reports() -> None:
    case = aligned(drawn(np.random.default_rng(5)), noise=TYPICAL)
    path = planned_path(TurntableProgramme(dwell=200.0, row=0.5), LATITUDE, G)
    planned = expected(path, SETTING, InertialModel.TURNTABLE)
    reported = np.sqrt(np.diag(case.covariance))
    assert reported == pytest.approx(planned.sigmas, rel=0.25)
