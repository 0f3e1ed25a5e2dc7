"""The result in SI, against sessions of known truth: values, uncertainties, units."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from estimator import Calibration, calibrate, read_session
from estimator.arrays import tangents
from estimator.curves import Curve
from estimator.session import Array
from tests.estimator.thermal.physics import Still, Truly, lived

KNOWN = Still(known=2e-3, gyros=3, soaks=(20.0, -40.0, 0.0, 45.0, 70.0), each=14)
COUNT = 8


@cache
def calibrated(case_of: Callable[[], Still], seed: int = 1) -> tuple[Calibration, Truly]:
    document, true = lived(case_of(), np.random.default_rng(seed))
    return calibrate(read_session(document), quadratic=True), true


def known() -> Still:
    return KNOWN


def unknown() -> Still:
    return Still(gyros=3, stated=False)


def deviations(result: Calibration, true: Truly) -> Array:
    """(6, 5) estimates less the truth: scale, bias, quadratic, two turns of the axis."""
    off = np.zeros((6, 5))
    for i in range(6):
        s = result.sensor(f"A{i + 1}")
        values = [s.scale.value, s.bias.value, s.quadratic.value]
        off[i, :3] = np.array(values, dtype=float) - [true.scale[i, 0], true.bias[i, 0], true.quadratic[i]]
        off[i, 3:] = s.axis_tangents.T @ (s.axis - true.axes[i])
    return off


def test_errors_of_all_elements_are_those_of_the_covariance() -> None:
    """Normalised squares of the errors are χ² of thirty, and of one; noise is known, directions hold the frame."""
    whole, single = [], []
    for seed in range(COUNT):
        result, true = calibrated(known, seed)
        e, C = deviations(result, true).ravel(), result.covariance[:30, :30]
        whole.append(float(e @ np.linalg.solve(C, e)))
        single.append(e**2 / np.diagonal(C))
    assert np.mean(whole) == pytest.approx(30, abs=4 * np.sqrt(60 / COUNT))
    assert np.mean(np.array(single).reshape(-1, 6, 5), axis=(0, 1)) == pytest.approx(np.ones(5), abs=0.6)


def test_estimates_state_the_roots_of_their_variances() -> None:
    result, _ = calibrated(known)
    for i in range(6):
        s, root = result.sensor(f"A{i + 1}"), np.sqrt(np.diagonal(result.covariance)[5 * i : 5 * i + 5])
        assert (s.scale.sigma, s.bias.sigma, s.quadratic.sigma) == pytest.approx(tuple(root[:3]))
        assert s.scale.dof is None
        assert s.observable == dict.fromkeys(("scale", "bias", "quadratic", "axis"), True)


def test_gyros_at_rest_tell_their_bias_alone() -> None:
    errors = []
    for seed in range(COUNT):
        result, true = calibrated(known, seed)
        for i in range(3):
            s = result.sensor(f"G{i + 1}")
            assert s.observable == {"scale": False, "bias": True, "quadratic": False, "axis": False}
            assert s.bias.value is not None
            assert s.bias.sigma is not None
            errors.append((s.bias.value - true.gyro_bias[i, 0]) / s.bias.sigma)
        assert np.isnan(result.covariance[30:, 30:]).sum() == 15**2 - 9
    assert np.mean(np.square(errors)) == pytest.approx(1.0, abs=4 * np.sqrt(2 / COUNT / 3))


def test_curves_lie_within_their_bands_of_the_truth() -> None:
    """Every kind of curve is tried at twelve temperatures."""
    grid, held = np.linspace(-40, 70, 12), []
    for seed in range(COUNT):
        result, true = calibrated(known, seed)
        curves = result.thermal
        assert curves is not None
        pairs: list[tuple[Curve | None, Array]] = []
        for i in range(6):
            own = curves.sensor(f"A{i + 1}")
            pairs += [(own.bias, true.bias[i]), (own.scale, true.scale[i])]
        pairs += [(curves.sensor(f"G{i + 1}").bias, true.gyro_bias[i]) for i in range(3)]
        for curve, truth in pairs:
            assert curve is not None
            error = curves.value(curve, grid) - np.vander(grid - 20, 3, increasing=True) @ truth
            held.append(float(np.mean((error / curves.sigma(curve, grid)) ** 2)))
    assert np.mean(held) == pytest.approx(1.0, abs=0.25)


def test_a_line_of_temperature_gives_the_coefficient_that_was_put_in() -> None:
    """The coefficient has its sign, in m/s² a kelvin and V per m/s² a kelvin; the order is mostly one."""
    result, true = calibrated(lines)
    assert result.thermal is not None
    orders = []
    for i in range(6):
        own = result.thermal.sensor(f"A{i + 1}")
        assert own.scale is not None
        for curve, truth in ((own.bias, true.bias[i]), (own.scale, true.scale[i])):
            sigma = float(np.sqrt(curve.covariance[1, 1]))
            assert curve.coefficients[1] == pytest.approx(truth[1], abs=4 * sigma)
            assert sigma < 0.1 * abs(truth[1])
            assert curve.scatter == 0.0
            orders.append(curve.order)
            assert not curve.coefficients[curve.order + 1 :].any()
    assert np.mean(np.array(orders) == 1) > 0.8


def lines() -> Still:
    return replace(KNOWN, bend=(0.0, 0.0))


def test_scale_and_bias_of_a_sensor_err_together_as_the_cross_covariance_says() -> None:
    """Turned to the curve's ends: with readings of one sign only both are told by the same readings."""
    cross, made = [], []
    for seed in range(COUNT):
        result, true = calibrated(known, seed)
        assert result.thermal is not None
        e = deviations(result, true)
        for i in range(6):
            own = result.thermal.sensor(f"A{i + 1}")
            assert own.cross is not None
            assert own.cross[0, 0] == pytest.approx(result.covariance[5 * i, 5 * i + 1], rel=1e-6)
            cross.append(own.cross[0, 0])
            made.append(e[i, 0] * e[i, 1])
    assert np.mean(made) == pytest.approx(np.mean(cross), abs=4 * np.std(made) / np.sqrt(len(made)))


