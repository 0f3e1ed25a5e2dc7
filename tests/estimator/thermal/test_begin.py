"""The start of a thermal session: dimensionless rows, settings, a start, the order that the orientations support."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import ScheduleError, calibrate
from estimator.thermal.begin import begin, dimensionless, settings_of
from tests.estimator.thermal.physics import GYRO_SCALE, G, Still, lived
from tests.estimator.thermal.sessions import session_of

RNG = np.random.default_rng


def test_readings_are_counted_from_their_offset_in_gravities_and_radians_per_second() -> None:
    document, true = lived(Still(gyros=3, offset=0.5, noise=1e-12, quadratic=0.0), RNG(1))
    document["sensors"][1]["bias_repeatability_m_s2"] = 0.03
    document["table"]["A2_se"] = [0.04 * 0.12] * len(true.up)
    y, sigma = dimensionless(session_of(document), np.r_[np.full(6, G), np.ones(3)])
    z = np.vander(true.temperature - 20, 3, increasing=True)
    a = true.up @ true.axes[1] + z @ true.bias[1] / G
    assert y[:, 1] == pytest.approx(z @ true.scale[1] / 0.12 * a)
    assert y[:, 7] == pytest.approx(z @ true.gyro_bias[1], abs=2e-4)
    assert sigma[:, 1] == pytest.approx(0.05 / G)
    assert sigma[:, 8] == pytest.approx(1e-5)
    assert GYRO_SCALE * y[:, 8] == pytest.approx(np.array(document["table"]["G3"]))


def test_neighbours_of_one_label_share_a_setting() -> None:
    session = session_of(lived(Still(), RNG(1))[0])
    assert settings_of(session).tolist() == list(range(81))
    labels = np.r_[4, 4, 7, 7, 7, 4, -1, -1, 0, 0, np.arange(10, 81)]
    found = settings_of(replace(session, position=labels))
    assert found[:11].tolist() == [0, 0, 1, 1, 1, 2, 3, 4, 5, 5, 6]


def test_the_start_is_the_fit_without_temperature() -> None:
    """Near the truth to what temperature does: parts in a hundred."""
    document, true = lived(Still(gyros=3, quadratic=0.0), RNG(2))
    begun = begin(session_of(document))
    z = np.vander(true.temperature - 20, 3, increasing=True)
    assert begun.order == 3
    assert begun.state.scale[:6, 0] == pytest.approx((z @ true.scale[:6].T).mean(axis=0) / Still().scale, abs=0.01)
    assert begun.state.bias[:6, 0] == pytest.approx((z @ true.bias.T).mean(axis=0) / G, abs=0.01)
    assert begun.state.bias[6:, 0] == pytest.approx((z @ true.gyro_bias.T).mean(axis=0), abs=5e-5)
    assert begun.state.scale[6:, 0] == pytest.approx(np.ones(3))
    assert (begun.state.directions * (true.up @ turn_of(true.axes, begun.state.axes[:6]))).sum(axis=1).min() > 0.999
    assert (begun.state.quadratic == 0).all()


def turn_of(axes: np.ndarray, found: np.ndarray) -> np.ndarray:
    """(3, 3) turn that takes true axes to those found, applied from the right."""
    left, _, right = np.linalg.svd(axes.T @ found)
    return np.asarray(left @ right)


def test_a_setting_of_several_rows_begins_with_the_mean_of_their_directions() -> None:
    document, true = lived(Still(known=1e-3), RNG(3))
    session = replace(session_of(document), position=np.r_[0, 0, np.arange(1, 80)])
    begun = begin(session)
    assert begun.rows.setting.max() == 79
    assert begun.rows.prior == pytest.approx(np.full(80, 1e6), rel=1e-6)
    middle = true.up[0] + true.up[1]
    assert begun.state.directions[0] == pytest.approx(middle / np.linalg.norm(middle), abs=0.02)
    assert np.linalg.norm(begun.state.directions, axis=1) == pytest.approx(np.ones(80))


def test_noise_counts_as_stated_where_every_sensor_that_answers_states_it() -> None:
    document, _ = lived(Still(gyros=3, dead=True), RNG(4))
    assert begin(session_of(document)).stated
    del document["table"]["A6_se"]
    assert begin(session_of(document)).stated
    for one in ("A1_se", "G3_se"):
        less = {k: v for k, v in document["table"].items() if k != one}
        assert not begin(session_of(document | {"table": less})).stated


def test_a_sensor_that_answers_to_nothing_takes_no_part() -> None:
    begun = begin(session_of(lived(Still(dead=True, gyros=3), RNG(4))[0]))
    assert begun.at.tolist() == [0, 1, 2, 3, 4, 6, 7, 8]
    assert begun.rows.gyro.tolist() == [False] * 5 + [True] * 3
    assert begun.rows.y.shape == (81, 8)
    assert begun.unit == pytest.approx(np.r_[np.full(5, G), np.ones(3)])


def test_what_is_estimated_first_is_every_coefficient_and_no_form() -> None:
    begun = begin(session_of(lived(Still(soaks=(20.0, 0.0, 40.0, 60.0), gyros=3), RNG(5))[0]))
    assert begun.order == 2
    scale, bias, forms, turns = [True] * 3, [True] * 3, [False] * 2, [True] * 2
    free = begun.free(quadratic=True)
    assert free[0].tolist() == [*scale, *bias, *forms, True, *turns]
    assert free[6].tolist() == [False] * 3 + bias + forms + [False] * 3
    assert not begun.free(quadratic=False)[:, -3].any()


@pytest.mark.parametrize(("each", "order"), [(9, 4), (5, 4), (4, 3), (3, 2)])
def test_the_order_is_the_highest_that_the_orientations_support(each: int, order: int) -> None:
    """Every row says that gravity has one length: an ellipsoid takes nine, each order a centre and a size more."""
    soaks = (20.0, -40.0, -20.0, 0.0, 40.0, 60.0)
    assert begin(session_of(lived(Still(soaks=soaks, each=each), RNG(6))[0])).order == order
    assert order == min((6 * each - 9) // 4, 4)


def test_orientations_that_determine_no_line_are_refused() -> None:
    with pytest.raises(ScheduleError, match="repeat 9 or more"):
        begin(session_of(lived(Still(soaks=(20.0, 60.0), each=4), RNG(7))[0]))


def test_gyros_alone_need_no_gravity() -> None:
    document, true = lived(Still(gyros=3), RNG(8))
    del document["site"]
    document |= {"block": "gyroscope", "sensors": document["sensors"][6:]}
    document["table"] = {k: v for k, v in document["table"].items() if k[0] != "A"}
    result = calibrate(session_of(document))
    assert [s.bias.value for s in result.sensors] == pytest.approx(true.gyro_bias[:, 0], abs=2e-5)
    assert result.fit.dof == 3 * 81 - sum(s.bias.order + 1 for s in result.thermal.sensors if result.thermal)
