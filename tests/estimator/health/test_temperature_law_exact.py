"""The law of temperature against closed forms: its size, what scatters about it, and how it moves a calibration."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from estimator.coverage import coverage_factor
from estimator.health.temperature_law import (
    Seen,
    TemperatureStep,
    _fitted,
    _scatter,
    at_reference,
    can_tell,
    corrections,
    history_of,
    temperature_steps,
)
from estimator.health.type_law import SCATTERS, TypeLaw
from estimator.results import Calibration, Estimate
from estimator.session import ACCELEROMETER, GYROSCOPE, Array
from tests.estimator.health.cases import TOLERANCES, calibration, sensor

BIAS = TOLERANCES[ACCELEROMETER, "bias"]
SCALE = TOLERANCES[ACCELEROMETER, "scale"]
WARM = np.array([20.0, 34.0, 22.0, 12.0, 30.0, 16.0, 26.0, 35.0, 18.0, 24.0])
"""°C."""
BETWEEN = (20.0, 33.0)


def lived(bias: Array, *, u: float = 0.04, celsius: Array = WARM, scale: Array | None = None) -> list[Seen]:
    """Sessions four months apart whose bias, T, is exactly so, with one sigma u, T; scale in T too."""
    scale = np.zeros(len(bias)) if scale is None else scale
    made = [calibration(sensor(bias=(b * BIAS, u * BIAS), scale=(0.12 * (1 + s * SCALE), 0.12 * u * SCALE)))
            for b, s in zip(bias, scale, strict=True)]  # fmt: skip
    return [Seen(2.0 + i / 3, float(t), one) for i, (t, one) in enumerate(zip(celsius, made, strict=True))]


def step_of(sessions: list[Seen], between: tuple[float, float] = BETWEEN, **more: object) -> TemperatureStep | None:
    steps = temperature_steps(sessions, sessions[0].calibration, between, {(ACCELEROMETER, "bias"): BIAS}, **more)
    return steps.get(("A1", "bias"))


@pytest.mark.parametrize(("b", "c"), [(0.15, 0.0), (-0.15, 0.0), (0.1, 0.006)])
def test_a_law_without_noise_is_worth_just_what_it_is(b: float, c: float) -> None:
    """b·(T − T₀) + c·((T − T₀)² − 0), with T₀ the reference's; back it is worth as much with the other sign."""
    away = WARM - 20.0
    sessions = lived(b * away + c * away**2)
    there, back = step_of(sessions), step_of(sessions, BETWEEN[::-1])
    assert there is not None
    assert back is not None
    assert there.worth == pytest.approx((b * 13 + c * 169) * BIAS, rel=1e-6)
    assert back.worth == pytest.approx(-there.worth)
    assert (there.temperature, there.reference_temperature, there.sessions) == (33.0, 20.0, 10)
    assert (there.lowest, there.highest, there.units) == (12.0, 35.0, 0)
    assert there.dof is None
    assert back.sigma == pytest.approx(there.sigma)


def test_a_scale_factor_is_worth_its_relative_change() -> None:
    sessions = lived(np.zeros(10), scale=0.2 * (WARM - 20.0))
    steps = temperature_steps(sessions, sessions[0].calibration, BETWEEN, TOLERANCES)
    assert set(steps) == {("A1", "scale")}
    assert steps["A1", "scale"].worth == pytest.approx(2.6 * SCALE, rel=1e-4)


def test_no_law_is_looked_for_without_a_tolerance() -> None:
    sessions = lived(0.2 * (WARM - 20.0), scale=0.2 * (WARM - 20.0))
    assert temperature_steps(sessions, sessions[0].calibration, BETWEEN, {(GYROSCOPE, "bias"): BIAS}) == {}
    assert set(temperature_steps(sessions, sessions[0].calibration, BETWEEN, {(ACCELEROMETER, "bias"): BIAS})) == {
        ("A1", "bias")
    }


