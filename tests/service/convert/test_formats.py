"""Peculiarities of each public format."""

import numpy as np
import pytest
from scipy.io import savemat

from benchmarks.convert import convert
from estimator.calibration import calibrate
from estimator.errors import FormatError
from estimator.reading import read_session
from tests.service.convert import made


def only(name, paths):
    """The one session of a conversion."""
    ((_, document),) = convert(name, paths)
    return document


def test_imu_tk_finds_rate_and_pairs_the_logs_by_name(tmp_path):
    session = read_session(only("imu-tk", made.imu_tk(tmp_path)[::-1]))
    assert session.sample_rate == pytest.approx(100)
    assert [s.kind for s in session.sensors] == ["accelerometer"] * 3 + ["gyroscope"] * 3
    assert session.sensors[0].nominal_offset == 32768
    assert calibrate(session).sensors[0].scale.value == pytest.approx(415 * 9.81 / 9.81744, rel=1e-3)


def test_imu_tk_names_the_line_where_time_runs_backwards(tmp_path):
    paths = made.imu_tk(tmp_path)
    lines = paths[0].read_text().splitlines()
    lines[40], lines[41] = lines[41], lines[40]
    paths[0].write_text("\n".join(lines))
    with pytest.raises(FormatError, match=r"xsens_acc.mat: time, row 42: does not increase"):
        convert("imu-tk", paths)


def test_imu_tk_refuses_logs_of_different_length(tmp_path):
    paths = made.imu_tk(tmp_path)
    paths[1].write_text("\n".join(paths[1].read_text().splitlines()[:-3]))
    with pytest.raises(FormatError, match=r"has 6997 lines and xsens_acc\.mat has 7000"):
        convert("imu-tk", paths)


def test_imu_tk_names_the_line_with_text(tmp_path):
    paths = made.imu_tk(tmp_path)
    paths[0].write_text("1 2 3 4\n2 3 x 5\n")
    with pytest.raises(FormatError, match=r"xsens_acc.mat: text: .*'x'.* row 1"):
        convert("imu-tk", paths)


def test_five_imus_become_five_triads_and_one_redundant_block(tmp_path):
    sessions = convert("mpu9150-five", made.mpu9150_five(tmp_path))
    assert [name for name, _ in sessions] == [*(f"mpu9150-{k}.json" for k in range(1, 6)), "mpu9150-five.json"]
    block = read_session(sessions[-1][1])
    assert len(block.sensors) == 15
    assert len(block.readings) == 14
    assert not block.is_raw
    np.testing.assert_allclose(block.sensors[3].nominal_axis, [-1, 0, 0], atol=0.01)
    assert calibrate(block).fit.p_value > 1e-3


def test_five_logs_without_a_common_motion_are_refused(tmp_path):
    paths = made.mpu9150_five(tmp_path)
    lines = paths[2].read_text().splitlines()
    paths[2].write_text("\n".join(lines[250:]))
    with pytest.raises(FormatError, match="not one common motion"):
        convert("mpu9150-five", paths)


def test_kth_turned_imus_see_what_the_straight_ones_see(tmp_path):
    session = read_session(only("kth-mimu", made.kth_mimu(tmp_path)))
    assert len(session.sensors) == 48
    axes = np.array([s.nominal_axis for s in session.sensors[:24]])
    scale = np.array([s.nominal_scale for s in session.sensors[:24]])
    force = np.linalg.lstsq(axes, (session.readings[50, :24] / scale), rcond=None)[0]
    np.testing.assert_allclose(axes @ force, session.readings[50, :24] / scale, atol=0.1)


def test_kth_clock_wraps_and_runs_on(tmp_path):
    session = read_session(only("kth-mimu", made.kth_mimu(tmp_path)))
    np.testing.assert_allclose(np.diff(session.time), 0.016, atol=1e-9)


def test_kth_reports_lost_packets(tmp_path):
    path = made.kth_mimu(tmp_path)[0]
    content = path.read_bytes()
    path.write_bytes(content[: 4 + 106 * 50] + content[4 + 106 * 53 :])
    assert "3 lost" in only("kth-mimu", [path])["notes"]


def test_kth_names_the_damaged_packet(tmp_path):
    path = made.kth_mimu(tmp_path)[0]
    content = bytearray(path.read_bytes())
    content[4 + 106 * 7 + 30] ^= 1
    path.write_bytes(bytes(content))
    with pytest.raises(FormatError, match=r"exp_1.data.bin: packet, row 8: at byte 746 is damaged"):
        convert("kth-mimu", [path])


def test_ctu_means_have_no_stated_noise(tmp_path):
    session = read_session(only("ctu-mat", made.ctu_mat(tmp_path)))
    assert np.isnan(session.standard_errors).all()
    assert calibrate(session).sensors[0].scale.value * 9.80665 == pytest.approx(1.002, abs=1e-3)


def test_ctu_names_the_orientation_that_is_no_number(tmp_path):
    path = tmp_path / "means.mat"
    means = made.sphere(12, 0).T
    means[1, 4] = np.nan
    savemat(path, {"ACC_meas": means})
    with pytest.raises(FormatError, match=r"means.mat: ACC_meas, row 5: .*not a finite number"):
        convert("ctu-mat", [path])


def test_ferraris_positions_have_directions_and_turns_are_left_out(tmp_path):
    session = read_session(only("ferraris-csv", made.ferraris_csv(tmp_path)))
    assert len(session.readings) == 1800
    assert np.degrees(session.direction_sigma) == pytest.approx(1)
    assert session.directions[0].tolist() == [-1, 0, 0]
    assert calibrate(session).gauge == "directions"


def test_ferraris_names_the_missing_positions(tmp_path):
    path = made.ferraris_csv(tmp_path)[0]
    path.write_text("\n".join(line for line in path.read_text().splitlines() if not line.startswith("y_a")))
    with pytest.raises(FormatError, match="part: lacks the positions y_a"):
        convert("ferraris-csv", [path])


def test_ferraris_names_the_row_that_is_no_number(tmp_path):
    path = made.ferraris_csv(tmp_path)[0]
    lines = path.read_text().splitlines()
    lines[3] = "x_a,2,,1,2,3,4,5"
    path.write_text("\n".join(lines))
    with pytest.raises(FormatError, match=r"table, row 3: .*not a finite number"):
        convert("ferraris-csv", [path])
