"""The words are true: every command and every example of the README and the documentation runs as pasted."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from service.cli import app
from service.settings import Settings
from tests.databases import Databases
from tests.serving import serving

PROJECT = Path(__file__).parents[2]
README = PROJECT / "README.md"
PAGES = [README, PROJECT / "CHANGELOG.md", PROJECT / "CONTRIBUTING.md", *sorted((PROJECT / "docs").rglob("*.md"))]
ADDRESS = "http://127.0.0.1:8000"
BIN = Path(sys.executable).parent
MAKE = re.compile(r"^make \w+.*$", re.MULTILINE)


def blocks(page: Path, language: str) -> list[str]:
    """The fenced blocks of a language, in order."""
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)


@pytest.fixture
def address(sqlite: Databases, tmp_path: Path) -> Iterator[str]:
    """A running service on an empty database."""
    with serving(Settings(database_url=sqlite.migrated(), data_folder=tmp_path / "data")) as address:
        yield address


def execute(command: list[str], folder: Path, address: str) -> str:
    """What a command prints, run in a folder; it must succeed."""
    environment = {**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}", "IMU_HEALTH_SERVER": address}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{command[-1]}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def shell(page: Path, folder: Path, address: str) -> str:
    """Runs the page's shell examples one after another, as a reader would; `make` is left to continuous integration."""
    script = "set -e\n" + "\n".join(blocks(page, "sh")).replace(ADDRESS, address).replace(".venv/bin/", "")
    return execute(["bash", "-o", "pipefail", "-c", MAKE.sub("", script)], folder, address)


def test_the_readme_s_examples_work_as_pasted(address: str, tmp_path: Path) -> None:
    shown = shell(README, tmp_path, address)
    assert "BA-900" in shown
    over_http, in_python = blocks(README, "python")
    answer = execute([sys.executable, "-c", over_http.replace(ADDRESS, address)], tmp_path, address)
    assert answer.startswith("BA-900 fail")
    assert answer.count(",A3,accelerometer,bias,") == 3
    assert "±" in execute([sys.executable, "-c", in_python], tmp_path, address)


def test_the_readme_s_api_example_has_five_lines() -> None:
    assert len([line for line in blocks(README, "python")[0].splitlines() if line]) == 5


@pytest.mark.parametrize("page", ["api.md", "quickstart.md", "reports.md"])
def test_the_examples_of_a_page_work_as_pasted(page: str, address: str, tmp_path: Path) -> None:
    assert "BA-900" in shell(PROJECT / "docs" / page, tmp_path, address)


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
    targets = re.findall(r"\]\(([^)#\s]+)", page.read_text(encoding="utf-8"))
    missing = [t for t in targets if "://" not in t and not (page.parent / t).exists()]
    assert not missing
