"""The open benchmark: its secret is the published one, its files are of that secret, and marks say what was right."""

import json
from pathlib import Path

import pytest

from benchmarks.blind.__main__ import main
from benchmarks.blind.folder import Answers, Secret, drawn, read_secret, write
from benchmarks.blind.marks import is_wrong, outcomes, right_cause
from tests.blind.case import Case

SECRET = Secret(seed=3, sessions=6)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Six sessions."""
    made = tmp_path_factory.mktemp("benchmark") / "blind"
    assert list(write(made, SECRET)) == [f"{k:05}" for k in range(1, 7)]
    made.with_name("blind.secret.json").write_bytes(SECRET.content)
    return made


def test_nothing_that_is_given_away_tells_the_seed(folder: Path) -> None:
    assert drawn(6, None).seed.bit_length() > 100
    assert json.loads((folder / "benchmark.json").read_text())["commitment"] == SECRET.commitment
    assert {file.name.rstrip("-0123456789.json") for file in folder.glob("*/*")} <= {"sessi", "history"}


def test_another_secret_is_refused(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "s.json").write_bytes(SECRET.content)
    assert read_secret(tmp_path / "s.json", folder) == SECRET
    (tmp_path / "s.json").write_bytes(Secret(4, 6).content)
    with pytest.raises(ValueError, match="is not the secret"):
        read_secret(tmp_path / "s.json", folder)


def truth(case: Case) -> dict[str, object]:
    """The answer of somebody who knows."""
    findings = [{"cause": t.effect.cause, "sensors": list(t.names)} for t in case.truths if case.kind != "outside"]
    return {"findings": findings, "unexplained": case.kind == "outside"}


def test_the_truth_has_all_marks_and_a_wrong_name_none(folder: Path) -> None:
    known = {number: truth(case) for number, case in SECRET.cases()}
    wrong = Answers("guess", {number: {"findings": [{"cause": "no such cause"}]} for number in known})
    for right, guessed in outcomes(folder, SECRET, [Answers("truth", known), wrong]):
        assert right.good
        assert (is_wrong(guessed), right_cause(guessed)) == (True, False)


def test_files_that_somebody_changed_are_refused(folder: Path, tmp_path: Path) -> None:
    file = folder / "00001" / "session.json"
    was = file.read_text()
    document = json.loads(was)
    document["table"][document["sensors"][0]["name"]][0] *= 1.001
    file.write_text(json.dumps(document))
    with pytest.raises(ValueError, match="is not the file"):
        next(outcomes(folder, SECRET, [Answers("", {})]))
    file.write_text(was)


def test_the_commands_write_and_mark(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["write", str(tmp_path / "blind"), "--sessions", "1", "--seed", "5"])
    Answers("nobody", {}).write(tmp_path / "answers.json")
    main(["score", str(tmp_path / "blind"), str(tmp_path / "answers.json")])
    assert "| sound session: something named |" in capsys.readouterr().out
