"""Step: what was found of a unit changes its flags: new ones are raised, open ones seen again, clear or resolved."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import datetime

from service.records.flag import Concern, Flag, FlagState, NoticeKind
from service.storage.store import Store

SERVICE = "imu-health"
"""Who raises flags."""


@dataclass(frozen=True)
class Occasion:
    """On which unit, by what and when flags are settled."""

    unit: int
    session: str | None
    """That was looked at; None where the clock or the other units tell."""
    at: datetime


@dataclass(frozen=True)
class Found:
    """What was found on an occasion."""

    concerns: tuple[Concern, ...]
    clear: Mapping[tuple[str, str], str]
    """Of matters and places that it finds in order: why a flag on them could be resolved."""


def settle(store: Store, occasion: Occasion, opened: Iterable[Flag], found: Found) -> None:
    """Brings the flags of a unit in line with what was found; of one matter at one place only one is open."""
    by_key = {flag.key: flag for flag in opened}
    for concern in found.concerns:
        known = by_key.get(concern.key)
        if known is None:
            number = store.flags.add(occasion.unit, concern, occasion.session, occasion.at)
            _tell(store, occasion, NoticeKind.RAISED, concern.summary, number)
        elif (known.summary, known.session, known.proposal) != (concern.summary, occasion.session, ""):
            _see_again(store, occasion, known, concern)
    _clear(store, occasion, by_key.values(), found)
    if found.concerns:
        store.fleet.count_flags(occasion.unit)


def _see_again(store: Store, occasion: Occasion, known: Flag, concern: Concern) -> None:
    """The open flag speaks of the latest session; one that was acknowledged is raised again where it got worse."""
    worse = concern.severity > known.severity and known.state is FlagState.ACKNOWLEDGED
    store.flags.put(
        known.id,
        occasion.at,
        summary=concern.summary,
        severity=concern.severity,
        session_id=occasion.session,
        proposal="",
        state=FlagState.RAISED if worse else known.state,
    )
    kind = NoticeKind.RAISED if worse else NoticeKind.SEEN
    _tell(store, occasion, kind, concern.summary, known.id)


def _clear(store: Store, occasion: Occasion, opened: Iterable[Flag], found: Found) -> None:
    """Proposes, once, to resolve what is in order again."""
    concerned = {concern.key for concern in found.concerns}
    for flag in opened:
        why = found.clear.get(flag.key, "")
        if why and flag.key not in concerned and not flag.proposal:
            store.flags.put(flag.id, occasion.at, proposal=why)
            _tell(store, occasion, NoticeKind.CLEAR, why, flag.id)


def resolve_as_done(store: Store, occasion: Occasion, flag: Flag, why: str) -> None:
    """Resolves a flag by the service itself."""
    store.flags.put(flag.id, occasion.at, state=FlagState.RESOLVED, proposal="")
    _tell(store, occasion, NoticeKind.RESOLVED, why, flag.id)
    store.fleet.count_flags(occasion.unit)


def _tell(store: Store, occasion: Occasion, kind: NoticeKind, text: str, flag: int) -> None:
    store.notices.add(occasion.unit, kind, occasion.at, SERVICE, text, flag=flag, session=occasion.session)
