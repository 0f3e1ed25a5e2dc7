"""Sections of pages that commands write: from a mark to the next heading."""

from pathlib import Path


def write_section(page: Path, mark: str, lines: str) -> None:
    """Puts lines below the mark, in place of what stands between it and the next heading or the end."""
    head, rest = page.read_text(encoding="utf-8").split(mark)
    after = rest.find("\n## ")
    page.write_text(f"{head}{mark}\n\n{lines}\n{rest[after:] if after >= 0 else ''}", encoding="utf-8")
