"""The U of a sensor that drifted, and of the others beside it, however clearly it shows who moved."""

import numpy as np
import pytest
from scipy import stats
from scipy.spatial.transform import Rotation

from estimator.arrays import tangents
from estimator.health import judge
from estimator.health.common_motion import common_motion
from estimator.health.moved import chi2_limit
from estimator.results import ARCSEC
from estimator.session import ACCELEROMETER, Array
from tests.estimator.health.cases import block
from tests.estimator.health.test_common_motion import axes_of

TOLERANCE = 20 * ARCSEC
TOLERANCES = {(ACCELEROMETER, "axis"): TOLERANCE}
SESSIONS = 120


def measured(axes: Array, turn: Array, sigma: float, rng: np.random.Generator) -> Array:
    """(m, 3) axes turned together, each seen with an error of its own: whole rotations, nothing linear."""
    seen = Rotation.from_rotvec(turn).apply(axes)
    return Rotation.from_rotvec(sigma * rng.standard_normal(axes.shape)).apply(seen)


def drifted(rng: np.random.Generator, m: int, sigma: float) -> tuple[bool, int]:
    """Whether U holds what one drifted axis did, and for how many of the others it holds that they did nothing."""
    origins, who = axes_of(m), int(rng.integers(m))
    size, across = rng.uniform(0.2, 0.6) * TOLERANCE, tangents(origins)[who] @ _direction(rng)
    moved = origins.copy()
    moved[who] = Rotation.from_rotvec(size * np.cross(origins[who], across)).apply(origins[who])
    covariance = np.diag(np.tile([1e-9, 1e-9, 1e-9, sigma, sigma], m) ** 2)
    turn = 10 * ARCSEC * rng.standard_normal(3)
    axes = (measured(moved, turn, sigma, rng), measured(origins, np.zeros(3), sigma, rng))
    now, then = (block(seen, np.zeros((m, 5)), covariance, np.zeros(3)) for seen in axes)
    found = judge(now, then, TOLERANCES, splits=common_motion(now, then, TOLERANCES))
    true = [size if i == who else 0.0 for i in range(m)]
    held = [abs((j.deviation or 0.0) - t) <= (j.expanded or 0.0) for j, t in zip(found, true, strict=True)]
    return held.pop(who), sum(held)


def _direction(rng: np.random.Generator) -> Array:
    angle = rng.uniform(0, 2 * np.pi)
    return np.array([np.cos(angle), np.sin(angle)])


@pytest.mark.slow
@pytest.mark.parametrize(("m", "arcsec"), [(4, 0.8), (6, 2.0), (8, 1.2)])
def test_u_holds_an_axis_that_drifted_by_a_part_of_its_tolerance(m: int, arcsec: float) -> None:
    """If a sensor were judged beside an x that it drags itself, 74 to 90 in a hundred would be held. If one moved for
    nothing while the others pay for it, 92 of the others of four axes would be.
    """
    rng = np.random.default_rng([m, round(10 * arcsec)])
    found = [drifted(rng, m, arcsec * ARCSEC) for _ in range(SESSIONS)]
    assert sum(own for own, _ in found) >= stats.binom.ppf(1e-3, SESSIONS, 0.954)
    assert sum(others for _, others in found) >= 0.94 * SESSIONS * (m - 1)


def test_few_degrees_of_freedom_ask_for_more_before_a_sensor_is_said_to_have_moved() -> None:
    """Table of F, 2 and 10 degrees, 0.1 %: 14.91 (Box, Hunter and Hunter 2005, table D)."""
    assert chi2_limit(0.001, 2, 10.0) == pytest.approx(2 * 14.91, rel=1e-3)
    assert chi2_limit(0.001, 2, None) == pytest.approx(13.816, rel=1e-4)
