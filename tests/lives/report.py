"""The table of a run: how much was lived, and what was found."""

from collections import Counter
from datetime import datetime
from pathlib import Path
from typing import Any

PAGE = Path(__file__).parents[2] / "benchmarks" / "LIVES.md"
HEAD = """# Whole lives

What `make lives` lived last, and what it found. A life is a sequence of steps drawn by chance on a running service:
files of every programme and format, services, corrections, withdrawals, causes, jobs, tokens, restarts and kills.
After each step nothing may have failed, and pages must show what programs read. At the end nothing may still be
waiting, the state must follow from the accepted records alone, and a backup must restore to it. `make test` lives short
ones, always the same.

One of them again: `.venv/bin/python -m tests.lives --engine sqlite --seed SEED --steps STEPS`.
"""
COUNTED = ("steps", "uploads", "requests", "pages", "restarts", "kills")


def write(made: dict[str, list[dict[str, Any]]], minutes: float, at: datetime) -> None:
    """Renews the page."""
    lines = [HEAD, f"Run of {at:%Y-%m-%d %H:%M} UTC, {minutes:g} minutes on each database.\n"]
    lines.append(f"| database | lives | {' | '.join(COUNTED)} | processor time, s | finds |")
    lines.append(f"| --- | {' | '.join(['---:'] * (len(COUNTED) + 3))} |")
    for engine, lives in made.items():
        counts = sum((Counter(life["counts"]) for life in lives), Counter[str]())
        cells = [len(lives), *(counts[name] for name in COUNTED), round(sum(life["processor"] for life in lives))]
        finds = sum(bool(life["find"]) for life in lives)
        lines.append(f"| {engine} | " + " | ".join(f"{cell:,}" for cell in [*cells, finds]) + " |")
    PAGE.write_text("\n".join([*lines, *_finds(made), ""]), "utf-8")


def _finds(made: dict[str, list[dict[str, Any]]]) -> list[str]:
    found = [(engine, life) for engine, lives in made.items() for life in lives if life["find"]]
    if not found:
        return ["\nNothing was found."]
    lines = ["\n## Finds"]
    for engine, life in found:
        lines.append(
            f"\n`--engine {engine} --seed {life['seed']} --steps {life['steps']}`, last steps first to last:\n"
        )
        shown = [*life["find"].splitlines()[-20:], "", *life["journal"][-12:]]
        lines += ["```text", *(line[:240] for line in shown), "```"]
    return lines
