"""A signature must stand out of the scatter of its own sensors' readings where no noise is stated."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.signatures.scatter import in_unknown_noise, reference_scatter, sharing_scatter
from estimator.session import ACCELEROMETER
from tests.estimator.causes.hiding import scene

WHERE = scene(ACCELEROMETER, 0)


def blind(ratio: float | None) -> Baseline:
    """A session with no noise stated; the variance that the other sensors suggest for each, over its own."""
    session = WHERE.measured(1)
    fitted = baseline_of(replace(session, standard_errors=np.full(session.readings.shape, np.nan)))
    return replace(fitted, expected_ratio=None if ratio is None else np.full(6, ratio))


def scatter(baseline: Baseline, size: float = 1.0) -> tuple[float, float]:
    """Energy and degrees of freedom about a signature of one sensor that explains nothing."""
    rows = np.full((1, 6), 48.0)
    (energy,), (freedom,) = reference_scatter(baseline, np.array([2]), rows * size**2, rows)
    return energy, freedom


def test_a_sensor_alone_has_its_own_rows() -> None:
    assert scatter(blind(None)) == (48.0, 48.0)


def test_the_other_sensors_of_its_kind_lend_six_degrees_of_freedom() -> None:
    assert scatter(blind(0.5)) == (48.0 + 6 * 0.5, 48.0 + 6)


def test_a_sensor_plainly_noisier_than_the_others_borrows_nothing() -> None:
    assert scatter(blind(0.5), size=4.0) == (48.0 * 16, 48.0)


def test_where_the_noise_is_stated_there_is_no_scatter_to_stand_out_of() -> None:
    assert not in_unknown_noise(baseline_of(WHERE.measured(1)), np.array([2, -1])).any()


def test_an_unknown_direction_makes_its_accelerometers_share_their_scatter() -> None:
    baseline = baseline_of(scene("orientations", 0).measured(1))
    sharing = sharing_scatter(baseline)
    assert np.flatnonzero(sharing[1]).tolist() == [0, 1, 2]
    assert np.flatnonzero(sharing[4]).tolist() == [4]


def along_all(unstated: list[bool], size: list[float]) -> tuple[float, float]:
    """Variance and degrees of freedom of the scatter of six sensors, as a signature common to all meets it."""
    fitted = replace(baseline_of(WHERE.measured(1)), unstated=np.array(unstated))
    rows = np.full((1, 6), 48.0)
    (energy,), (freedom,) = reference_scatter(fitted, np.array([-1]), rows * np.square(size), rows)
    return energy / freedom, freedom


def test_along_a_common_signature_equal_sensors_count_together() -> None:
    assert along_all([True] * 6, [2.0] * 6) == pytest.approx((4.0, 6 * 48))


def test_along_a_common_signature_stated_noise_is_as_stated() -> None:
    """One sensor of unknown noise, of variance 4; the residuals of the others happen to be small."""
    assert along_all([True, *[False] * 5], [2.0, *[0.5] * 5]) == pytest.approx((9 / 6, 48 * (9 / 4) ** 2))
