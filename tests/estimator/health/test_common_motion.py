"""The common turn and the common factor of a block, apart from what single sensors do."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from estimator.arrays import tangents
from estimator.health import ParameterJudgement, judge
from estimator.health.common_motion import CommonMotion, Split, common_motion
from estimator.results import ARCSEC, Calibration
from estimator.session import ACCELEROMETER, GYROSCOPE, Array
from estimator.simulate import cone
from tests.estimator.health.cases import TOLERANCES, block

TURN = np.array([3.0, 12.0, -4.0]) * ARCSEC
SIGMA = 0.8 * ARCSEC
SCALE_SIGMA = 2e-6
STAND_SCALE = 6e-6
"""One sigma of the stand's scale in one session, relative."""
CONE = float(np.arccos(1 / np.sqrt(3)))


def axes_of(m: int) -> Array:
    """(m, 3) axes that do not look alike from any side."""
    return cone(m, CONE) if m > 4 else np.vstack([cone(3, 1.2), [[0.0, 1.0, 0.0]]])[:m]


def covariance_of(m: int, common: float = 3.0) -> Array:
    """(5 m, 5 m) noise of each element, and a stand that turns all axes and stretches all scales together."""
    axes = axes_of(m)
    design = np.zeros((5 * m, 4))
    for i, basis in enumerate(tangents(axes)):
        design[5 * i + 3 : 5 * i + 5, :3] = np.cross(axes[i], basis.T)
        design[5 * i, 3] = 0.12
    own = np.tile([0.12 * SCALE_SIGMA, 2e-5, 1e-7, SIGMA, SIGMA], m)
    spread = np.array([ARCSEC, ARCSEC, ARCSEC, 2e-6]) * common
    return np.diag(own**2) + design @ np.diag(spread**2) @ design.T


def measured(m: int, rng: np.random.Generator | None, moved: Array | None = None, turn: Array = TURN) -> Calibration:
    """A block that turned as a whole and whose sensors moved; (m, 5) in natural units of the elements."""
    covariance = covariance_of(m)
    error = np.zeros(5 * m) if rng is None else rng.multivariate_normal(np.zeros(5 * m), covariance)
    change = error.reshape(m, 5) + (np.zeros((m, 5)) if moved is None else moved)
    return block(axes_of(m), change, covariance, turn)


def split(m: int, rng: np.random.Generator | None, moved: Array | None = None, turn: Array = TURN) -> dict[str, Split]:
    """The splits by quantity, since a reference measured with the same errors."""
    reference = block(axes_of(m), np.zeros((m, 5)) if rng is None else _errors(m, rng), covariance_of(m), np.zeros(3))
    return {s.motion.quantity: s for s in common_motion(measured(m, rng, moved, turn), reference)}


def _errors(m: int, rng: np.random.Generator) -> Array:
    drawn: Array = rng.multivariate_normal(np.zeros(5 * m), covariance_of(m)).reshape(m, 5)
    return drawn


def tilted(m: int, sensor: int, arcsec: float) -> Array:
    """One sensor whose axis moved alone."""
    moved = np.zeros((m, 5))
    moved[sensor, 3:] = np.array([0.6, 0.8]) * arcsec * ARCSEC
    return moved


def test_without_noise_the_turn_is_exact_and_nothing_is_left() -> None:
    found = split(6, None)["axes"]
    assert found.motion.value == pytest.approx(TURN, abs=1e-10)
    assert max(np.abs(d.vector).max() for d in found.residuals.values()) < 1e-9


def test_a_common_factor_is_taken_off_all_scales() -> None:
    moved = np.zeros((6, 5))
    moved[:, 0] = 0.12 * 40e-6
    moved[2, 0] += 0.12 * 90e-6
    found = split(6, np.random.default_rng(1), moved)["scales"]
    assert found.motion.left_out == ("A3",)
    assert found.motion.size == pytest.approx(40e-6, abs=3 * found.motion.sigma)
    assert found.residuals["A3"].vector[0] == pytest.approx(
        90e-6, abs=3 * np.sqrt(found.residuals["A3"].covariance[0, 0])
    )


