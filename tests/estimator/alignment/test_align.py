"""Sessions on a turntable: what goes in, what comes out, and what is refused."""

from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest

from estimator import align, calibrate, read_session
from estimator.alignment.axes import reduction
from estimator.alignment.simulate import Truth, TurntableProgramme, simulate_alignment, triads
from estimator.alignment.sins import InertialModel
from estimator.errors import FormatError, ScheduleError
from estimator.results import ARCSEC
from estimator.session import ARBITRARY_ORIENTATIONS, CalibrationSession
from estimator.simulate import cone
from estimator.writing import session_document
from tests.estimator.alignment.cases import QUIET, SHORT, SITE, TYPICAL, G, aligned, drawn, session

TRUTH = Truth(mounting=(4 * ARCSEC, 8 * ARCSEC), accelerometer_bias=np.array([2e-4, -1e-4, 0.0]))


def given(programme: TurntableProgramme = SHORT) -> CalibrationSession:
    return session(TRUTH, programme=programme)[0]


def test_a_session_written_and_read_again_gives_the_same() -> None:
    measured = given()
    again = read_session(session_document(measured))
    assert align(again).estimate == pytest.approx(align(measured).estimate, rel=1e-6, abs=1e-10)


def test_the_heading_is_found() -> None:
    found = aligned(Truth(heading=np.radians(-30.0)), noise=QUIET).result
    assert np.degrees(found.heading) == pytest.approx(-150.0, abs=0.01), "30° right of north, turned by 180°"


def test_known_mounting_errors_taken_off_leave_none_in_the_ten_state_estimate() -> None:
    measured, _ = session(TRUTH, noise=QUIET)
    found = align(measured, model=InertialModel.TEN, mounting=TRUTH.mounting)
    assert found.parameter("nabla_x").value == pytest.approx(2e-4, abs=1e-6)
    assert found.parameter("nabla_y").value == pytest.approx(-1e-4, abs=1e-6)


def test_large_biases_are_found_too() -> None:
    truth = Truth(gyro_bias=np.radians([20.0, -15.0, 10.0]) / 3600, accelerometer_bias=np.array([0.03, -0.02, 0.0]))
    case = aligned(truth)
    assert np.abs(case.error / np.sqrt(np.diag(case.covariance))).max() < 4


def test_a_redundant_block_is_reduced_and_tells_more() -> None:
    truth = drawn(np.random.default_rng(4))
    axes = cone(6, np.radians(54.7), (0.0, 0.0, 1.0))
    rng = np.random.default_rng(1)
    many = align(simulate_alignment(triads(axes), SITE, SHORT, truth, rng, imperfections=TYPICAL)[0])
    three = aligned(truth).result
    sigma = many.parameter("eps_x").sigma
    assert sigma is not None
    assert sigma == pytest.approx((three.parameter("eps_x").sigma or 0) / np.sqrt(2), rel=0.2)
    assert abs((many.parameter("eps_x").value or 0) - truth.gyro_bias[0]) < 4 * sigma


def test_reduction_is_the_weighted_least_squares_estimate() -> None:
    axes, R = cone(5, 0.9), np.diag([1.0, 4.0, 1.0, 9.0, 1.0])
    matrix, covariance = reduction(axes, R)
    assert matrix @ axes == pytest.approx(np.eye(3), abs=1e-12)
    assert matrix @ R @ matrix.T == pytest.approx(covariance, abs=1e-12)


def test_stated_standard_errors_are_used_and_tested() -> None:
    measured = given()
    stated = np.array([5e-6 * 9.80665] * 3 + [0.06 * ARCSEC] * 3) / np.sqrt(SHORT.row)
    fit = align(replace(measured, standard_errors=np.tile(stated, (len(measured.readings), 1)))).fit
    assert fit.noise == "stated"
    assert fit.p_value is not None
    assert 1e-3 < fit.p_value < 0.999


def test_sway_of_the_base_makes_the_sigmas_larger_not_wrong() -> None:
    case = aligned(drawn(np.random.default_rng(7)), noise=replace(TYPICAL, sway=1e-3))
    assert np.abs(case.error / np.sqrt(np.diag(case.covariance))).max() < 4


def test_as_a_calibration_the_axes_carry_the_errors() -> None:
    found = calibrate(given())
    assert [s.name for s in found.sensors] == ["acc x", "acc y", "gyro x", "gyro y", "gyro z"]
    assert found.sensor("acc x").bias.value == pytest.approx(2e-4, abs=4e-5)
    assert set(found.sensor("gyro y").observable) == {"bias", "misalignment"}
    assert found.to_dict()["sensors"][3]["misalignment"]["value"] == pytest.approx(8 * ARCSEC, abs=3 * ARCSEC)
    assert found.names[found.names.index("gyro x.misalignment")] == "gyro x.misalignment"


def test_what_is_not_told_has_no_value() -> None:
    found = align(given(), model=InertialModel.MOUNTING)
    assert found.parameter("E_xz").value is None
    told = {entry["name"]: entry["observable"] for entry in found.to_dict()["parameters"]}
    assert (told["nabla_x"], told["eps_y"]) == (False, True)


