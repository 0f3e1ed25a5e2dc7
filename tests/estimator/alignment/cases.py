"""Alignments whose truth is known, short enough for tests."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from estimator.alignment.align import align
from estimator.alignment.results import AlignmentResult
from estimator.alignment.simulate import Imperfections, Truth, TurntableProgramme, simulate_alignment, triads
from estimator.alignment.sins import InertialModel
from estimator.applied_vector import gravity
from estimator.results import ARCSEC
from estimator.session import Array, CalibrationSession, Site

DEGREE_PER_HOUR = np.pi / 180 / 3600
SITE = Site(latitude=np.radians(40.0))
G = gravity(SITE)
SHORT = TurntableProgramme(dwell=200.0, row=0.5)
QUIET = Imperfections(accelerometer=1e-7, gyro=1e-10)
TYPICAL = Imperfections(wobble=0.5 * ARCSEC, table=0.5 * ARCSEC)


@dataclass(frozen=True, eq=False)
class Case:
    """An alignment and what is true of it."""

    result: AlignmentResult
    truth: Truth
    phi: Array
    """(3,) true φ at the end, rad."""

    @property
    def error(self) -> Array:
        """(n − 2,) estimate minus truth of φ, ε, ∇, E, κ."""
        truth = self.truth
        known = np.concatenate([self.phi, truth.gyro_bias, truth.accelerometer_bias[:2], truth.mounting, [truth.kappa]])
        found = self.result.estimate[2:13]
        return found - known[: len(found)]

    @property
    def covariance(self) -> Array:
        """Covariance of the error."""
        n = 2 + len(self.error)
        return self.result.covariance[2:n, 2:n]


def session(
    truth: Truth,
    seed: int = 1,
    *,
    programme: TurntableProgramme = SHORT,
    noise: Imperfections = TYPICAL,
    site: Site = SITE,
) -> tuple[CalibrationSession, Array]:
    """A session of three accelerometers and three gyros, and the true attitudes."""
    return simulate_alignment(triads(), site, programme, truth, np.random.default_rng(seed), imperfections=noise)


def aligned(
    truth: Truth,
    seed: int = 1,
    *,
    model: InertialModel = InertialModel.TURNTABLE,
    programme: TurntableProgramme = SHORT,
    noise: Imperfections = TYPICAL,
    site: Site = SITE,
    lever_arms: bool = True,
) -> Case:
    """The alignment of a simulated session."""
    measured, attitude = session(truth, seed, programme=programme, noise=noise, site=site)
    result = align(measured, model=model, lever_arms=lever_arms)
    last = round(result.course.time[-1] / programme.row) - 1
    phi = Rotation.from_matrix(attitude[last] @ result.course.attitude[-1].T).as_rotvec()
    return Case(result, truth, phi)


def drawn(rng: np.random.Generator, *, mounting: float = 20 * ARCSEC, kappa: float = 1e-5) -> Truth:
    """Errors of a navigation-grade block in any heading."""
    return Truth(
        gyro_bias=0.05 * DEGREE_PER_HOUR * rng.standard_normal(3),
        accelerometer_bias=1e-4 * G * rng.standard_normal(3) * [1, 1, 0],
        mounting=(mounting * rng.standard_normal(), mounting * rng.standard_normal()),
        kappa=kappa * rng.standard_normal(),
        heading=rng.uniform(0, 2 * np.pi),
        tilt=(3e-4 * rng.standard_normal(), 3e-4 * rng.standard_normal()),
    )