@pytest.mark.parametrize("scatter", [0.0, 0.3])
def test_the_uncertainty_of_a_worth_is_what_it_scatters_by(scatter: float) -> None:
    """The noise is drawn anew, and so is the scatter about the law, of which the session and its reference each have
    their own.
    """
    errors, sigmas, dofs = [], [], []
    for seed in range(25):
        rng = np.random.default_rng(seed)
        off = scatter * rng.standard_normal(12)
        step = step_of(lived(0.2 * (WARM - 20.0) + off[:10] + 0.04 * rng.standard_normal(10)))
        assert step is not None
        dofs.append(step.dof)
        if scatter or step.dof is None:
            errors.append(step.worth / BIAS - 2.6 + off[10] - off[11])
            sigmas.append(step.sigma / BIAS)
    assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(np.sqrt(np.mean(np.square(sigmas))), rel=0.3)
    assert {d for d in dofs if d is not None} == {6.0}  # ten sessions less level, line, bend and a change through time
    assert (None in dofs) is (scatter == 0.0)


def test_a_session_and_its_reference_each_lie_off_the_law_by_what_scatters() -> None:
    """√2·τ alone is left of a law that many sessions determine well."""
    found = []
    for seed in range(4):
        rng = np.random.default_rng(seed)
        celsius = np.r_[20.0, rng.uniform(10, 36, 40)]
        step = step_of(lived(0.2 * (celsius - 20.0) + 0.3 * rng.standard_normal(41), celsius=celsius))
        assert step is not None
        found.append(step.sigma / BIAS)
    assert np.mean(found) == pytest.approx(0.3 * np.sqrt(2), rel=0.12)


def test_weighted_least_squares_is_the_weighted_mean() -> None:
    y, variance = np.array([1.0, 2.0, 6.0]), np.array([1.0, 4.0, 0.25])
    size, covariance, chi2 = _fitted(np.ones((3, 1)), y, variance)
    mean = float((y / variance).sum() / (1 / variance).sum())
    assert size == pytest.approx([mean])
    assert covariance == pytest.approx(1 / (1 / variance).sum())
    assert chi2 == pytest.approx(float(((y - mean) ** 2 / variance).sum()))


def test_what_scatters_beyond_equal_noise_is_the_difference_of_variances() -> None:
    """Mandel and Paule (1982) about a mean: s² − σ²."""
    y, ones = np.array([-5.0, 3.0, 4.0, -1.0, 7.0, -2.0]), np.ones((6, 1))
    assert _scatter(ones, y, np.full(6, 2.0), 5) == pytest.approx(np.var(y, ddof=1) - 2.0)
    assert _scatter(ones, y + 1e3, np.full(6, 2.0), 5) == pytest.approx(np.var(y, ddof=1) - 2.0)
    assert _scatter(ones, y, np.full(6, np.var(y, ddof=1) * 1.001), 5) == 0.0
    assert _scatter(ones, y, np.full(6, 2.0), 0) == 0.0
    assert _scatter(ones[:2], np.array([-3.0, 3.0]), np.ones(2), 1) == pytest.approx(17.0)


def test_the_law_is_found_beside_a_change_through_time() -> None:
    """A jump in the middle, as big as what temperature does."""
    jump = 2.0 * (np.arange(10) >= 5)
    step = step_of(lived(0.2 * (WARM - 20.0) + jump))
    assert step is not None
    assert step.worth == pytest.approx(2.6 * BIAS, rel=0.15)


def test_years_are_counted_from_the_first_session() -> None:
    later = [replace(one, years=one.years + 500.0) for one in lived(0.2 * (WARM - 20.0))]
    history = history_of(later, later[0].calibration.sensor("A1"), "bias", BIAS)
    assert history is not None
    assert history.readings.time == pytest.approx(np.arange(10) / 3)
    assert history.readings.value[:, 0] == pytest.approx(0.2 * (WARM - 20.0))
    assert history.readings.sigma[:, 0] == pytest.approx(np.full(10, 0.04))
    assert history.celsius.tolist() == WARM.tolist()
    assert history.readings.base.shape == (10, 2)
    assert len(history.readings.now) == 2
    assert history.readings.now[1] == history.readings.base[-1, 1]