@pytest.mark.slow
@pytest.mark.parametrize("m", [4, 6, 8])
def test_a_sensor_that_tilts_alone_is_found_and_does_not_smear(m: int) -> None:
    found = [split(m, np.random.default_rng([m, seed]), tilted(m, 1, 30.0))["axes"] for seed in range(40)]
    assert [f.motion.left_out for f in found].count(("A2",)) >= 38
    sizes = [np.hypot(*d.vector) for f in found for name, d in f.residuals.items() if name != "A2"]
    assert np.quantile(sizes, 0.95) < 4 * np.sqrt(2) * SIGMA


def scaled(*sigmas: float) -> tuple[Calibration, Calibration]:
    """A session without noise whose scales moved by so many standard errors of the change, and its reference."""
    moved, m = np.zeros((len(sigmas), 5)), len(sigmas)
    moved[:, 0] = 0.12 * SCALE_SIGMA * np.sqrt(2) * np.array(sigmas)
    return measured(m, None, moved, np.zeros(3)), block(axes_of(m), np.zeros((m, 5)), covariance_of(m), np.zeros(3))


def test_a_sensor_that_explains_the_change_nearly_as_well_is_left_out_too() -> None:
    """χ² is 13.2 without A1 and 21.9 without A2 in its place: less than 2·ln 100 more."""
    found = common_motion(*scaled(5.4, 4.2, 0, 0, 0))[1].motion
    assert found.left_out == ("A1", "A2")


def test_a_sensor_that_explains_the_change_far_worse_is_kept() -> None:
    """χ² is 12 without A1 and 31 without A2 in its place."""
    assert common_motion(*scaled(6.4, 4.0, 0, 0, 0))[1].motion.left_out == ("A1",)


def test_what_sensors_may_do_on_their_own_widens_the_common_factor() -> None:
    """Closed form: the mean of six changes, each with both sessions' noise and a tenth of the tolerance."""
    now, then = scaled(0, 0, 0, 0, 0, 0)
    found = common_motion(now, then, {(ACCELEROMETER, "scale"): 1e-4})[1].motion
    each = 2 * SCALE_SIGMA**2 + (0.1 * 1e-4) ** 2
    assert found.sigma == pytest.approx(np.sqrt(each / 6 + 2 * STAND_SCALE**2), rel=1e-4)


def test_a_judgement_takes_its_tolerances_into_the_split() -> None:
    now, then = scaled(4.6, -4.6, 0, 0, 0, 0)
    found = judge(now, then, TOLERANCES)
    split = common_motion(now, then, TOLERANCES)
    assert found == judge(now, then, TOLERANCES, splits=split)
    assert found != judge(now, then, TOLERANCES, splits=common_motion(now, then))


@pytest.mark.parametrize("changed", [0, 1])
def test_a_sensor_of_another_kind_in_one_session_has_no_part(changed: int) -> None:
    both = list(scaled(0, 0, 0, 0))
    first, *others = both[changed].sensors
    both[changed] = replace(both[changed], sensors=(replace(first, kind=GYROSCOPE), *others))
    found = {(s.motion.kind, s.motion.quantity): s.motion.sensors for s in common_motion(*both)}
    assert found[ACCELEROMETER, "scales"] == ("A2", "A3", "A4")


def test_two_sensors_that_tilt_are_both_found_among_eight() -> None:
    moved = tilted(8, 1, 30.0) + tilted(8, 5, -25.0)
    assert set(split(8, np.random.default_rng(3), moved)["axes"].motion.left_out) == {"A2", "A6"}


def test_sensors_that_wander_a_little_still_agree_on_a_large_turn() -> None:
    """Each axis 1.7 arcsec away on its own, a turn of 13 arcsec: a majority agrees within a tenth of 20."""
    rng, states, errors = np.random.default_rng(9), [], []
    for _ in range(60):
        moved = np.zeros((6, 5))
        moved[:, 3:] = 1.7 * ARCSEC * rng.standard_normal((6, 2))
        now, then = measured(6, rng, moved), block(axes_of(6), _errors(6, rng), covariance_of(6), np.zeros(3))
        axes = common_motion(now, then, {(ACCELEROMETER, "axis"): 20 * ARCSEC})[0].motion
        states.append(axes.state)
        errors.append(nees(replace(axes, value=tuple(np.array(axes.value) - TURN))))
    assert set(states) == {"separated"}
    assert np.mean(errors) < 3 + 4 * np.sqrt(6 / 60)


