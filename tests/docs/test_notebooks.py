"""The notebooks: each runs against a real service, and what is stored in it is what that prints.

`IMU_HEALTH_PICTURES=1`, as `make pictures` sets it, writes into the notebook what it printed and drew.
"""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbformat
import pytest

from service.settings import Settings
from tests.databases import Databases
from tests.serving import serving

PROJECT = Path(__file__).parents[2]
NOTEBOOKS = sorted((PROJECT / "docs" / "notebooks").glob("*.ipynb"))
FRUGAL = {"JUPYTER_PLATFORM_DIRS": "1", "PYDEVD_DISABLE_FILE_VALIDATION": "1", "IPYTHONDIR": ".ipython"}


@pytest.fixture
def address(sqlite: Databases, tmp_path: Path) -> Iterator[str]:
    """A running service on an empty database."""
    with serving(Settings(database_url=sqlite.migrated(), data_folder=tmp_path / "data")) as url:
        yield url


def executed(notebook: Path, folder: Path, address: str) -> Any:
    """The notebook after all its cells were run, in a folder and a process of its own."""
    copy = folder / notebook.name
    shutil.copyfile(notebook, copy)
    command = [sys.executable, "-m", "jupyter", "execute", "--inplace", "--kernel_name=python3", str(copy)]
    environment = os.environ | FRUGAL | {"IMU_HEALTH_SERVER": address, "PYTHONPATH": str(PROJECT)}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    if os.environ.get("IMU_HEALTH_PICTURES"):
        for cell in (found := nbformat.read(copy, 4)).cells:
            cell.metadata.clear()  # when it was run
        nbformat.write(found, notebook)
    return nbformat.read(copy, 4)


def printed(notebook: Any) -> list[str]:
    """Printed text of every cell."""
    outputs = (cell.outputs for cell in notebook.cells if cell.cell_type == "code")
    return ["".join(one.text for one in found if one.output_type == "stream") for found in outputs]


def drawn(notebook: Any) -> int:
    """Number of pictures."""
    cells = (cell for cell in notebook.cells if cell.cell_type == "code")
    return sum("image/png" in one.get("data", {}) for cell in cells for one in cell.outputs)


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_shows_what_it_prints(notebook: Path, address: str, tmp_path: Path) -> None:
    found = executed(notebook, tmp_path, address)
    stored = nbformat.read(notebook, 4)
    assert printed(found) == printed(stored)
    assert drawn(found) == drawn(stored) == 2


def test_the_cause_that_was_hidden_is_named_with_its_size() -> None:
    text = "\n".join(printed(nbformat.read(NOTEBOOKS[0], 4)))
    assert "the bias of A2 drifts steadily during the session" in text
    assert "hidden 120 µg" in text
