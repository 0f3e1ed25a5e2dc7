"""How much a session file may hold: asked of it before anything large is built from it."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Extent:
    """The most that a file may hold. As they stand: what fits into a text of the largest size (`source`)."""

    rows: int = 10**7
    columns: int = 10**4
    """The readings and standard errors of `sensors.MOST` sensors, and others five times as many."""
    cells: int = 10**8
    """Rows × columns."""
    nesting: int = 32
    """Lists and objects of JSON within each other; a session has four."""
