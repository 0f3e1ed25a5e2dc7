"""Structure beside polynomials: amplitudes as in a joint fit, and misfits, loops and lags that were put in."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from estimator import Calibration, calibrate, read_session
from estimator.curves import HYSTERESIS, LAG, MISFIT
from estimator.thermal.begin import begin
from estimator.thermal.course import TemperatureCourse
from estimator.thermal.model import ThermalEquations
from estimator.thermal.solve import ThermalFit, search_with_noise
from estimator.thermal.structure import BINS, amplitudes, binned, misfit, misfits, noise_ratio, tried_forms
from tests.estimator.thermal.physics import G, Still, Truly, behind, lived

SLOW = tuple(np.r_[np.linspace(20.0, -40.0, 9), np.linspace(-30, 70, 15), np.linspace(62, -40, 14)].tolist())
"""°C, down, up and down."""


def found(case: Still, seed: int = 1) -> tuple[Calibration, Truly]:
    document, true = lived(case, np.random.default_rng(seed))
    return calibrate(read_session(document)), true


def solved(case: Still, seed: int = 1) -> tuple[ThermalFit, TemperatureCourse]:
    begun = begin(read_session(lived(case, np.random.default_rng(seed))[0]))
    return search_with_noise(begun.rows, begun.state, begun.free(quadratic=True), stated=True), begun.course


def test_amplitudes_beside_a_fit_are_those_of_the_joint_fit() -> None:
    rng = np.random.default_rng(1)
    X, y = rng.standard_normal((50, 7)), rng.standard_normal(50)
    old, at, F = np.arange(4), np.array([4, 5, 6]), X.T @ X
    first = np.linalg.lstsq(X[:, :4], y, rcond=None)[0]
    none = np.zeros(0)
    linear = ThermalEquations(none, none, none, none, none, none, X.T @ (y - X[:, :4] @ first), F)
    size, covariance, score = amplitudes(linear, at, old, np.linalg.inv(F[:4, :4]))
    assert size == pytest.approx(np.linalg.lstsq(X, y, rcond=None)[0][4:])
    assert covariance == pytest.approx(np.linalg.inv(F)[4:, 4:])
    without, joint = (((y - X[:, :n] @ np.linalg.lstsq(X[:, :n], y, rcond=None)[0]) ** 2).sum() for n in (4, 7))
    assert score @ size == pytest.approx(without - joint)
    again = amplitudes(replace(linear, score=X.T @ y), at, old, np.linalg.inv(F[:4, :4]))[0]
    assert again == pytest.approx(size)


def test_a_column_that_the_fit_has_already_has_no_amplitude() -> None:
    rng = np.random.default_rng(2)
    X, y = rng.standard_normal((50, 5)), rng.standard_normal(50)
    X[:, 4] = X[:, 0] - X[:, 1]
    F, none = X.T @ X, np.zeros(0)
    linear = ThermalEquations(none, none, none, none, none, none, X.T @ y, F)
    size, covariance, _ = amplitudes(linear, np.array([3, 4]), np.arange(3), np.linalg.inv(F[:3, :3]))
    assert size[0] == pytest.approx(np.linalg.lstsq(X[:, :4], y, rcond=None)[0][3])
    assert (size[1], covariance[1, 1], covariance[0, 1]) == (0.0, 0.0, 0.0)


def test_columns_that_have_nothing_in_common_keep_their_amplitudes() -> None:
    """Accelerometers and gyros each keep their own."""
    F, none = np.diag([4.0, 9.0, 16.0]), np.zeros(0)
    linear = ThermalEquations(none, none, none, none, none, none, np.array([0.0, 9.0, 32.0]), F)
    size, covariance, _ = amplitudes(linear, np.array([1, 2]), np.arange(1), np.array([[0.25]]))
    assert size == pytest.approx([1.0, 2.0])
    assert covariance == pytest.approx(np.diag([1 / 9, 1 / 16]))


def test_the_misfit_of_bins_is_their_scatter_beyond_noise() -> None:
    """Ten independent bins of variance 4: Q is χ² of ten, and Q − 10 over the sum of weights is τ²."""
    size = np.array([9.0, -7, 8, -9, 7, -8, 9, -7, 8, -9])
    scatter, chance = misfit(size, 4.0 * np.eye(10), 100)
    assert scatter == pytest.approx(np.sqrt(np.mean(size**2) - 4.0))
    assert chance == pytest.approx(stats.f.sf(np.sum(size**2) / 40, 10, 100))
    assert misfit(np.full(10, 2.0), 4.0 * np.eye(10), 100) == (0.0, pytest.approx(stats.f.sf(1.0, 10, 100)))


def test_a_misfit_that_is_as_rare_as_one_in_twenty_widens_a_band() -> None:
    edge = np.sqrt(4 * stats.f.isf(0.05, 10, 100))
    assert misfit(np.full(10, 1.01 * edge), 4.0 * np.eye(10), 100)[0] > 0
    assert misfit(np.full(10, 0.99 * edge), 4.0 * np.eye(10), 100)[0] == 0


def test_bins_that_tell_nothing_do_not_count() -> None:
    """Two of ten are seen; the third number is rounding."""
    size, seen = np.r_[6.0, -6.0, np.zeros(8)], np.diag(np.r_[1.0, 1.0, 1e-9, np.zeros(7)])
    scatter, chance = misfit(size, seen, 50)
    assert chance == pytest.approx(stats.f.sf(36.0, 2, 50))
    assert scatter == pytest.approx(np.sqrt(35.0))


def test_bins_part_the_range_in_ten() -> None:
    """A row is in the bin of its temperature, and only its sensor's scale or bias answers to it."""
    one, course = solved(Still(soaks=SLOW, each=4))
    linear, at, old = binned(one, course)
    m, p = one.free.shape
    assert at.shape == (6, 2, BINS)
    assert len(old) == m * p
    assert not set(at.ravel()) & set(old)
    assert np.union1d(at.ravel(), old).tolist() == list(range(m * (p + 2 * BINS)))
    T, local = course.temperature, linear.local
    which = np.minimum((10 * (T - T.min()) / np.ptp(T)).astype(int), 9)
    wide = local.shape[2]
    for i in (0, 5):
        for k in (0, 1):
            assert (np.argmax(local[:, i, at[i, k] - i * wide] != 0, axis=1) == which).all()
    assert linear.information[np.ix_(old, old)] == pytest.approx(one.linear.information, rel=1e-9, abs=1e-3)
    gain = one.rows.scale_basis @ one.state.scale.T
    by_bias = local[:, 0, at[0, 1]].sum(axis=1) * one.rows.sigma[:, 0]
    assert by_bias == pytest.approx(gain[:, 0])


