"""The filter: its model is that of the strapdown, its sigmas are honest, its covariance stays one."""

import numpy as np
import pytest
from scipy.stats import chi2

from benchmarks.papers_alignment.observability import planned_path
from estimator.alignment.filtering import KalmanState, correct, predict
from estimator.alignment.noise import at_rest
from estimator.alignment.simulate import Imperfections, Truth, TurntableProgramme, true_attitude, true_motion
from estimator.alignment.sins import InertialModel, dynamics, earth_rate, transition
from estimator.results import ARCSEC
from estimator.session import Array, Site
from tests.estimator.alignment.cases import SITE, TYPICAL, Case, G, aligned, drawn

LATITUDE = SITE.latitude or 0.0
RUNS = 14
NOISY = Imperfections(accelerometer=5e-5 * G, gyro=0.02 * ARCSEC * 60, wobble=0.5 * ARCSEC, table=0.5 * ARCSEC)
FOUR = TurntableProgramme(angles=(0, np.pi / 2, np.pi, 1.5 * np.pi), dwell=120.0, row=0.5)
CASES = {
    "turntable": (InertialModel.TURNTABLE, TYPICAL, TurntableProgramme(dwell=200.0, row=0.5), 20 * ARCSEC),
    "noisy": (InertialModel.TURNTABLE, NOISY, TurntableProgramme(dwell=200.0, row=0.5), 20 * ARCSEC),
    "four stops": (InertialModel.TURNTABLE, TYPICAL, FOUR, 20 * ARCSEC),
    "ten states": (InertialModel.TEN, Imperfections(), TurntableProgramme(dwell=200.0, row=0.5), 0.0),
}


def runs(name: str) -> list[Case]:
    model, noise, programme, mounting = CASES[name]
    found = []
    for seed in range(RUNS):
        rng = np.random.default_rng(seed)
        site = Site(latitude=rng.uniform(-1.1, 1.1))
        truth = drawn(rng, mounting=mounting, kappa=0.0 if model is InertialModel.TEN else 1e-5)
        found.append(aligned(truth, seed, model=model, noise=noise, programme=programme, site=site))
    return found


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_errors_are_as_large_as_their_covariance_says(name: str) -> None:
    cases = runs(name)
    nees = sum(float(c.error @ np.linalg.solve(c.covariance, c.error)) for c in cases)
    low, high = chi2.ppf(np.array([0.001, 0.999]), RUNS * len(cases[0].error))
    assert low < nees < high
    z = np.array([c.error / np.sqrt(np.diag(c.covariance)) for c in cases])
    assert np.abs(z).max() < 4.2


def test_a_block_at_rest_reads_gravity_and_the_earth_s_rotation() -> None:
    """This holds in any heading and at any length of row: C turns with the Earth, so the mean over a row is that at any
    time.
    """
    attitude = true_attitude(TurntableProgramme(angles=(0.3,), dwell=20.0, row=5.0), Truth(), np.zeros((1, 2)))
    motion = true_motion(attitude, 5.0, LATITUDE, G)
    east_north_up = attitude[0].T @ earth_rate(LATITUDE)
    assert motion.forces == pytest.approx(np.tile([0.0, 0.0, G], (4, 1)), abs=1e-12)
    assert motion.rates == pytest.approx(np.tile(east_north_up, (4, 1)), abs=1e-15)


def test_innovations_are_as_large_as_expected() -> None:
    fit = aligned(drawn(np.random.default_rng(3))).result.fit
    assert 0.8 < fit.chi2 / fit.dof < 1.2
    assert (fit.rank, fit.parameters, fit.converged, fit.covariance_factor) == (11, 11, True, 1.0)


def test_the_transition_is_that_of_the_differential_equation() -> None:
    path = planned_path(TurntableProgramme(dwell=20.0, row=0.5), LATITUDE, G)
    F = dynamics(path, LATITUDE, G)
    fine = np.eye(F.shape[1])
    for _ in range(2000):
        fine = fine + path.step / 2000 * (F[5] @ (fine + path.step / 4000 * F[5] @ fine))
    assert transition(F, path.step)[5] == pytest.approx(fine, abs=1e-9)


def test_a_correction_keeps_the_covariance_symmetric_and_positive() -> None:
    rng = np.random.default_rng(1)
    state = KalmanState(np.zeros(3), np.diag([1e6, 1.0, 1e-12]))
    for _ in range(200):
        H = rng.standard_normal((1, 3))
        state, _ = correct(predict(state, np.eye(3), 1e-15 * np.eye(3)), np.zeros(1), H, np.array([[1e-10]]))
    assert np.array_equal(state.P, state.P.T)
    assert np.linalg.eigvalsh(state.P).min() > 0


def means(velocity: float, rng: np.random.Generator) -> Array:
    """(2000, 3) step means of white noise of density 1e-8 and sway."""
    sway = np.diff(velocity * rng.standard_normal((2001, 3)), axis=0)
    return np.asarray(1e-4 * rng.standard_normal((2000, 3)) + sway)


def test_noise_and_sway_are_told_apart() -> None:
    density, variance = at_rest([means(1e-4, np.random.default_rng(1))], 1.0)
    assert np.diag(density) == pytest.approx([1e-8] * 3, rel=0.35)
    assert np.sqrt(variance) == pytest.approx(1e-4, rel=0.1)


def test_without_sway_all_of_the_scatter_is_white_noise() -> None:
    density, variance = at_rest([means(0.0, np.random.default_rng(2))], 1.0)
    assert np.diag(density) == pytest.approx([1e-8] * 3, rel=0.1)
    assert variance == 0.0