def test_a_drift_within_its_tolerance_is_not_shared_out_among_the_others() -> None:
    """One of six wandering axes is 12 arcsec away, less than its tolerance of 20."""
    rng, sizes = np.random.default_rng(10), []
    for _ in range(60):
        moved = tilted(6, 1, 12.0)
        moved[:, 3:] += 0.7 * ARCSEC * rng.standard_normal((6, 2))
        now, then = measured(6, rng, moved), block(axes_of(6), _errors(6, rng), covariance_of(6), np.zeros(3))
        left = common_motion(now, then, {(ACCELEROMETER, "axis"): 20 * ARCSEC})[0].residuals["A2"]
        sizes.append(np.hypot(*left.vector) / ARCSEC)
    assert np.median(sizes) == pytest.approx(12, abs=1)


def test_three_axes_cannot_tell_who_moved_and_are_judged_whole() -> None:
    found = split(3, np.random.default_rng(4), tilted(3, 1, 30.0))["axes"]
    assert (found.motion.state, found.residuals) == ("too-few-sensors", {})


def test_two_camps_of_scales_are_left_as_they_are() -> None:
    moved = np.zeros((4, 5))
    moved[:2, 0] = 0.12 * 90e-6
    found = split(4, np.random.default_rng(5), moved)["scales"]
    assert (found.motion.state, found.residuals) == ("unclear", {})


def test_parallel_axes_do_not_hold_a_turn() -> None:
    axes, still = np.tile([[0.0, 0.0, 1.0]], (5, 1)), np.zeros((5, 5))
    one = block(axes, still, np.eye(25) * 1e-12, np.zeros(3))
    assert {s.motion.quantity: s.motion.state for s in common_motion(one, one)}["axes"] == "too-few-sensors"


@pytest.mark.slow
def test_the_turn_and_what_is_left_have_honest_covariances() -> None:
    """Mean normalised error squared, and the chance to call a turn that is not there."""
    rng = np.random.default_rng(6)
    found = [split(6, rng, turn=np.zeros(3)) for _ in range(250)]
    assert {s.motion.state for f in found for s in f.values()} == {"separated"}
    turns = [nees(f["axes"].motion) for f in found]
    assert abs(np.mean(turns) - 3) < 4 * np.sqrt(6 / 250)
    alarms = sum((f["axes"].motion.p_value or 0) < 0.01 for f in found)
    assert alarms <= stats.binom.isf(1e-3, 250, 0.01)
    left = [d.vector @ np.linalg.solve(d.covariance, d.vector) for f in found for d in f["axes"].residuals.values()]
    assert np.mean(left) == pytest.approx(2, abs=0.12)
    outs = sum(bool(f["axes"].motion.left_out or f["scales"].motion.left_out) for f in found)
    assert outs <= stats.binom.isf(1e-3, 250, 0.002)


def nees(motion: CommonMotion, truth: Array | float = 0.0) -> float:
    """Normalised error squared of a turn."""
    error = np.array(motion.value) - truth
    return float(error @ np.linalg.solve(np.array(motion.covariance), error))


def turned_by(degrees: float, seed: int) -> Array:
    """(3,) a rotation vector of so many degrees about any axis, rad."""
    axis = np.random.default_rng([20, seed]).standard_normal(3)
    return np.radians(degrees) * axis / np.linalg.norm(axis)


@pytest.mark.parametrize("degrees", [0.01, 1.0, 5.0, 170.0])
@pytest.mark.parametrize("m", [4, 6, 12])
def test_a_turn_however_large_leaves_nothing_of_any_sensor(m: int, degrees: float) -> None:
    """Linear in the turn, a quarter of its square would be left: 16 arcsec of one degree."""
    turn = turned_by(degrees, m)
    found = split(m, None, turn=turn)["axes"]
    assert found.motion.left_out == ()
    assert found.motion.value == pytest.approx(turn, abs=1e-10)
    assert max(np.abs(d.vector).max() for d in found.residuals.values()) < 1e-9