@pytest.mark.parametrize("stated", [False, True])
def test_what_is_left_over_is_counted_in_the_noise_that_remains(stated: bool) -> None:
    one, _ = solved(Still())
    one = replace(one, chi2=3.0 * one.dof)
    assert noise_ratio(one, 2.0 * one.dof, one.dof // 2, stated=stated) == pytest.approx(2.0, rel=0.01)
    less = noise_ratio(one, 2.9 * one.dof, 0, stated=stated)
    assert less == pytest.approx(1.0 if stated else 0.1)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_loop_is_found_with_its_sign_in_the_sensors_that_have_it(sign: float) -> None:
    """The width is the warming leg's bias less the cooling one's in the middle of the range."""
    result, true = found(Still(soaks=SLOW, each=4, loop=sign * 0.01))
    assert result.thermal is not None
    assert {(f.kind, f.sensor, f.parameter) for f in result.thermal.findings} == {
        (HYSTERESIS, f"A{i}", "bias") for i in (1, 2, 3)
    }
    for one in result.thermal.findings:
        assert one.amplitude == pytest.approx(sign * 0.01, abs=3.5 * one.sigma)
        assert one.sigma < 1e-3
        assert one.time_constant is None
        assert result.thermal.sensor(one.sensor).bias.loop == pytest.approx(abs(one.amplitude))
    assert result.thermal.sensor("A4").bias.loop == 0
    errors = [(result.sensor(f"A{i + 1}").bias, true.bias[i, 0]) for i in range(6)]
    assert all(abs((e.value or 0) - b) < 4 * (e.sigma or 0) for e, b in errors)


@pytest.mark.parametrize(("lag", "tau"), [(5e-4, 2500.0), (-5e-4, 2500.0), (5e-4, 6000.0)])
def test_a_lag_is_found_with_its_sign_and_time_constant(lag: float, tau: float) -> None:
    """The amplitude is the farthest that the bias is off."""
    result, true = found(Still(soaks=SLOW, each=6, lag=lag, tau=tau))
    assert result.thermal is not None
    assert {(f.kind, f.sensor) for f in result.thermal.findings} == {(LAG, f"A{i}") for i in (1, 2, 3)}
    farthest = lag * np.abs(behind(true.temperature, true.time, tau)).max()
    for one in result.thermal.findings:
        assert one.amplitude == pytest.approx(farthest, rel=0.2)
        assert one.time_constant == pytest.approx(tau, rel=0.5)
        assert one.p_value < 1e-6
        assert one.alternatives == ()


def test_a_lag_beside_a_loop_is_found_too() -> None:
    result, _ = found(Still(soaks=SLOW, each=4, loop=0.02, lag=1e-3, tau=2500.0))
    assert result.thermal is not None
    assert {(f.kind, f.sensor) for f in result.thermal.findings} >= {
        (k, f"A{i}") for i in (1, 2, 3) for k in (LAG, HYSTERESIS)
    }


def test_the_chance_of_a_form_is_that_of_fisher_s_law_over_all_forms_tried() -> None:
    """The degrees of freedom are those that the readings leave: few here."""
    one, course = solved(Still(soaks=(20.0, -40.0, 20.0, 70.0, 20.0), each=6, loop=5e-4))
    one = replace(one, chi2=2.0 * one.dof)
    forms = list(tried_forms(one, course, 1, {HYSTERESIS, LAG}, stated=False))
    for form in forms:
        F = form.gain / 6
        assert form.p_value == pytest.approx(min(1.0, stats.f.sf(F, 6, one.dof - 6) * len(forms)), rel=0.02)


def test_where_the_temperature_only_rises_there_is_no_loop_to_find() -> None:
    one, course = solved(Still(soaks=tuple(np.linspace(-40, 70, 12).tolist())))
    kinds = {form.kind for form in tried_forms(one, course, course.order, {HYSTERESIS, LAG}, stated=True)}
    assert kinds == {LAG}
    assert len(list(tried_forms(one, course, course.order, {LAG}, stated=True))) == len(course.time_constants)


def test_by_chance_a_form_shows_as_often_as_is_said() -> None:
    """The p-value of a loop is uniform over 16 sound sessions, below a half in about half of them; that of the best lag
    is an upper bound.
    """
    chances, singles, lags = [], [], []
    for seed in range(16):
        one, course = solved(Still(each=6, known=2e-3), seed)
        [loop] = tried_forms(one, course, 3, {HYSTERESIS}, stated=True)
        chances.append(loop.p_value)
        singles.append(loop.sensor_p_values.min())
        lags.append(min(form.p_value for form in tried_forms(one, course, 3, {LAG}, stated=True)))
    assert stats.kstest(chances, "uniform").pvalue > 0.001
    assert np.mean(np.array(singles) < 0.3) == pytest.approx(0.3, abs=0.2)
    assert np.mean(np.array(lags) < 0.2) < 0.35


def test_by_chance_curves_are_missed_as_often_as_is_said() -> None:
    chances, scatter = [], []
    for seed in range(6):
        one, course = solved(Still(soaks=SLOW, each=3, known=2e-3), seed)
        missed = misfits(one, course, stated=True)
        chances.append(missed.p_value.min())
        scatter.append(missed.sigma > 0)
    assert np.mean(np.array(chances) < 0.5) == pytest.approx(0.45, abs=0.35)
    assert 0.01 < np.mean(scatter) < 0.1


@pytest.mark.parametrize("parameter", ["bias", "scale"])
def test_a_wave_that_no_polynomial_follows_is_a_misfit_of_its_size(parameter: str) -> None:
    """A wave of 3 mm/s², or of 300 ppm of the scale factor, every 30 °C: τ is about its root mean square."""
    document, true = lived(Still(soaks=SLOW, each=4, known=2e-3), np.random.default_rng(3))
    wave = np.sin(2 * np.pi * (true.temperature - 20) / 30)
    by = 3e-3 if parameter == "bias" else 3e-4 * G * true.up @ true.axes[1]
    document["table"]["A2"] = (np.array(document["table"]["A2"]) + 0.12 * by * wave).tolist()
    result = calibrate(read_session(document))
    assert result.thermal is not None
    [one] = result.thermal.findings
    assert (one.kind, one.sensor, one.parameter, one.sigma) == (MISFIT, "A2", parameter, 0.0)
    assert one.amplitude == pytest.approx((3e-3 if parameter == "bias" else 3e-4 * 0.12) / np.sqrt(2), rel=0.35)
    curve = getattr(result.thermal.sensor("A2"), parameter)
    assert curve.scatter == pytest.approx(one.amplitude)


def test_where_directions_are_known_each_sensor_has_its_own_share_of_what_a_form_explains() -> None:
    """Shares that are turned back from the chances of one degree of freedom add up to the whole."""
    one, course = solved(Still(soaks=(20.0, -40.0, 20.0, 70.0, 20.0), each=5, known=1e-6, loop=2e-3))
    one = replace(one, chi2=1.5 * one.dof)
    [form] = tried_forms(one, course, 1, {HYSTERESIS}, stated=False)
    shares = stats.f.isf(form.sensor_p_values / 6, 1, one.dof - 6)
    assert (form.sensor_p_values < 1).sum() >= 3
    assert shares[form.sensor_p_values < 1].sum() == pytest.approx(form.gain, rel=0.1)
