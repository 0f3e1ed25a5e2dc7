"""`imu-health simulate`: files that say the truth when they are calibrated."""

import json
from pathlib import Path

import numpy as np
import pytest

from estimator import calibrate, parity_check
from estimator.reading import read_session
from tests.service.commands.conftest import Run


def test_a_calibration_finds_the_printed_truth(run: Run, tmp_path: Path) -> None:
    ran = run("simulate", "--out", tmp_path, "--positions", 24, "--seed", 5, "--json")
    [truth] = ran.documents
    found = calibrate(read_session(truth["file"]))
    pulls = [
        (getattr(sensor, name).value - true[name]) / getattr(sensor, name).sigma
        for sensor, true in zip(found.sensors, truth["sensors"], strict=True)
        for name in ("scale", "bias", "quadratic")
    ]
    assert np.abs(pulls).max() < 4


def test_the_same_seed_gives_the_same_bytes_and_another_seed_others(run: Run, tmp_path: Path) -> None:
    for folder, seed in (("a", 1), ("b", 1), ("c", 2)):
        run("simulate", "--out", tmp_path / folder, "--seed", seed)
    first, again, other = ((tmp_path / folder / "SIM-001-001.json").read_bytes() for folder in "abc")
    assert first == again != other


def test_two_units_with_the_same_seed_are_two_units(run: Run, tmp_path: Path) -> None:
    first, other = (
        json.loads(Path(run("simulate", "--unit", unit, "--out", tmp_path, "--json").documents[0]["file"]).read_text())
        for unit in ("BA-101", "BA-102")
    )
    assert first["table"]["A1"] != other["table"]["A1"]


def test_a_long_series_ends_where_a_short_one_does(run: Run, tmp_path: Path) -> None:
    def dates(sessions: int) -> list[str]:
        own = ("--sessions", sessions, "-n", 3, "--json", "--out", tmp_path / str(sessions))
        files = [document["file"] for document in run("simulate", *own).documents]
        return [json.loads(Path(file).read_text())["started_at"] for file in files]

    assert dates(9)[-4:] == dates(4)
    assert dates(2) == ["2026-01-12T09:00:00Z", "2026-03-13T09:00:00Z"]


def test_the_options_shape_the_session(run: Run, tmp_path: Path) -> None:
    run("simulate", "--out", tmp_path, "-m", 4, "-n", 10, "--noise", 5, "--unit", "X/1")
    document = json.loads((tmp_path / "X_1-001.json").read_text())
    assert document["unit"] == "X/1"
    assert document["stand"]["alpha_deg"] == 40
    assert len(document["sensors"]) == 4
    assert document["table"]["beta_deg"][:3] == [0.0, 36.0, 72.0]
    assert document["table"]["A1_se"][0] == pytest.approx(5 * 9.80665e-6 * 0.12)


def test_a_drift_moves_the_truth_from_session_to_session(run: Run, tmp_path: Path) -> None:
    ran = run("simulate", "--out", tmp_path, "--sessions", 3, "--drift", "A3.bias=20", "--json")
    biases = [document["sensors"][2]["bias"] for document in ran.documents]
    assert np.diff(biases) == pytest.approx([20e-6 * 9.815] * 2, rel=1e-3)
    assert len({document["sensors"][1]["bias"] for document in ran.documents}) == 1


@pytest.mark.parametrize("drift", ["A3.bias", "A3.colour=1", "A0.bias=1", "A7.bias=1"])
def test_a_drift_that_makes_no_sense_is_refused(run: Run, tmp_path: Path, drift: str) -> None:
    ran = run("simulate", "--out", tmp_path / "none", "--drift", drift)
    assert ran.code == 1
    assert "A3.bias=20" in ran.err or "A1 to A6" in ran.err
    assert not (tmp_path / "none").exists()


def test_a_flight_of_the_block_on_the_stand_shows_its_drift(run: Run, tmp_path: Path) -> None:
    block = ("--out", tmp_path, "--unit", "F-1", "--seed", 7)
    run("simulate", *block)
    [truth] = run("simulate", *block, "--programme", "in-service", "--drift", "A2.bias=200", "--json").documents
    found = parity_check(read_session(truth["file"]), calibrate(read_session(tmp_path / "F-1-001.json")))
    bias = found.sensor("A2").bias
    assert (found.isolated, bias.sigma is not None) == ("A2", True)
    assert abs((bias.size or 0.0) - 200e-6 * 9.815) < 4 * (bias.sigma or 0.0)


@pytest.mark.parametrize("programme", ["rotation-alignment", "rate-table"])
def test_a_turntable_session_says_the_truth(run: Run, tmp_path: Path, programme: str) -> None:
    [truth] = run("simulate", "--out", tmp_path, "--programme", programme, "--json").documents
    found = calibrate(read_session(truth["file"]))
    for axis, mounting, drift in zip("xy", truth["mounting"], truth["gyro_bias"][:2], strict=True):
        gyro = found.sensor(f"gyro {axis}")
        assert gyro.misalignment is not None
        for estimate, true in ((gyro.misalignment, mounting), (gyro.bias, drift)):
            assert abs(estimate.value - true) < 4 * estimate.sigma


def test_a_hidden_lever_arm_is_found_again(run: Run, tmp_path: Path) -> None:
    options = ("--programme", "rotation-alignment", "--lever-arm", "A2=4,-1.5")
    [truth] = run("simulate", "--out", tmp_path, *options, "--json").documents
    assert truth["positions_m"][1] == pytest.approx([0.04, -0.015, 0.0])
    [found] = run("diagnose", truth["file"], "--json").documents
    [finding] = found["findings"]
    assert (finding["cause"], finding["sensors"]) == ("lever-arm", ["A2"])
    apart = (np.array(finding["amplitude"]) - [0.04, -0.015]) / finding["sigma"]
    assert np.abs(apart).max() < 4


@pytest.mark.parametrize(("programme", "lever"), [("rotation-alignment", "A4=1,2"), ("rate-table", "A2=1,2")])
def test_a_lever_arm_that_nothing_would_show_is_refused(run: Run, tmp_path: Path, programme: str, lever: str) -> None:
    ran = run("simulate", "--out", tmp_path / "none", "--programme", programme, "--lever-arm", lever)
    assert ran.code == 1
    assert not (tmp_path / "none").exists()


def test_what_a_programme_does_not_show_cannot_drift_in_it(run: Run, tmp_path: Path) -> None:
    for options in (("rotation-alignment", "A3.bias=1"), ("rate-table", "A1.scale=1"), ("flying", "A1.bias=1")):
        ran = run("simulate", "--out", tmp_path / "none", "--programme", options[0], "--drift", options[1])
        assert ran.code == 1
        assert not (tmp_path / "none").exists()
