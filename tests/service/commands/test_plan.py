"""`imu-health plan`: a proposal without a file, a judgement with one, ranks of orientations."""

import json
from pathlib import Path

import numpy as np
import pytest

from tests.builders import arbitrary_orientations
from tests.service.commands.conftest import Run, write


def test_a_block_on_a_cone_is_planned_without_a_file(run: Run) -> None:
    ran = run("plan", "--json")
    [document] = ran.documents
    assert ran.code == 0
    assert document["positions"] == 24
    assert document["elevation_deg"] == pytest.approx(39.4, abs=0.5)
    assert document["formula_elevation_deg"] == pytest.approx(40.0, abs=0.1)
    assert document["unseen"] == []


def test_tolerances_ask_for_more_positions(run: Run) -> None:
    few, many = (run("plan", "--alpha", 40, "--tolerance", f"bias={bias}", "--json").documents[0] for bias in (50, 12))
    assert few["positions"] < many["positions"]
    assert few["reached"]
    assert many["seconds"] == 2 * many["positions"] * 120


def test_a_session_gives_its_block_stand_and_noise(run: Run, good_file: Path) -> None:
    [document] = run("plan", good_file, "--positions", 12, "--json").documents
    [calibration] = run("calibrate", good_file, "--json").documents
    planned = {p["sensor"]: p["sigma"] for p in document["parameters"] if p["parameter"] == "bias"}
    measured = {s["name"]: s["bias"]["sigma"] for s in calibration["sensors"]}
    assert planned.keys() == measured.keys()
    rows = len(calibration["residuals"]["value"])
    expected = measured["A1"] * (rows / 24) ** 0.5
    assert planned["A1"] == pytest.approx(expected, rel=0.15)


def test_people_read_tables(run: Run) -> None:
    ran = run("plan", "--alpha", 40, "--tolerance", "bias=50", "--runs", "direct", "-n", 12)
    assert "do not reach the tolerance of bias" in ran.out
    assert "of 50\u202fµg, undecidable" in ran.out
    assert "the session lacks both runs" in ran.out
    assert "Not observable: scale and bias and axis of every sensor" in ran.out


def test_orientations_are_proposed_for_four_sensors(run: Run) -> None:
    [document] = run("plan", "-m", 4, "--orientations", 9, "--json").documents
    assert (document["rank"], document["parameters"], document["full"]) == (13, 13, True)
    assert np.linalg.norm(document["directions"], axis=1) == pytest.approx(np.ones(9))


def test_a_session_in_orientations_is_ranked_and_completed(run: Run, tmp_path: Path) -> None:
    t = np.arange(8) * np.pi / 4
    zero = np.zeros(8)
    planes = np.concatenate([np.stack([np.sin(t), zero, np.cos(t)], -1), np.stack([zero, np.sin(t), np.cos(t)], -1)])
    document = arbitrary_orientations(orientations=16, direction_sigma_deg=1.0)
    document["table"] |= {f"direction_{axis}": planes[:, k].tolist() for k, axis in enumerate("xyz")}
    file = write(tmp_path, "planes.json", document)
    [ranked] = run("plan", file, "--json").documents
    assert ranked["parameters"] - ranked["rank"] == 1
    assert len(ranked["add"]) == 1
    assert "leave something open" in run("plan", file).out


def test_an_unusable_file_is_code_2_and_one_line(run: Run, bad_file: Path, tmp_path: Path) -> None:
    for file in (bad_file, tmp_path / "none.json"):
        ran = run("plan", file)
        assert ran.code == 2
        assert len(ran.err.splitlines()) == 1
        assert str(file) in ran.err


@pytest.mark.parametrize(
    "arguments",
    [("--tolerance", "colour=1"), ("--tolerance", "bias"), ("--tolerance", "bias=-1"), ("--alpha", 95), ("-n", 1)],
)
def test_what_makes_no_sense_is_refused(run: Run, arguments: tuple[object, ...]) -> None:
    ran = run("plan", *arguments)
    assert ran.code == 1
    assert ran.err


def test_the_json_is_strict(run: Run) -> None:
    out = run("plan", "--runs", "direct", "-n", 8, "--json").out
    assert json.loads(out, parse_constant=lambda name: pytest.fail(name))["conditioning"] is None
