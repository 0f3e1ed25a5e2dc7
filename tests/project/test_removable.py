"""Optional parts: each lies by itself, and the service works when it is deleted with the line that registers it."""

import os
import re
import shutil
import subprocess
import sys
from itertools import permutations
from pathlib import Path

import pytest

from tests.project.source import ROOT

WITHOUT = """
from importlib import import_module
from pathlib import Path

from service.app import create_app
from service.settings import Settings
from service.storage.schema import upgrade
from tests.project.source import modules
from tests.serving import http_client

for module in modules("estimator", "service"):
    if not module.name.endswith("__main__"):
        import_module(module.name)
settings = Settings(database_url="sqlite:///service.sqlite", data_folder=Path("data"), diagnosis_workers=0)
upgrade(settings.database)
with http_client(create_app(settings)) as client:
    for path in ("/healthz", "/readyz", "/upload", "/openapi.json"):
        client.get(path).raise_for_status()
"""
"""Imports all that is left, starts the service, and asks it for a few answers."""


PARTS: dict[str, dict[str, str]] = {
    "service/papers/seal": {},
    "service/papers/onboard": {"service/all_api.py": "onboard"},
    "service/people/oidc": {"service/all_pages.py": "oidc_pages"},
}
"""Folders; by file the name under which each is registered there, which stands in an import and in a tuple."""


def unregistered(source: str, name: str) -> str:
    """The source without the import of a name and without the name's place in a tuple."""
    alone = re.sub(rf"^from \S+ import (\w+ as )?{name}\n", "", source, flags=re.MULTILINE)
    return re.sub(rf",? {name}(\.router)?(?=[,\n])", "", alone)


def test_the_service_works_without_its_optional_parts(tmp_path: Path) -> None:
    for folder in ("estimator", "service", "migrations", "tests"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=shutil.ignore_patterns("golden"))
    for place, registered in PARTS.items():
        shutil.rmtree(tmp_path / place)
        for file, name in registered.items():
            source = (tmp_path / file).read_text("utf-8")
            left = unregistered(source, name)
            assert left != source
            (tmp_path / file).write_text(left, "utf-8")
    subprocess.run(
        [sys.executable, "-c", WITHOUT], cwd=tmp_path, check=True, env=os.environ | {"PYTHONPATH": str(tmp_path)}
    )


@pytest.mark.parametrize(("part", "other"), [*permutations(PARTS, 2)])
def test_an_optional_part_does_not_need_another(part: str, other: str) -> None:
    assert not [file for file in (ROOT / part).rglob("*.py") if other.replace("/", ".") in file.read_text("utf-8")]