def test_a_single_position_is_too_few() -> None:
    with pytest.raises(ScheduleError, match=r"the table rests only at 0°; stop .* at two or more angles"):
        align(given(TurntableProgramme(angles=(0.0,), dwell=100.0, row=0.5)))


def test_a_whole_turn_is_no_second_position() -> None:
    with pytest.raises(ScheduleError, match="two or more angles"):
        align(given(TurntableProgramme(angles=(0.0, 2 * np.pi), dwell=60.0, row=0.5)))


def test_a_block_that_moves_at_a_stop_is_noticed() -> None:
    measured = given()
    moved = measured.readings.copy()
    moved[100:150, 3] += np.radians(2.0)
    with pytest.raises(ScheduleError, match=r"table is at rest in rows 1 to \d+, but the gyros read 2 °/s"):
        align(replace(measured, readings=moved))


def test_a_table_that_counts_the_other_way_is_noticed() -> None:
    measured = given()
    assert measured.turn_angle is not None
    with pytest.raises(ScheduleError, match=r"the table turned -180.0°.* the gyros \+180"):
        align(replace(measured, turn_angle=-measured.turn_angle))


def test_a_block_on_its_side_is_noticed() -> None:
    measured = given()
    sideways = measured.readings[:, [2, 0, 1, 3, 4, 5]]
    with pytest.raises(ScheduleError, match=r"the turn axis .* is 90.0° off the upward vertical"):
        align(replace(measured, readings=sideways))


def test_accelerometers_in_another_unit_are_noticed() -> None:
    measured = given()
    in_g = measured.readings / np.array([G, G, G, 1, 1, 1])
    with pytest.raises(ScheduleError, match="check nominal_scale"):
        align(replace(measured, readings=in_g))


def test_gaps_are_named_with_their_row() -> None:
    measured = given()
    assert measured.time is not None
    late = measured.time + np.where(np.arange(len(measured.time)) >= 41, 3.0, 0.0)
    with pytest.raises(ScheduleError, match=r"time_s, row 42: is 3\.5 s after the row before"):
        align(replace(measured, time=late))


def test_gyros_too_noisy_for_a_heading_are_said() -> None:
    noisy = replace(TYPICAL, gyro=np.radians(0.015))
    with pytest.raises(ScheduleError, match="too uncertain for a heading"):
        align(session(TRUTH, noise=noisy)[0])


def test_another_programme_is_refused() -> None:
    with pytest.raises(ScheduleError, match="an alignment is rotation-alignment"):
        align(replace(given(), programme=ARBITRARY_ORIENTATIONS))


def test_a_file_without_turn_angle_or_times_names_both() -> None:
    document = session_document(given(TurntableProgramme(dwell=20.0, row=1.0)))
    del document["table"]["turn_angle_deg"], document["table"]["time_s"]
    with pytest.raises(FormatError) as caught:
        read_session(document)
    assert {problem.field.rpartition(".")[2] for problem in caught.value.problems} == {"turn_angle_deg", "time_s"}


def test_a_file_without_gyros_is_refused() -> None:
    document = session_document(given(TurntableProgramme(dwell=20.0, row=1.0)))
    document |= {"block": "accelerometer", "sensors": [s for s in document["sensors"] if s["name"].startswith("A")]}
    for name in ("G1", "G2", "G3"):
        del document["table"][name]
    for sensor in document["sensors"]:
        sensor.pop("kind", None)
    with pytest.raises(FormatError, match="none of kind gyroscope; rotation-alignment needs them"):
        read_session(document)


def test_a_stuck_channel_is_named() -> None:
    measured = given()
    stuck = measured.readings.copy()
    stuck[:, 4] = 0.0
    with pytest.raises(ScheduleError, match="G2: has the same reading in every row"):
        align(replace(measured, readings=stuck))


def senseless(measured: CalibrationSession, seed: int) -> CalibrationSession:
    """Some channels coarse and out of scale, and one wild reading."""
    rng = np.random.default_rng(seed)
    readings = measured.readings.copy()
    some = rng.integers(0, 2, 6).astype(bool)
    readings[:, some] = np.round(readings[:, some], rng.integers(0, 6)) * 10.0 ** rng.integers(-6, 7)
    readings[rng.integers(0, len(readings)), rng.integers(0, 6)] += 10.0 ** rng.integers(-6, 18)
    return replace(measured, readings=readings)


def test_senseless_readings_are_refused_or_give_numbers() -> None:
    measured = given(TurntableProgramme(dwell=30.0, row=0.5))
    found = []
    for seed in range(30):
        with suppress(ScheduleError):
            found.append(align(senseless(measured, seed)))
    assert 0 < len(found) < 30
    assert all(np.isfinite(result.estimate).all() for result in found)
    assert all(np.linalg.eigvalsh(result.covariance).min() > -1e-12 for result in found)
