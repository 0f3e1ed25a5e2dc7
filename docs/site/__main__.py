"""`python -m docs.site`: builds the site into build/docs. A broken link, or anything that a page would fetch from
elsewhere, ends it with an error."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from docs.site.navigation import configuration, entries
from docs.site.reference import reference_pages
from docs.site.staging import stage

PROJECT = Path(__file__).parents[2]
BUILD = PROJECT / "build"
SOURCE, SITE = BUILD / "docs-source", BUILD / "docs"
SHIM = re.compile(r'https://[^"\s]+/iframe-worker/shim')
"""Script that the generator would fetch from elsewhere, for a search without a server; ours is used instead."""
ELSEWHERE = re.compile(
    r'<(?:script|img|iframe|source)\b[^>]*\bsrc="https?:|<link\b[^>]*\brel="stylesheet"[^>]*"https?:'
)
"""Resources that a page would fetch from elsewhere while it is looked at."""


def main() -> None:
    """Everything from the pages to the site."""
    shutil.rmtree(SOURCE, ignore_errors=True)
    made = reference_pages()
    stage(PROJECT, SOURCE, made)
    (BUILD / "zensical.toml").write_text(configuration(entries(SOURCE)), "utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "zensical", "build", "--strict", "--clean", "--config-file", "zensical.toml"],
        cwd=BUILD,
        env=os.environ | {"NO_COLOR": "1"},
        check=False,
    )
    if done.returncode:
        raise SystemExit("The site was not built.")
    _make_self_contained(SITE)
    print(f"The documentation is in {SITE.relative_to(PROJECT)}/index.html; no server is needed to read it.")


def _make_self_contained(site: Path) -> None:
    """Puts what pages would fetch from elsewhere beside them; an error where something is left."""
    shutil.copy(Path(__file__).with_name("iframe-worker.js"), site / "assets" / "javascripts")
    for page in site.rglob("*.html"):
        up = "../" * (len(page.relative_to(site).parts) - 1)
        text = SHIM.sub(f"{up}assets/javascripts/iframe-worker.js", page.read_text("utf-8"))
        if found := ELSEWHERE.search(text):
            raise SystemExit(f"{page.relative_to(site)} would fetch from elsewhere: {found[0]}")
        page.write_text(text, "utf-8")


if __name__ == "__main__":
    main()
