"""The service's acts on a flag: raises it, sees its matter again, resolves it."""

from dataclasses import dataclass
from datetime import datetime

from service.flags.records import Concern, Flag, FlagState, NoticeKind
from service.flags.store import Flags, Notices
from service.fleet.store import Fleet
from service.storage.queries import Store

SERVICE = "imu-health"
"""Name under which the service raises flags."""
COVERED = "Another flag covers it."
"""Reason for resolving a flag whose matter another one says too."""


@dataclass(frozen=True)
class Occasion:
    """Unit, session and time at which flags are settled."""

    unit: int
    session: str | None
    """Session that was evaluated; None where the clock or other units decide."""
    at: datetime


def raise_flag(store: Store, occasion: Occasion, concern: Concern) -> None:
    """Opens a flag on a matter that the clock or the other units decide, and that has none open."""
    number = Flags(store).add(occasion.unit, concern, occasion.session, occasion.at)
    tell(store, occasion, NoticeKind.RAISED, concern.summary, number)
    Fleet(store).count_flags(occasion.unit)


def see_again(store: Store, occasion: Occasion, known: Flag, concern: Concern) -> None:
    """Updates an open flag by the latest session; an acknowledged one is raised again where it got worse."""
    worse = concern.severity > known.severity and known.state is FlagState.ACKNOWLEDGED
    Flags(store).put(
        known.id,
        occasion.at,
        summary=concern.summary,
        severity=concern.severity,
        session_id=occasion.session,
        proposal="",
        state=FlagState.RAISED if worse else known.state,
    )
    kind = NoticeKind.RAISED if worse else NoticeKind.SEEN
    tell(store, occasion, kind, concern.summary, known.id)


def resolve_as_done(store: Store, occasion: Occasion, flag: Flag, why: str) -> None:
    """Resolves a flag by the service itself."""
    Flags(store).put(flag.id, occasion.at, state=FlagState.RESOLVED, proposal="")
    tell(store, occasion, NoticeKind.RESOLVED, why, flag.id)
    Fleet(store).count_flags(occasion.unit)


def tell(store: Store, occasion: Occasion, kind: NoticeKind, text: str, flag: int) -> None:
    """Keeps what happened to a flag, for people and for programs that are notified."""
    Notices(store).add(occasion.unit, kind, occasion.at, SERVICE, text, flag=flag, session=occasion.session)
