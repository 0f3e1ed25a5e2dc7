"""`imu-health simulate --hide`: what is hidden is found by the diagnosis, told by the answer file alone, or refused."""

import json
import re
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from estimator.reading import read_session
from service.commands.simulate import FIRST_SESSION, back_from_future
from tests.service.commands.conftest import Run


@pytest.mark.slow
@pytest.mark.parametrize(
    ("cause", "options"),
    [
        ("hysteresis", ["--sensor", "A2"]),
        ("bias-temperature", ["--warming", "3"]),
        ("stand-drift", []),
        ("flip-misalignment", []),
        ("sign-reversed", ["--sensor", "A4"]),
        ("saturation", ["--sensor", "A4", "--seed", "2"]),
        ("excess-noise", ["--sensor", "G2", "--block", "gyroscope"]),
        ("meridian-error", ["--block", "gyroscope"]),
        ("g-sensitivity", ["--programme", "arbitrary-orientations"]),
    ],
)
def test_the_diagnosis_names_what_is_hidden(run: Run, tmp_path: Path, cause: str, options: list[str]) -> None:
    answer = tmp_path / "answer.json"
    ran = run("simulate", "--out", tmp_path, "--hide", cause, *options, "--answer", answer)
    told = json.loads(answer.read_text())
    [diagnosis] = run("diagnose", ran.out.strip(), "--json").documents
    first = diagnosis["findings"][0]
    assert (first["cause"], first["sensors"]) == (cause, told["sensors"]) == (told["cause"], told["sensors"])


def test_a_drift_is_hidden_against_the_sessions_before(run: Run, tmp_path: Path) -> None:
    run("simulate", "--out", tmp_path, "--sessions", 2, "--hide", "sensor-drift", "--sensor", "A5")
    first, last = (tmp_path / f"SIM-001-00{n}.json" for n in (1, 2))
    [diagnosis] = run("diagnose", last, "--history", first, "--json").documents
    assert [(f["cause"], f["sensors"]) for f in diagnosis["findings"]] == [("sensor-drift", ["A5"])]


def test_the_size_that_the_answer_tells_is_the_size_found(run: Run, tmp_path: Path) -> None:
    answer = tmp_path / "answer.json"
    ran = run("simulate", "--out", tmp_path, "--hide", "hysteresis", "--strength", 30, "--answer", answer)
    told = json.loads(answer.read_text())
    [found] = run("diagnose", ran.out.strip(), "--json").documents[0]["findings"]
    assert (told["units"], told["strength"]) == (["m/s²"], 30)
    assert abs(found["amplitude"][0] - told["amplitude"][0]) < 4 * found["sigma"][0]
    assert abs(told["amplitude"][0]) > 20 * found["sigma"][0]


def test_what_cannot_be_as_weak_can_be_had_as_the_refusal_says(run: Run, tmp_path: Path) -> None:
    wish = ("simulate", "--out", tmp_path, "--hide", "saturation", "--sensor", "A3", "--strength")
    [least] = re.findall(r"give --strength (\d+)", run(*wish, 12).err)
    answer = tmp_path / "answer.json"
    assert run(*wish, least, "--answer", answer).code == 0
    assert json.loads(answer.read_text())["strength"] == pytest.approx(int(least), rel=1e-4)


def test_the_limit_of_a_gyro_is_told_as_a_rate(run: Run, tmp_path: Path) -> None:
    answer = tmp_path / "answer.json"
    run("simulate", "--out", tmp_path, "--block", "gyroscope", "--hide", "saturation", "--answer", answer)
    told = json.loads(answer.read_text())
    assert (told["units"], told["shape_units"]) == (["rad/s"], ["rad/s", "side"])


def test_the_answer_counts_rows_as_the_diagnosis_does(run: Run, tmp_path: Path) -> None:
    answer = tmp_path / "answer.json"
    ran = run("simulate", "--out", tmp_path, "--hide", "reading-outlier", "--answer", answer)
    told = json.loads(answer.read_text())
    changed = read_session(ran.out.strip())
    run("simulate", "--out", tmp_path / "plain")
    [row] = np.flatnonzero(
        np.abs(changed.readings - read_session(tmp_path / "plain" / "SIM-001-001.json").readings).max(axis=1)
    )
    assert (told["shape"], told["shape_units"]) == ([row + 1], ["row"])


