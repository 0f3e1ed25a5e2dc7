"""A unit as found and as left, side by side."""

from dataclasses import dataclass

from estimator.message import say
from service.kit.names import day_of
from service.papers.found_and_left import FoundAndLeft
from service.papers.moved import Moved, moved


@dataclass(frozen=True)
class PairRow:
    """One parameter as found and as left."""

    found: Moved
    left: Moved | None


@dataclass(frozen=True)
class Pair:
    """The unit before and after it was worked on, against the reference that held before."""

    found: str
    """Session and date."""
    rows: tuple[PairRow, ...]


def pair_of(pair: FoundAndLeft) -> Pair:
    """What was judged of both sessions, in people's units."""
    rows = (PairRow(moved(before), None if after is None else moved(after)) for before, after in pair.decisions)
    return Pair(
        say("session {id} of {started_at}", id=pair.found.id[:12], started_at=day_of(pair.found.started_at)),
        tuple(rows),
    )