def test_noise_that_is_not_stated_is_said_to_be_estimated_with_its_degrees_of_freedom() -> None:
    result, _ = calibrated(unknown)
    assert (result.fit.noise, result.fit.p_value) == ("estimated", None)
    assert result.fit.covariance_factor == 1.0
    dofs = [result.sensor(f"A{i + 1}").bias.dof for i in range(6)]
    assert sum(d or 0 for d in dofs) < result.fit.dof < 9 * 81
    assert result.thermal is not None
    assert result.thermal.sensor("A1").bias.dof == pytest.approx(dofs[0], rel=0.2)
    assert calibrated(known)[0].fit.noise == "stated"
    assert calibrated(known)[0].fit.p_value == pytest.approx(0.5, abs=0.499)


def test_residuals_are_at_the_input_of_the_sensors() -> None:
    """1 mm/s² of accelerometers; of gyros 10⁻⁵ rad/s beside what the Earth turns, whatever their volts."""
    result, _ = calibrated(known)
    left = result.residuals.value
    kept = 1 - 2 / 6 - 54 / 420  # two turns of each row, and nine elements a sensor
    assert np.std(left[:, :6]) == pytest.approx(KNOWN.noise * np.sqrt(kept), rel=0.1)
    assert np.std(left[:, 6:]) < 6 * KNOWN.gyro_noise
    assert result.residuals.sigma[0, [0, 6]] == pytest.approx([KNOWN.noise, KNOWN.gyro_noise], rel=0.01)
    assert result.fit.residual_rms == pytest.approx(np.sqrt(np.mean(left**2)))


