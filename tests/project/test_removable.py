"""Optional parts: each lies by itself, and the service works when it is deleted with the line that registers it."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
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


@dataclass(frozen=True)
class Part:
    """An optional part."""

    places: tuple[str, ...]
    """Its folder."""
    registered: Mapping[str, str] = field(default_factory=dict)
    """By file: the name under which it is registered there, which stands in an import and in a tuple."""


PARTS = {
    "seal": Part(("service/papers/seal",)),
    "exports": Part(("service/papers/onboard",), {"service/all_api.py": "onboard"}),
    "provider": Part(("service/people/oidc",), {"service/all_pages.py": "oidc_pages"}),
}


def unregistered(source: str, name: str) -> str:
    """The source without the import of a name and without the name's place in a tuple."""
    alone = re.sub(rf"^from \S+ import (\w+ as )?{name}\n", "", source, flags=re.MULTILINE)
    return re.sub(rf",? {name}(\.router)?(?=[,\n])", "", alone)


@pytest.mark.parametrize("part", PARTS.values(), ids=PARTS)
def test_the_service_works_without_an_optional_part(part: Part, tmp_path: Path) -> None:
    for folder in ("estimator", "service", "migrations", "tests"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=shutil.ignore_patterns("golden"))
    for place in part.places:
        gone = tmp_path / place
        shutil.rmtree(gone) if gone.is_dir() else gone.unlink()
    for file, name in part.registered.items():
        source = (tmp_path / file).read_text("utf-8")
        left = unregistered(source, name)
        assert left != source
        (tmp_path / file).write_text(left, "utf-8")
    subprocess.run(
        [sys.executable, "-c", WITHOUT], cwd=tmp_path, check=True, env=os.environ | {"PYTHONPATH": str(tmp_path)}
    )
