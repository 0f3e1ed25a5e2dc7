"""Step: a unit's accepted sessions → the reference of every epoch, and what each session's verdict must rest on.

An epoch lasts from one accepted service to the next; what is measured at the moment of the service is after it. Its
reference is the one that an engineer chose last, or else the first by time measured that gives an uncertainty. All
other sessions of the epoch are judged against it, those before it too. So what is known of a unit is a function of its
accepted records and of what engineers chose, not of the order in which files came in.
"""

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime

from estimator.session import IN_SERVICE
from service.judging.records import Counted
from service.judging.reference import alike

Group = tuple[str, tuple[str, ...], int]
"""Block, programmes that have one reference together, and which epoch."""


@dataclass(frozen=True)
class Place:
    """A session in its epoch."""

    session: Counted
    reference: Counted | None
    """That it is judged against; itself where it is the reference, None where the epoch has none."""
    since: datetime | None
    """When its epoch began; None in the unit's first one."""
    is_chosen: bool = False
    """Whether an engineer ever chose it for the reference."""

    @property
    def is_reference(self) -> bool:
        """Whether the others of its epoch are judged against it."""
        return self.reference is self.session

    @property
    def basis(self) -> str:
        """Everything that its verdict rests on: where this is another one, it is judged again."""
        own, known = self.session, self.reference
        against = "-" if known is None else f"{known.id}@{known.revision}"
        chosen = " chosen" if self.is_chosen and self.is_reference else ""
        return f"{against} {own.revision} {'-' if self.since is None else self.since.isoformat()}{chosen}"


def placed(
    sessions: Sequence[Counted],
    breaks: Sequence[datetime],
    chosen: Sequence[str],
    is_blind: Callable[[Counted], bool],
) -> tuple[Place, ...]:
    """Every accepted session with its reference, in order of time.

    ``chosen`` are the sessions that engineers chose, oldest choice first; ``is_blind`` says of a session whether it
    gives no uncertainty that others could be judged with.
    """
    groups: dict[Group, list[Counted]] = {}
    for one in sessions:
        if one.programme != IN_SERVICE:
            groups.setdefault(_group(one, breaks), []).append(one)
    rank = {id: number for number, id in enumerate(chosen)}
    references = {group: _reference(own, rank, is_blind) for group, own in groups.items()}
    return tuple(
        Place(one, references.get(_group(one, breaks)), _since(one.at, breaks), one.id in rank)
        for one in sorted(sessions, key=lambda s: (s.at, s.id))
    )


def needs_judging(places: Sequence[Place], since: datetime) -> tuple[Place, ...]:
    """Those whose verdict rests on something else than it must.

    Of a verdict from before this was kept it is taken to be right, unless a change touches it: from a date on, or where
    the reference of its epoch is another one.
    """
    moved = {(p.session.block, p.since) for p in places if p.session.is_reference != p.is_reference}
    return tuple(p for p in places if _is_stale(p, since, moved))


def _is_stale(place: Place, since: datetime, moved: set[tuple[str, datetime | None]]) -> bool:
    own = place.session
    if own.basis is None:
        return own.at >= since or (own.block, place.since) in moved
    return own.rests_on != place.basis


def _group(one: Counted, breaks: Sequence[datetime]) -> Group:
    """A recording in service is compared with the calibrations' reference."""
    return one.block, alike(one.programme), bisect_right(breaks, one.at)


def _since(at: datetime, breaks: Sequence[datetime]) -> datetime | None:
    number = bisect_right(breaks, at)
    return breaks[number - 1] if number else None


def _reference(own: Sequence[Counted], rank: dict[str, int], is_blind: Callable[[Counted], bool]) -> Counted | None:
    """The one chosen last, or the first that gives an uncertainty."""
    chosen = max((one for one in own if one.id in rank), key=lambda one: rank[one.id], default=None)
    if chosen is not None:
        return chosen
    in_order = sorted(own, key=lambda one: (one.at, one.id))
    return next((one for one in in_order if not is_blind(one)), None)
