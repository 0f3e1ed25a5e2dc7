"""Printed and checked accuracy formulas against sessions simulated and solved by hand: half sums, half differences."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.papers.half_sums import simulated
from benchmarks.papers.printed import Conditions, checked, gyro_conditions, printed
from estimator.session import Array, StandErrors
from tests.builders import ARCSEC, cone_axes

AXES = cone_axes(6)
"""Cone about the head: e2² = 1/3."""
TILTED = np.array([[0.8, 0.6, 0.0], [0.1, 0.2, np.sqrt(0.95)], [0.3, np.sqrt(0.9), 0.1**0.5 / 10]])
PERFECT = Conditions(np.radians(40.0), 12, 9.8, 0.0, 0.0, StandErrors())
TRIALS = 20_000
SOURCES = {
    "noise": replace(PERFECT, noise=3e-4),
    "bias_variation": replace(PERFECT, bias_variation=3e-4),
    "beta": replace(PERFECT, stand=StandErrors(beta=20 * ARCSEC)),
    "raise": replace(PERFECT, stand=StandErrors(theta_x=12 * ARCSEC, alpha=16 * ARCSEC)),
    "theta_y": replace(PERFECT, stand=StandErrors(theta_y=20 * ARCSEC)),
}


@pytest.mark.parametrize("axes", [AXES, TILTED], ids=["cone", "tilted"])
@pytest.mark.parametrize("source", SOURCES)
def test_the_checked_propagation_is_what_happens(source: str, axes: Array) -> None:
    axes = axes / np.linalg.norm(axes, axis=1, keepdims=True)
    c = SOURCES[source]
    found, expected = simulated(axes, c, TRIALS, 0), checked(axes, c)
    for name, floor in (("scale", 1e-13), ("bias", 1e-13), ("axis", 1e-13)):
        assert getattr(expected, name) == pytest.approx(getattr(found, name), rel=0.06, abs=floor)


RATIOS = [
    ("noise", "scale", 2.0),
    ("noise", "bias", 1.0),
    ("noise", "axis", 0.869),
    ("raise", "axis", 1.0),
    ("raise", "scale", 6.97),
    ("beta", "scale", 2.69),
    ("beta", "axis", 2.41),
    ("bias_variation", "scale", 0.0),
    ("bias_variation", "axis", 0.0),
]


@pytest.mark.parametrize(("source", "parameter", "ratio"), RATIOS)
def test_the_printed_formulas_are_off_by_this_much(source: str, parameter: str, ratio: float) -> None:
    """Printed over true variance, mean over the cone's six sensors."""
    c = SOURCES[source]
    true = getattr(simulated(AXES, c, TRIALS, 1), parameter).mean()
    assert getattr(printed(AXES, c), parameter).mean() / true == pytest.approx(ratio, rel=0.04)


def test_the_gyro_s_stand_errors_are_those_of_31() -> None:
    sigma = StandErrors(theta_y=3.0, alpha=4.0, latitude=3.0, meridian=4.0)
    c = gyro_conditions(replace(PERFECT, stand=sigma), np.pi / 6)
    assert c.stand.alpha == pytest.approx(5.0)
    assert c.stand.theta_y**2 == pytest.approx(9.0 * 0.25 + 16.0 * 0.75)
