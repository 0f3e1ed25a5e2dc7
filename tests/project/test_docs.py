"""The words are true: every command and every example of the README and the documentation runs as pasted."""

import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from service.cli import app
from service.settings import Settings
from tests.databases import Databases
from tests.docs.preloaded import preloaded
from tests.serving import serving

PROJECT = Path(__file__).parents[2]
README = PROJECT / "README.md"
WRITTEN = sorted([*(PROJECT / "docs").rglob("*.md"), *(PROJECT / "benchmarks" / "results").rglob("*.md")])
PAGES = [README, PROJECT / "CHANGELOG.md", PROJECT / "CONTRIBUTING.md", *WRITTEN]
ADDRESS = "http://127.0.0.1:8000"
BIN = Path(sys.executable).parent
Shell = Callable[[Path], str]
ROLES = ("bench-crew", "engineer", "fleet-manager", "administrator")
MAKE = re.compile(r"^make \w+.*$", re.MULTILINE)


def blocks(page: Path, language: str) -> list[str]:
    """The fenced blocks of a language, in order."""
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)


@pytest.fixture
def address(sqlite: Databases, tmp_path: Path) -> Iterator[str]:
    """A running service on an empty database."""
    with serving(Settings(database_url=sqlite.migrated(), data_folder=tmp_path / "data")) as address:
        yield address


@pytest.fixture(scope="module")
def commands(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The folder of an `imu-health` that is loaded already."""
    with preloaded(tmp_path_factory.mktemp("commands")) as folder:
        yield folder


@pytest.fixture
def shell(commands: Path, address: str, tmp_path: Path) -> Shell:
    """Runs a page's shell examples one after another, as a reader would; `make` is left to continuous integration."""

    def run(page: Path) -> str:
        script = "set -e\n" + "\n".join(blocks(page, "sh")).replace(ADDRESS, address).replace(".venv/bin/", "")
        return execute(["bash", "-o", "pipefail", "-c", MAKE.sub("", script)], tmp_path, address, commands)

    return run


def execute(command: list[str], folder: Path, address: str, first: Path = BIN) -> str:
    """Output of a command, run in a folder; it must succeed."""
    path = f"{first}:{BIN}:{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "IMU_HEALTH_SERVER": address, "LANGUAGE": "en"}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{command[-1]}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def test_the_readme_s_examples_work_as_pasted(shell: Shell, address: str, tmp_path: Path) -> None:
    shown = shell(README)
    assert "BA-900" in shown
    over_http, in_python = blocks(README, "python")
    answer = execute([sys.executable, "-c", over_http.replace(ADDRESS, address)], tmp_path, address)
    assert answer.startswith("BA-900 fail")
    assert answer.count(",A3,accelerometer,bias,") == 3
    assert "±" in execute([sys.executable, "-c", in_python], tmp_path, address)


def test_the_readme_s_api_example_has_five_lines() -> None:
    assert len([line for line in blocks(README, "python")[0].splitlines() if line]) == 5


@pytest.mark.parametrize("page", ["api.md", "how-to/command-line.md", "reports.md"])
def test_the_examples_of_a_page_work_as_pasted(page: str, shell: Shell) -> None:
    assert "BA-900" in shell(PROJECT / "docs" / page)


def test_what_every_role_needs_works_as_pasted(shell: Shell) -> None:
    crew, engineer, fleet, administrator = (shell(PROJECT / "docs" / "how-to" / f"{role}.md") for role in ROLES)
    assert '"kind":"repair"' in crew
    assert "beyond the tolerance" in engineer
    assert "FM-100  " in fleet
    assert '"broken":null' in administrator


def test_every_call_of_the_api_is_described(address: str, tmp_path: Path) -> None:
    text = (PROJECT / "docs" / "api.md").read_text(encoding="utf-8")
    listed = execute(["curl", "-s", f"{address}/openapi.json"], tmp_path, address)
    paths = set(re.findall(r'"(/[^"]*)": ?\{"(?:get|post|put|delete|patch)"', listed))
    assert "/api/v1/sessions" in paths
    missing = [path for path in paths if path.removeprefix("/api/v1") not in text]
    assert not missing


def test_every_command_of_the_readme_exists() -> None:
    described = re.findall(
        r"`([a-z ]+?)(?: [A-Z…]+)*`", "\n".join(re.findall(r"^\| (`.*?) \|", README.read_text(), re.M))
    )
    assert {"serve", "calibrate", "upload", "db upgrade"} <= set(described)
    for command in described:
        assert "Usage" in CliRunner().invoke(app, [*command.split(), "--help"]).output, command


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_inside_the_project_lead_somewhere(page: Path) -> None:
    targets = set(re.findall(r"\]\(([^)#\s]+)", page.read_text(encoding="utf-8")))
    missing = [t for t in targets if "://" not in t and not (page.parent / t).exists()]
    assert not missing
