"""The paper's alignment, simulated through the whole program: readings, coarse alignment, strapdown, filter."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from estimator.alignment import InertialModel, align
from estimator.alignment.simulate import Imperfections, Truth, TurntableProgramme, simulate_alignment, triads
from estimator.applied_vector import gravity
from estimator.results import ARCSEC
from estimator.session import Array, Site

SITE = Site(latitude=np.radians(34.2))
"""Xi'an; the paper states no latitude."""
G = gravity(SITE)
MOUNTING = (4 * ARCSEC, 8 * ARCSEC)
DEGREE_PER_HOUR = np.pi / 180 / 3600
TRUTH = Truth(
    gyro_bias=np.array([0.01, 0.01, 0.01]) * DEGREE_PER_HOUR,
    accelerometer_bias=np.array([5e-5, 5e-5, 0.0]) * G,
    mounting=MOUNTING,
)
"""A laser-gyro system: 0.01 °/h, 5e-5 g, and the paper's E_xz = 4″, E_yz = 8″; x starts east."""
PROGRAMME = TurntableProgramme(dwell=300.0)
QUIET = Imperfections(accelerometer=1e-7, gyro=1e-10)


@dataclass(frozen=True, eq=False)
class Errors:
    """Estimate minus truth along an alignment. K steps."""

    time: Array
    """(K,) s."""
    phi: Array
    """(K, 3) rad."""
    nabla: Array
    """(K, 2) m/s²."""
    sigmas: Array
    """(K, n) sigmas of the states."""
    turning: Array
    """(K,) whether the table turns."""


def errors(
    model: InertialModel,
    truth: Truth = TRUTH,
    *,
    site: Site = SITE,
    programme: TurntableProgramme = PROGRAMME,
    noise: Imperfections | None = None,
    seed: int = 1,
) -> Errors:
    """An alignment under a model, against what is true."""
    rng = np.random.default_rng(seed)
    session, attitude = simulate_alignment(triads(), site, programme, truth, rng, imperfections=noise)
    course = align(session, model=model).course
    rows = np.round(course.time / programme.row).astype(int) - 1
    true = Rotation.from_matrix(attitude[rows]) * Rotation.from_matrix(course.attitude).inv()
    return Errors(
        time=course.time,
        phi=course.estimates[:, 2:5] - true.as_rotvec(),
        nabla=course.estimates[:, 8:10] - truth.accelerometer_bias[:2],
        sigmas=course.sigmas,
        turning=course.stop < 0,
    )