@pytest.mark.slow
def test_a_large_turn_has_an_honest_covariance_and_moves_no_sensor() -> None:
    rng, errors, outs = np.random.default_rng(21), [], 0
    for k in range(150):
        turn = turned_by(5.0, k)
        found = split(6, rng, turn=turn)["axes"].motion
        errors.append(nees(found, turn))
        outs += bool(found.left_out)
    assert abs(np.mean(errors) - 3) < 4 * np.sqrt(6 / 150)
    assert outs <= stats.binom.isf(1e-3, 150, 0.001)


@pytest.mark.parametrize("arcsec", [20.0, 7200.0])
def test_a_sensor_that_tilts_beside_a_large_turn_is_found_and_does_not_drag_it(arcsec: float) -> None:
    """One of seven; 1.4 arcsec is four sigmas of one axis in both sessions, beyond its own share of noise."""
    for k in range(20):
        turn = turned_by(5.0, k)
        found = split(7, np.random.default_rng([22, k]), tilted(7, 1, arcsec), turn)["axes"]
        assert found.motion.left_out == ("A2",)
        assert np.hypot(*found.residuals["A2"].vector) == pytest.approx(np.arctan(arcsec * ARCSEC), abs=6 * SIGMA)
        assert nees(found.motion, turn) < stats.chi2.isf(1e-5, 3)


def verdicts(moved: Array | None, turn: Array) -> dict[tuple[str, str], ParameterJudgement]:
    """The judgements of six sensors."""
    rng = np.random.default_rng(7)
    now, then = measured(6, rng, moved, turn), block(axes_of(6), _errors(6, rng), covariance_of(6), np.zeros(3))
    return {(j.sensor, j.parameter): j for j in judge(now, then, TOLERANCES)}


def test_a_turned_block_passes_and_says_that_it_turned() -> None:
    found = verdicts(None, 5 * TURN)
    assert {j.verdict for (_, parameter), j in found.items() if parameter == "axis"} == {"pass"}
    axis = found["A1", "axis"]
    assert axis.common == pytest.approx(65 * ARCSEC, rel=0.2)
    assert axis.value == pytest.approx(65 * ARCSEC, rel=0.5)
    assert axis.common_p is not None
    assert axis.common_p < 1e-6


def test_a_sensor_that_tilts_in_a_turned_block_fails_alone() -> None:
    found = verdicts(tilted(6, 3, 40.0), 5 * TURN)
    assert {s for (s, _), j in found.items() if j.verdict == "fail"} == {"A4"}


def test_the_shares_of_both_sessions_add_up_to_the_uncertainty() -> None:
    found = verdicts(None, TURN)["A1", "scale"]
    assert found.change is not None
    assert found.change_own is not None
    assert found.change_origin is not None
    assert found.change[0] == found.deviation
    assert np.hypot(found.change_own[0], found.change_origin[0]) == pytest.approx(found.uncertainty)


def test_a_frame_held_by_the_axes_themselves_shows_no_turn() -> None:
    """The calibration's covariance vanishes along a common turn in such a frame."""
    axes, still = axes_of(6), np.zeros((6, 5))
    free = covariance_of(6, common=0.0)
    rows = [5 * i + k for i in range(6) for k in (3, 4)]
    a = np.concatenate([np.cross(axis, basis.T) for axis, basis in zip(axes, tangents(axes), strict=True)])
    rest = np.eye(12) - a @ np.linalg.pinv(a)
    free[np.ix_(rows, rows)] = rest @ free[np.ix_(rows, rows)] @ rest.T
    one = block(axes, still, free, np.zeros(3), gauge="nominal-axes")
    found = {s.motion.quantity: s for s in common_motion(one, block(axes, still, free, 9 * TURN))}["axes"]
    assert (found.motion.state, found.motion.p_value) == ("separated", None)
    assert max(np.abs(d.vector).max() for d in found.residuals.values()) < 0.02 * ARCSEC
