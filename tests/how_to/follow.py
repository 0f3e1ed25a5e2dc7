"""A how-to page's own code blocks, put into a copy of the source: page and test cannot part.

The paragraph before a block names the file: a block of ``python`` or ``html`` is the whole new file, a block of
``diff`` changes a file that is there, wherever its unchanged lines stand.
"""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

PROJECT = Path(__file__).parents[2]
COPIED = ("estimator", "service", "migrations", "benchmarks", "docs/diagnosis")
STEP = re.compile(r"`([\w./-]+\.\w+)`[^`\n]*:\n\n```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
SHELL = re.compile(r"^```sh\n(.*?)^```$", re.DOTALL | re.MULTILINE)
VERSIONS = PROJECT / "migrations" / "versions"
BIN = Path(sys.executable).parent


@dataclass(frozen=True)
class House:
    """A copy of the source in which a page was followed."""

    root: Path
    page: str
    """Text of the page; of several, of the last."""

    @property
    def environment(self) -> dict[str, str]:
        """Environment in which the copy comes before the source itself."""
        path = f"{BIN}:{os.environ['PATH']}"
        return {**os.environ, "PATH": path, "PYTHONPATH": str(self.root), "COLUMNS": "200"}

    def run(self, *command: str) -> str:
        """Output of a command in the copy; it must succeed."""
        done = subprocess.run(command, cwd=self.root, env=self.environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
        return plain(done.stdout)

    def shell(self) -> str:
        """Output of the page's shell examples, one after another."""
        return self.run("bash", "-e", "-o", "pipefail", "-c", "\n".join(SHELL.findall(self.page)))

    @contextmanager
    def serving(self) -> Iterator[str]:
        """The address of the copy's service on an empty database."""
        command = ("imu-health", "serve", "--port", "0", "--data-folder", "data")
        with subprocess.Popen(
            command, cwd=self.root, env=self.environment, stdout=subprocess.PIPE, text=True
        ) as process:
            try:
                assert process.stdout is not None
                yield process.stdout.readline().split()[-1]
            finally:
                process.terminate()


def plain(text: str) -> str:
    """Text with ordinary spaces between numbers and units."""
    return text.replace("\N{NO-BREAK SPACE}", " ").replace("\N{NARROW NO-BREAK SPACE}", " ")


def followed(folder: Path, *names: str) -> House:
    """A copy of the source in which every step of some pages was done."""
    for part in COPIED:
        shutil.copytree(PROJECT / part, folder / part)
    for name in names:
        page = (PROJECT / "docs" / "how-to" / f"{name}.md").read_text(encoding="utf-8")
        for path, language, block in STEP.findall(page):
            write(folder / path, language, block)
    for new in (folder / "migrations" / "versions").glob("0100_*.py"):  # after the latest that there is
        latest = max(file.name[:4] for file in VERSIONS.glob("0*.py"))
        moved = re.sub('down_revision = "[0-9]+"', f'down_revision = "{latest}"', new.read_text("utf-8"))
        new.write_text(moved, "utf-8")
    return House(folder, page)


def write(file: Path, language: str, block: str) -> None:
    """One step: a new file, or a change of one."""
    if language != "diff":
        assert not file.exists(), f"{file} is there already"
        file.write_text(block, encoding="utf-8")
        return
    lines = [(line[:1], line[1:]) for line in block.splitlines()]
    before, after = ("".join(f"{text}\n" for sign, text in lines if sign != skipped) for skipped in "+-")
    source = file.read_text(encoding="utf-8")
    assert source.count(before) == 1, f"{file} does not hold these lines once:\n{before}"
    file.write_text(source.replace(before, after), encoding="utf-8")