def test_only_the_effect_tells_it_from_the_session_without_it(run: Run, tmp_path: Path) -> None:
    for folder, hidden in (("plain", []), ("hidden", ["--hide", "reading-outlier", "--sensor", "A3"])):
        run("simulate", "--out", tmp_path / folder, *hidden)
    plain, other = (read_session(tmp_path / folder / "SIM-001-001.json") for folder in ("plain", "hidden"))
    changed = np.argwhere(np.abs(other.readings - plain.readings) > 1e-12)
    assert changed.shape[0] == 1
    assert changed[0, 1] == 2
    assert other.notes == plain.notes == "Simulated."


def test_the_same_seed_hides_the_same_and_nothing_but_the_answer_tells_it(run: Run, tmp_path: Path) -> None:
    options = ("--hide", "random", "--seed", 7)
    quiet = run("simulate", "--out", tmp_path / "a", *options)
    run("simulate", "--out", tmp_path / "b", *options, "--answer", tmp_path / "answer.json")
    first, again = ((tmp_path / folder / "SIM-001-001.json").read_bytes() for folder in "ab")
    told = json.loads((tmp_path / "answer.json").read_text())
    assert first == again
    assert told["strength"] == 12
    assert told["cause"] not in quiet.out + quiet.err + first.decode()


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--hide", "bias-temperature"], "needs temperature, which is not there; give --warming 3"),
        (["--hide", "sensor-drift"], "needs history, which is not there; give --sessions 2"),
        (["--hide", "vibration-rectification"], "needs vibration"),
        (["--hide", "meridian-error"], "is of a gyroscope, and the block has none; give --block gyroscope"),
        (["--hide", "latitude-entry", "--block", "gyroscope"], "needs history, which is not there; give --sessions 2"),
        (["--hide", "g-sensitivity", "--block", "gyroscope"], "give --programme arbitrary-orientations"),
        (["--hide", "excess-noise", "--strength", "1e9"], "would not reach 1e+09 standard errors"),
        (["--hide", "saturation", "--strength", "1e9"], "would not reach 1e+09 standard errors"),
        (["--hide", "saturation", "--strength", "12"], "two positions at least"),
        (["--hide", "axis-wobble", "--sensor", "A2"], "common to all sensors"),
        (["--hide", "hysteresis", "--strength", "1e6"], "would not reach 1e+06 standard errors"),
        (["--hide", "hysteresis", "--sensor", "A7"], "the block has A1 to A6"),
        (["--hide", "runs-swapped", "--strength", "5"], "is there or not"),
        (["--hide", "hysteresis", "--programme", "in-service"], "in-service shows none"),
        (["--hide", "lever-arm"], "--lever-arm A2=4,-1.5"),
    ],
)
def test_what_cannot_be_hidden_is_refused_with_the_reason(
    run: Run, tmp_path: Path, options: list[str], reason: str
) -> None:
    ran = run("simulate", "--out", tmp_path / "none", *options)
    assert ran.code == 2
    assert reason in ran.err
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize(
    "options",
    [
        ["--hide", "gremlins"],
        ["--strength", "5"],
        ["--hide", "hysteresis", "--sensor", "2"],
        ["--block", "gyroscope", "--programme", "in-service"],
        ["--block", "gyroscope", "--drift", "A1.bias=3"],
    ],
)
def test_options_that_make_no_sense_are_an_error_of_use(run: Run, tmp_path: Path, options: list[str]) -> None:
    assert run("simulate", "--out", tmp_path / "none", *options).code == 1
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize("programme", ["two-axis-stand", "in-service"])
def test_no_session_is_dated_after_the_clock(programme: str) -> None:
    last = FIRST_SESSION + timedelta(days=180 + 30 * (programme == "in-service"))
    assert back_from_future(9, programme, datetime(2027, 1, 1, tzinfo=UTC)) == timedelta()
    for now in (last - timedelta(seconds=1), datetime(2024, 2, 29, tzinfo=UTC)):
        assert now - timedelta(days=60) < last - back_from_future(9, programme, now) <= now