def test_noise_that_was_stated_too_small_is_enlarged_to_what_scatters() -> None:
    document, _ = lived(replace(KNOWN, gyros=0), np.random.default_rng(1))
    honest = calibrated(known)[0]
    for name in [n for n in document["table"] if n.endswith("_se")]:
        document["table"][name] = (np.array(document["table"][name]) / 3).tolist()
    document["direction_sigma_deg"] = document["direction_sigma_deg"] / 3
    result = calibrate(read_session(document), quadratic=True)
    assert result.fit.covariance_factor == pytest.approx(9.0, rel=0.25)
    assert result.sensor("A1").bias.sigma == pytest.approx(honest.sensor("A1").bias.sigma, rel=0.2)
    assert result.sensor("A1").bias.dof is not None
    assert result.fit.covariance_factor == pytest.approx(result.fit.chi2 / result.fit.dof)


def test_the_weakest_element_is_named_with_its_relative_uncertainty() -> None:
    result, _ = calibrated(lines)
    g = 9.81
    relative = {}
    for i in range(6):
        s = result.sensor(f"A{i + 1}")
        relative[f"A{i + 1}.scale"] = (s.scale.sigma or 0) / (s.scale.value or 1)
        relative[f"A{i + 1}.bias"] = (s.bias.sigma or 0) / g
        relative[f"A{i + 1}.quadratic"] = (s.quadratic.sigma or 0) * g
        C = result.covariance[5 * i + 3 : 5 * i + 5, 5 * i + 3 : 5 * i + 5]
        relative |= {f"A{i + 1}.axis_{k + 1}": float(np.sqrt(C[k, k])) for k in range(2)}
    name = max(relative, key=lambda key: relative[key])
    assert result.fit.weakest == (name, pytest.approx(relative[name], rel=1e-6))


def test_a_sensor_that_answers_to_nothing_keeps_its_nominal_values() -> None:
    document, true = lived(Still(dead=True, gyros=3, quadratic=0.0), np.random.default_rng(2))
    result = calibrate(read_session(document), quadratic=False)
    dead = result.sensor("A6")
    assert not any(dead.observable.values())
    assert result.thermal is not None
    assert [s.name for s in result.thermal.sensors] == ["A1", "A2", "A3", "A4", "A5", "G1", "G2", "G3"]
    for i in range(5):
        s = result.sensor(f"A{i + 1}")
        assert s.bias.value == pytest.approx(true.bias[i, 0], abs=4 * (s.bias.sigma or 0))
    assert result.sensor("G3").bias.value == pytest.approx(true.gyro_bias[2, 0], abs=1e-5)


def test_the_frame_is_held_by_stated_directions_else_by_the_nominal_axes() -> None:
    assert calibrated(known)[0].gauge == "directions"
    assert calibrated(unknown)[0].gauge == "nominal-axes"


@pytest.mark.parametrize(("noise", "asked", "told"), [
    (1e-3, None, True), (1e-3, False, False), (2e-2, None, False), (2e-2, True, True)])  # fmt: skip
def test_second_order_is_told_where_it_is_known_to_100_ug_per_g2_or_asked_for(
    noise: float, asked: bool | None, told: bool
) -> None:
    document, true = lived(replace(KNOWN, noise=noise, gyros=0), np.random.default_rng(3))
    result = calibrate(read_session(document), quadratic=asked)
    own = result.sensor("A2").quadratic
    assert result.sensor("A2").observable["quadratic"] is told
    if told:
        assert own.value == pytest.approx(true.quadratic[1], abs=4 * (own.sigma or 0))


def test_an_offset_of_the_readings_changes_nothing() -> None:
    plain, _ = calibrated(known)
    offset = calibrate(read_session(lived(replace(KNOWN, offset=0.7), np.random.default_rng(1))[0]), quadratic=True)
    assert offset.sensor("A3").bias.value == pytest.approx(plain.sensor("A3").bias.value, abs=1e-7)


def test_axes_are_given_with_tangents_across_them() -> None:
    result, _ = calibrated(known)
    for i in range(6):
        s = result.sensor(f"A{i + 1}")
        assert s.axis @ s.axis_tangents == pytest.approx(np.zeros(2), abs=1e-9)
        assert s.axis_tangents == pytest.approx(tangents(s.axis))
