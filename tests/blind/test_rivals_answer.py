"""Rivals answer the open benchmark: files as anybody's, thresholds that sound sessions set, runs that go on."""

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

from benchmarks.blind.__main__ import main
from benchmarks.blind.answer import ALARMS, Look, Threshold, looks
from benchmarks.blind.folder import Answers, read_answers
from benchmarks.blind.regression import FEWER, kept_terms
from benchmarks.blind.subspaces import log_tail
from benchmarks.details import DOCS, RESULTS
from tests.blind.catalogue import CATALOGUE

BY = ("matched-subspaces", "cusum")
SESSIONS = ("--sessions", "6", "--seed", "12")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Six sessions, and beside them five sound ones and what two rivals answer."""
    made = tmp_path_factory.mktemp("rivals") / "blind"
    main(["write", str(made), *SESSIONS])
    main(["write", str(made.with_name("sound")), "--sound", "--sessions", "5", "--seed", "4"])
    given = ["--sound", str(made.with_name("sound")), "--processes", "1", "--out", str(made.with_name("a.json"))]
    main(["answer", str(made), "--by", *BY, *given])
    return made


def answers(folder: Path, name: str) -> Answers:
    return read_answers(folder.with_name(f"a-{name}.json"))


@pytest.mark.parametrize("name", BY)
def test_an_answer_is_one_that_anybody_might_give(folder: Path, name: str) -> None:
    given = answers(folder, name)
    assert (given.by, len(given.answers)) == (name, 6)
    for number, answer in given.answers.items():
        sensors = {s["name"] for s in json.loads((folder / number / "session.json").read_text())["sensors"]}
        for finding in answer["findings"]:
            assert finding["cause"] in CATALOGUE
            assert set(finding["sensors"]) <= sensors


def test_each_rival_names_what_it_can(folder: Path) -> None:
    findings = {
        name: [f["cause"] for a in answers(folder, name).answers.values() for f in a["findings"]] for name in BY
    }
    assert len(findings["matched-subspaces"]) >= 3
    assert set(findings["cusum"]) <= {"sensor-drift"}


def test_the_table_has_a_column_for_each(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["table", str(folder), *(str(folder.with_name(f"a-{name}.json")) for name in BY)])
    printed = capsys.readouterr().out
    assert "| mark | matched-subspaces | cusum |" in printed
    assert "| CUSUM of each parameter over the history |" in printed


def test_the_documentation_shows_what_the_whole_table_begins_with() -> None:
    name = Path("diagnosis") / "blind.md"
    _, _, short, *_ = (RESULTS / name).read_text("utf-8").split("\n\n")
    assert short.startswith("| by |")
    assert short in (DOCS / name).read_text("utf-8")


def test_a_run_that_was_cut_off_goes_on(folder: Path, tmp_path: Path) -> None:
    parts = tmp_path / "parts"
    whole = list(looks(folder, ["chi-square"], parts, 1))
    kept = parts.read_text().splitlines()
    parts.write_text("\n".join([*kept[:3], '{"chi-square": {"record": [], "claims": []}}']) + "\n")
    again = list(looks(folder, ["chi-square"], parts, 1))
    assert [look["chi-square"]["claims"] for look in again] == [
        *([list(c) for c in look["chi-square"]["claims"]] for look in whole[:3]), [],
        *(look["chi-square"]["claims"] for look in whole[4:]),
    ]  # fmt: skip
    with pytest.raises(ValueError, match="run by others"):
        next(looks(folder, ["cusum"], parts, 1))


def claiming(statistics: Sequence[float], cause: str = "bias-ramp") -> Look:
    """A look with claims."""
    return {
        name: {"record": [], "claims": [[s, {"cause": cause}] for s in statistics]} for name in ("bayes", "given-cause")
    }


def test_one_in_a_hundred_sound_sessions_passes() -> None:
    rng = np.random.default_rng(2)
    sound = [claiming([x, x - 1]) for x in rng.normal(size=1000)]
    passing = [Threshold.of("bayes", sound).answer(look["bayes"], []) for look in sound]
    assert 0.005 <= np.mean([bool(a["findings"]) for a in passing]) <= ALARMS


def test_who_is_given_cause_the_cause_names_no_other() -> None:
    threshold = Threshold.of("given-cause", [claiming([0.0, 1.0])])
    look = claiming([5.0])["given-cause"]
    assert threshold.answer(look, ["bias-ramp"])["findings"] == [{"cause": "bias-ramp"}]
    assert threshold.answer(look, ["bias-jump"])["findings"] == []


def test_a_rival_without_sound_sessions_is_refused(folder: Path) -> None:
    with pytest.raises(SystemExit, match="--sound"):
        main(["answer", str(folder), "--by", "sparse"])


def test_the_regression_keeps_the_term_that_acts_the_longest() -> None:
    rng = np.random.default_rng(1)
    library = rng.normal(size=(60, 200))
    z = 7 * library[:, 5] / np.linalg.norm(library[:, 5]) + rng.normal(0, 0.3, 60)
    kept = dict(kept_terms(library, z))
    strictest = max(cut for cut, terms in kept.items() if len(terms))
    assert list(kept[strictest]) == [5]
    assert len(kept[FEWER[-1]]) > 1


def test_the_tail_goes_on_where_numbers_end() -> None:
    freedom = np.array([1, 2, 3, 4])
    assert log_tail(np.full(4, 30.0), freedom) == pytest.approx(chi2.logsf(30.0, freedom), rel=1e-9)
    assert log_tail(np.full(4, 1200.0), freedom) == pytest.approx(chi2.logsf(1200.0, freedom), rel=1e-5)
    assert (np.diff(log_tail(np.array([1100.0, 1200, 5000, 40000]), np.full(4, 2))) < 0).all()