def test_sessions_that_do_not_tell_the_parameter_are_left_out() -> None:
    sessions = lived(0.2 * (WARM - 20.0))
    origin = sessions[0].calibration.sensor("A1")
    blind = calibration(replace(origin, bias=Estimate(None, None)))
    gyro = calibration(replace(origin, kind=GYROSCOPE))
    other = calibration(replace(origin, name="A2"))
    unknown = calibration(replace(origin, bias=Estimate(0.0, np.inf)))
    mixed = [*sessions, *(Seen(6.0, 25.0, one) for one in (blind, gyro, other, unknown))]
    history = history_of(mixed, origin, "bias", BIAS)
    assert history is not None
    assert len(history.celsius) == 10
    assert history_of(mixed[-4:], origin, "bias", BIAS) is None
    assert step_of(mixed[-4:]) is None


@pytest.mark.parametrize(
    ("learned", "reference", "now", "known"),
    [
        ((20, 24, 22, 18, 19, 25), 20.0, 21.0, True),
        ((20, 24, 22, 18, 19, 25), 20.0, 20.9, False),
        ((20, 24, 22, 18, 19, 25), 20.0, 30.0, True),
        ((20, 24, 22, 18, 19, 25), 20.0, 30.1, False),
        ((20, 24, 22, 18, 19, 25), 20.0, 13.0, True),
        ((20, 24, 22, 18, 19), 20.0, 24.0, False),
        ((18.5, 21.5, 18.5, 21.5, 18.5, 21.5), 20.0, 22.0, True),
        ((18.6, 21.5, 18.5, 21.5, 18.5, 21.5), 20.0, 22.0, False),
    ],
)
def test_the_edges_of_what_sessions_may_tell(
    learned: tuple[float, ...], reference: float, now: float, known: bool
) -> None:
    """A degree from the reference, five from the nearest session, six sessions, 1.5 °C of scatter."""
    assert can_tell(learned, reference, now) is known


def test_six_sessions_tell_a_law_and_five_do_not() -> None:
    assert step_of(lived(0.5 * (WARM[:6] - 20.0), celsius=WARM[:6])) is not None
    assert step_of(lived(0.5 * (WARM[:5] - 20.0), celsius=WARM[:5])) is None


def law(*, sigma: float = 0.01, tolerance: float = BIAS, scatter: int = 0) -> TypeLaw:
    """0.2 T a degree, alike in all units but for sigma, T per °C."""
    chances = tuple(float(i == scatter) for i in range(len(SCATTERS)))
    return TypeLaw(ACCELEROMETER, "bias", tolerance, 20.0, (0.2, 0.0), (sigma, 1e-6), chances, 40, 12)


@pytest.mark.parametrize(("count", "told"), [(4, True), (3, False)])
def test_with_the_law_of_its_type_four_sessions_are_enough(count: int, told: bool) -> None:
    sessions = lived(0.2 * (WARM[:count] - 20.0), celsius=WARM[:count])
    step = step_of(sessions, laws=(law(),))
    assert (step is not None) is told
    if step is not None:
        assert step.worth == pytest.approx(2.6 * BIAS, rel=0.05)
        assert (step.units, step.sessions) == (12, count)


def test_a_type_s_law_that_leaves_the_parameter_undecided_is_not_taken() -> None:
    """Sessions at one temperature say nothing themselves: one sigma of 13 degrees of it, twice, against T."""
    cool = np.full(4, 20.0)
    decided = step_of(lived(np.zeros(4), celsius=cool), laws=(law(sigma=0.45 / 13),))
    assert decided is not None
    assert decided.sigma == pytest.approx(0.45 * BIAS, rel=0.01)
    assert step_of(lived(np.zeros(4), celsius=cool), laws=(law(sigma=0.55 / 13),)) is None


def test_a_law_of_the_sessions_own_is_taken_however_wide() -> None:
    rng = np.random.default_rng(3)
    sessions = lived(1.0 * (WARM - 20.0) + 0.5 * rng.standard_normal(10))
    step = step_of(sessions, laws=(law(sigma=5.0, scatter=SCATTERS.searchsorted(0.5)),))
    assert step is not None
    assert coverage_factor(2.0, step.dof) * step.sigma > BIAS
    assert step.worth == pytest.approx(13 * BIAS, rel=0.15)


def test_a_type_s_law_is_in_its_own_tolerance() -> None:
    """The tolerance has been halved since: 0.2 of what it was are 0.4 of what it is."""
    step = step_of(lived(0.4 * (WARM - 20.0)), laws=(law(tolerance=2 * BIAS),))
    assert step is not None
    assert step.worth == pytest.approx(5.2 * BIAS, rel=0.01)


