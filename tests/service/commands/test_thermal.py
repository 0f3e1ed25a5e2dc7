"""Thermal sessions by command: simulated, calibrated, planned."""

from pathlib import Path
from typing import Any

import pytest

from tests.service.commands.conftest import Run

Simulated = tuple[Path, dict[str, Any]]


@pytest.fixture
def file(run: Run, tmp_path: Path) -> Simulated:
    """A simulated session with its truth."""
    ran = run("simulate", "--programme", "thermal", "-m", 3, "-n", 9, "--out", tmp_path, "--json")
    [truth] = ran.documents
    return Path(truth["file"]), truth


def test_a_simulated_session_gives_back_its_truth(run: Run, file: Simulated) -> None:
    path, truth = file
    [found] = run("calibrate", path, "--json").documents
    first = found["thermal"]["sensors"][0]
    line = first["bias"]["coefficients"][1]
    sigma = first["bias"]["covariance"][1][1] ** 0.5
    assert abs(line - truth["bias_by_temperature"][0][0]) < 4 * sigma
    assert found["thermal"]["findings"] == []


def test_the_table_says_what_temperature_does(run: Run, file: Simulated) -> None:
    said = run("calibrate", file[0]).out
    assert "changes from 20 °C" in said
    assert "scale factor" in said


def test_a_plan_tells_the_bands_of_soaks(run: Run) -> None:
    [found] = run("plan", "-m", 3, "--temperatures", "20,-40,0,40,70", "--json").documents
    bias = found["thermal"]["sensors"][0]["bias"]
    assert bias["order"] == 3
    assert 0 < bias["covariance"][0][0] ** 0.5 < 1e-3
