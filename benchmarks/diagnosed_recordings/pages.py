"""The page of a recording and the index of all."""

from pathlib import Path

from benchmarks.details import in_full, publish
from benchmarks.diagnosed_recordings.pictures import draw
from benchmarks.diagnosed_recordings.stated import stated_table
from benchmarks.diagnosed_recordings.subjects import Diagnosed
from benchmarks.diagnosed_recordings.words import section, summary, table

LEGEND = """A cell is *the same* as × 1 (probabilities within 2 %), or bold. *Stated noise* is the factor by which the
answer calls the stated errors of accelerometers (A) or gyros (G) too small, *right* where it believes them; a slash
separates the three factors. A log states no errors, so it has one answer. Inputs without any name are left out."""
"""Legend of the table of stated errors."""
COMMAND = "python -m benchmarks.diagnosed_recordings"
PHYSICS = Path(__file__).parent / "physics"
"""Folder of the arguments about each recording, written by hand; the figures on the page are made by the command."""
STATED = "stated-errors"
"""The page that asks whether an answer depends on what the errors are stated as."""
INDEX = f"""# Real recordings: what the simulation gets wrong

Made by `{COMMAND}` from the recordings that [Real recordings](../recordings.md)
describes, with the noise that their averaging states. The truth is unknown: statements on the physics are arguments,
marked where they are inference; held-out positions are the evidence. How an answer depends on stated errors and chosen
sensors: [stated errors](recordings/{STATED}.md).
"""


def page(name: str, made: list[Diagnosed], out: Path) -> None:
    """Write one page and its pictures."""
    title, argued = (PHYSICS / f"{name}.md").read_text(encoding="utf-8").split("\n", 1)
    parts = [title, f"Made by `{COMMAND} {name}`.", argued.strip()]
    for k, one in enumerate(made, 1):
        picture = f"{name}-{k}.png"
        draw(one.subject.session, one.diagnosis, out / picture)
        parts += [f"## {one.subject.title}", in_full(section(one.diagnosis)), f"![measured minus simulated]({picture})"]
    publish("\n\n".join(parts) + "\n", out / f"{name}.md")


def stated_page(out: Path) -> None:
    """Write the page on errors stated otherwise."""
    title, argued = (PHYSICS / f"{STATED}.md").read_text(encoding="utf-8").split("\n", 1)
    parts = [title, f"Made by `{COMMAND} {STATED}`.", argued.strip(), in_full(f"{LEGEND}\n\n{stated_table()}")]
    publish("\n\n".join(parts) + "\n", out / f"{STATED}.md")


def index(made: dict[str, list[Diagnosed]]) -> str:
    """One table over all recordings."""
    body = [
        (
            f"[{one.subject.title}](recordings/{name}.md)",
            f"{len(one.subject.session.readings)} × {len(one.subject.session.sensors)}",
            summary(one.diagnosis),
            f"{one.diagnosis.gain.before.chi2_per_dof:.2f} → {one.diagnosis.gain.after.chi2_per_dof:.2f}",
        )
        for name, several in made.items()
        for one in several
    ]
    head = ("recording", "rows × sensors", "what the simulation gets wrong", "held-out χ²/dof")
    return f"{INDEX}\n{table(head, body)}\n"
