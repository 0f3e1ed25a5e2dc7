"""The pages as the generator takes them: docs/, what stands beside it, and what was made from the code."""

import json
import os
import re
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

BESIDE = {"CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md"}
"""Pages outside docs/, and what they are called in the site."""
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s#]*)(#[^)\s]*)?\)")
"""Text, target and anchor of a link; the text may hold an image."""
RESULTS = "benchmarks/results"
"""The folder of measurements in full, copied as `results`."""
GENERATED = "## Reference\n"
"""The heading of docs/index.md below which the pages made from the code are listed."""


def stage(project: Path, target: Path, made: Mapping[str, tuple[str, str]]) -> None:
    """Copies and writes every page; ``made`` has, by path, the line of the index and the text."""
    shutil.copytree(project / "docs", target, ignore=shutil.ignore_patterns("site", "*.py", "__pycache__"))
    shutil.copytree(project / RESULTS, target / "results")
    for source, name in BESIDE.items():
        shutil.copy(project / source, target / name)
    for path, (_, text) in made.items():
        (target / path).parent.mkdir(parents=True, exist_ok=True)
        (target / path).write_text(text, "utf-8")
    for notebook in target.rglob("*.ipynb"):
        notebook.with_suffix(".md").write_text(notebook_text(json.loads(notebook.read_text("utf-8"))), "utf-8")
    index = target / "index.md"
    listed = "".join(
        f"* [{line.partition(':')[0]}]({path}):{line.partition(':')[2]}\n" for path, (line, _) in made.items()
    )
    index.write_text(index.read_text("utf-8").replace(GENERATED, f"{GENERATED}\n{listed}", 1), "utf-8")
    for page in target.rglob("*.md"):
        page.write_text(_relinked(page, target), "utf-8")


def _relinked(page: Path, root: Path) -> str:
    """A page whose links hold in the site: into the source they are only words."""
    here = page.relative_to(root)

    def link(found: re.Match[str]) -> str:
        mark, text, target, anchor = found[1], found[2], found[3], found[4] or ""
        if not target or "://" in target or target.startswith("mailto:"):
            return found[0]
        path = os.path.normpath(_source(here).parent / target)
        inside = _staged(path)
        if inside is None:
            return text
        inside = inside.removesuffix(".ipynb") + ".md" if inside.endswith(".ipynb") else inside
        return f"{mark}[{text}]({os.path.relpath(inside, here.parent)}{anchor})"

    return LINK.sub(link, page.read_text("utf-8"))


def _source(here: Path) -> Path:
    """Where a page of the site stands in the project."""
    if here.parts[0] == "results":
        return Path(RESULTS, *here.parts[1:])
    return next((Path(old) for old, new in BESIDE.items() if new == str(here)), Path("docs") / here)


def _staged(path: str) -> str | None:
    """Where a file of the project stands in the site; nothing of what is left out."""
    if path.startswith(f"{RESULTS}/"):
        return path.removeprefix("benchmarks/")
    return BESIDE.get(path) or (path.removeprefix("docs/") if path.startswith("docs/") else None)


def notebook_text(notebook: dict[str, Any]) -> str:
    """A notebook with what it printed and drew."""
    return "\n\n".join(part for cell in notebook["cells"] for part in _cell(cell)) + "\n"


def _cell(cell: dict[str, Any]) -> list[str]:
    text = "".join(cell["source"])
    if cell["cell_type"] == "markdown":
        return [text]
    return [f"```python\n{text}\n```", *(part for output in cell["outputs"] for part in _output(output))]


def _output(output: dict[str, Any]) -> list[str]:
    if output["output_type"] == "stream":
        return ["```text\n" + "".join(output["text"]).rstrip() + "\n```"]
    picture = output.get("data", {}).get("image/png")
    return (
        [f'<img alt="What the cell draws" src="data:image/png;base64,{"".join(picture.split())}">'] if picture else []
    )
