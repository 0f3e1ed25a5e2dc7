"""Step: what a session says of a unit's flags: new ones are raised, open ones are seen again or found to be clear."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import datetime

from service.records.flag import Concern, Flag, FlagState, NoticeKind
from service.storage.store import Store

SERVICE = "imu-health"
"""Who raises flags."""


@dataclass(frozen=True)
class Found:
    """What a session says."""

    concerns: tuple[Concern, ...]
    clear: Mapping[tuple[str, str], str]
    """Of matters and places that it finds in order: why a flag on them could be resolved."""


def settle(store: Store, unit: int, opened: Iterable[Flag], found: Found, session: str | None, at: datetime) -> None:
    """Brings the flags of a unit in line with what was found; of one matter at one place only one is open."""
    by_key = {flag.key: flag for flag in opened}
    for concern in found.concerns:
        known = by_key.get(concern.key)
        if known is None:
            number = store.flags.add(unit, concern, session, at)
            store.notices.add(unit, NoticeKind.RAISED, at, SERVICE, concern.summary, flag=number, session=session)
        elif (known.summary, known.session, known.proposal) != (concern.summary, session, ""):
            _see_again(store, unit, known, concern, session, at)
    _clear(store, unit, by_key.values(), found, session, at)
    if found.concerns:
        store.fleet.count_flags(unit)


def _see_again(store: Store, unit: int, known: Flag, concern: Concern, session: str | None, at: datetime) -> None:
    """The open flag speaks of the latest session; one that was acknowledged is raised again where it got worse."""
    worse = concern.severity > known.severity and known.state is FlagState.ACKNOWLEDGED
    store.flags.put(
        known.id,
        at,
        summary=concern.summary,
        severity=concern.severity,
        session_id=session,
        proposal="",
        state=FlagState.RAISED if worse else known.state,
    )
    kind = NoticeKind.RAISED if worse else NoticeKind.SEEN
    store.notices.add(unit, kind, at, SERVICE, concern.summary, flag=known.id, session=session)


def _clear(store: Store, unit: int, opened: Iterable[Flag], found: Found, session: str | None, at: datetime) -> None:
    """Proposes, once, to resolve what is in order again."""
    concerned = {concern.key for concern in found.concerns}
    for flag in opened:
        why = found.clear.get(flag.key, "")
        if why and flag.key not in concerned and not flag.proposal:
            store.flags.put(flag.id, at, proposal=why)
            store.notices.add(unit, NoticeKind.CLEAR, at, SERVICE, why, flag=flag.id, session=session)
