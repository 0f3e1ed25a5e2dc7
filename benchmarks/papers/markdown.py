"""Tables of the papers as markdown."""

from collections.abc import Iterable, Sequence

Cell = object


def section(title: str, *parts: str) -> str:
    """A heading and its paragraphs and tables."""
    return "\n\n".join((f"## {title}", *parts))


def table(columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> str:
    """A table; numbers to three digits."""
    lines = [columns, ["---"] * len(columns), *([written(cell) for cell in row] for row in rows)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def written(cell: Cell) -> str:
    """One cell."""
    return f"{cell:.3g}" if isinstance(cell, float) else str(cell)