def test_sound_sensors_show_a_law_as_rarely_as_is_said() -> None:
    """Both parameters of a sensor together show one in at most five of a hundred."""
    found = 0
    for seed in range(25):
        rng = np.random.default_rng(seed)
        sessions = lived(0.04 * rng.standard_normal(10), scale=0.04 * rng.standard_normal(10))
        found += bool(temperature_steps(sessions, sessions[0].calibration, BETWEEN, TOLERANCES))
    assert found <= stats.binom.ppf(0.999, 25, 0.05)


STEPS = {
    ("A1", "bias"): TemperatureStep(0.5 * BIAS, 0.3 * BIAS, 4.0, 33.0, 20.0, 9),
    ("A1", "scale"): TemperatureStep(-2.0 * SCALE, 0.1 * SCALE, None, 33.0, 20.0, 9),
    ("A9", "bias"): TemperatureStep(BIAS, BIAS, None, 33.0, 20.0, 9),
}


def pair() -> tuple[Calibration, Calibration]:
    """A session of two sensors, and its reference."""
    names = tuple(f"{s}.{e}" for s in ("A1", "A2") for e in ("scale", "bias", "quadratic", "axis_1", "axis_2"))
    own = sensor(bias=(1.0 * BIAS, 0.4 * BIAS), scale=(0.12 * (1 - 2 * SCALE), 0.012 * SCALE))
    own = replace(own, bias=replace(own.bias, dof=8.0))
    one = replace(calibration(own, sensor("A2", bias=(BIAS, BIAS))), names=names, covariance=np.eye(10) * 1e-12)
    return one, calibration(sensor(bias=(0.0, 0.1 * BIAS), scale=(0.12, 0.0)), sensor("A2"))


def test_a_calibration_at_its_reference_s_temperature_is_without_the_steps() -> None:
    one, reference = pair()
    moved = at_reference(one, reference, STEPS)
    bias, scale = moved.sensor("A1").bias, moved.sensor("A1").scale
    assert bias.value == pytest.approx(0.5 * BIAS)
    assert bias.sigma == pytest.approx(0.5 * BIAS)
    assert bias.dof == pytest.approx(0.25**2 / (0.16**2 / 8 + 0.09**2 / 4))
    assert scale.value == pytest.approx(0.12 * (1 - 2 * SCALE) + 0.12 * 2 * SCALE)
    assert scale.sigma == pytest.approx(0.12 * np.hypot(0.1, 0.1) * SCALE)
    assert scale.dof is None
    assert moved.sensor("A2").bias is one.sensor("A2").bias
    more = np.zeros(10)
    more[:2] = (0.12 * 0.1 * SCALE) ** 2, (0.3 * BIAS) ** 2
    assert moved.covariance == pytest.approx(one.covariance + np.diag(more), rel=1e-12)
    assert one.covariance == pytest.approx(np.eye(10) * 1e-12)
    assert at_reference(one, reference, {}) is one


def test_a_parameter_that_is_not_known_stays_unknown() -> None:
    one, reference = pair()
    for nothing in (Estimate(None, None), Estimate(0.1, None), Estimate(None, 0.1)):
        blind = replace(one, sensors=(replace(one.sensors[0], bias=nothing), one.sensors[1]))
        assert at_reference(blind, reference, STEPS).sensor("A1").bias == nothing


def test_what_was_corrected_is_told_of_every_parameter_with_a_step() -> None:
    one, reference = pair()
    moved = at_reference(one, reference, STEPS)
    found = corrections((one, moved), reference, STEPS, 2.0)
    assert set(found) == {("A1", "bias"), ("A1", "scale")}
    bias = found["A1", "bias"]
    assert (bias.measured, bias.corrected) == pytest.approx((BIAS, 0.5 * BIAS))
    dof = moved.sensor("A1").bias.dof
    assert dof is not None
    together = 0.26**2 / (0.25**2 / dof)
    assert bias.expanded == pytest.approx(coverage_factor(2.0, together) * np.sqrt(0.26) * BIAS)
    assert found["A1", "scale"].measured == pytest.approx(-2 * SCALE, rel=1e-3)
    assert (bias.worth, bias.sigma, bias.sessions) == (0.5 * BIAS, 0.3 * BIAS, 9)
