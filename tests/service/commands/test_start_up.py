"""A command imports what it uses: the list of commands none of them, `calibrate` no service."""

import os
import subprocess
import sys
from pathlib import Path
from typing import cast

import pytest
from typer.core import TyperGroup
from typer.main import get_command

from service.cli import app
from service.commands.catalogue import CATALOGUE
from tests.service.commands.conftest import Run

COMMANDS = cast(TyperGroup, get_command(app))


def ran(*arguments: object, **environment: str) -> subprocess.CompletedProcess[str]:
    """`imu-health` in a process of its own, which ends by writing the modules that it has imported as its last line."""
    script = "import sys; sys.argv[0] = 'imu-health'; import service.cli\n"
    script += "try: service.cli.main()\nfinally: print('', *sys.modules, file=sys.stderr)"
    command = [sys.executable, "-c", script, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, env=os.environ | environment)


def loaded(*arguments: object) -> set[str]:
    """Every module that a command has imported by its end."""
    return set(ran(*arguments).stderr.splitlines()[-1].split())


@pytest.mark.parametrize("name", CATALOGUE)
def test_the_catalogue_says_of_a_command_what_it_says_itself(name: str) -> None:
    command = COMMANDS.commands[name]
    assert CATALOGUE[name].says == " ".join((command.help or "").split("\n\n")[0].split())


def test_the_list_shows_every_command_with_what_it_does(run: Run) -> None:
    shown = " ".join(run("--help").out.split())
    assert [name for name, entry in CATALOGUE.items() if f" {name} {entry.says.replace('`', '')}" not in shown] == []


@pytest.mark.parametrize("arguments", [("--help",), ("calibrat",)], ids=["the list", "a mistyped name"])
def test_naming_the_commands_imports_none_of_them(arguments: tuple[str, ...]) -> None:
    seen = loaded(*arguments)
    assert "service.commands.catalogue" in seen
    assert not {"numpy", "rich", "httpx", "service.settings"} & seen


def test_calibrating_imports_neither_service_nor_what_other_programmes_need(good_file: Path) -> None:
    seen = loaded("calibrate", good_file)
    assert "estimator.calibration.stand" in seen
    assert not {"fastapi", "sqlalchemy", "altair", "uvicorn", "polars", "service.settings"} & seen
    assert not {"scipy.stats", "scipy.optimize", "scipy.spatial", "estimator.alignment", "estimator.diagnosis"} & seen


def test_a_service_that_waits_has_not_loaded_what_draws_prints_and_reads_files() -> None:
    script = "import sys, service.app; print(*sys.modules)"
    seen = set(
        subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()
    )
    assert {"service.papers.typeset", "service.sessions.charts", "service.web.files"} <= seen
    assert not {"altair", "polars", "typst", "vl_convert", "pypdf", "h5py", "fastexcel", "httpx", "scipy.stats"} & seen


def test_the_module_runs_like_the_command() -> None:
    command = [sys.executable, "-m", "service.cli", "--help"]
    assert "calibrate" in subprocess.run(command, capture_output=True, text=True, check=True).stdout


def test_a_shell_completes_a_name_without_importing_its_command() -> None:
    asked = ran(_IMU_HEALTH_COMPLETE="complete_bash", COMP_WORDS="imu-health se", COMP_CWORD="1")
    assert asked.stdout.split() == ["serve"]
    assert "numpy" not in asked.stderr.split()


def test_a_shell_completes_the_options_of_a_command() -> None:
    asked = ran(_IMU_HEALTH_COMPLETE="complete_bash", COMP_WORDS="imu-health calibrate --js", COMP_CWORD="2")
    assert asked.stdout.split() == ["--json"]
