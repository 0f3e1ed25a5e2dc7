"""Step: the open flags of a unit as its accepted sessions tell them, one after another in the order of time.

A session raises a matter, a later one shows it again or finds it in order; only a person resolves it. What a person
resolved stays resolved until a session measured later than those that the person had seen shows it again. So the open
flags are a function of the accepted sessions and of what people resolved, in whatever order the files came in.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from service.flags.records import Concern, Flag, Matter, NoticeKind
from service.flags.store import Flags
from service.fleet.store import Fleet
from service.judging.records import Told
from service.judging.store import Derivations, Key, Moment
from service.records.flagging.settle import SERVICE, Occasion, resolve_as_done, see_again, tell
from service.storage.store import Store

MATTERS = (Matter.TOLERANCE, Matter.CAUSE, Matter.UNEXPLAINED, Matter.STAND)
"""That sessions tell of; the clock and the other units tell of the rest."""
ANY = "*"
"""Every place."""
NOT_SHOWN = "No accepted session shows it any more."


@dataclass(frozen=True)
class Opened:
    """A matter that is open."""

    concern: Concern
    session: str
    """The last one that showed it."""
    at: Moment
    """Of that session."""
    proposal: str = ""


def settle_sessions(store: Store, occasion: Occasion) -> tuple[Flag, ...]:
    """Brings the flags that sessions tell of in line with the unit's accepted sessions; those that were open."""
    every = Flags(store).open_of(occasion.unit)
    opened = tuple(flag for flag in every if flag.matter in MATTERS)
    wanted = _open_now(store, occasion.unit, opened)
    by_key = {flag.key: flag for flag in opened}
    for key, one in wanted.items():
        _bring(store, occasion, by_key.get(key), one)
    for key, flag in by_key.items():
        if key not in wanted:
            resolve_as_done(store, occasion, flag, NOT_SHOWN)
    if wanted.keys() - by_key.keys():
        Fleet(store).count_flags(occasion.unit)
    return every


def _open_now(store: Store, unit: int, opened: Iterable[Flag]) -> dict[Key, Opened]:
    """What is open, as the sessions tell it one after another, without what people settled."""
    found: dict[Key, Opened] = {}
    for at, verdict, diagnosis, is_old in Derivations(store).told(unit):
        kept = tuple(_concern(flag) for flag in opened if flag.session == at[1]) if is_old else ()
        for told in (verdict, diagnosis, Told(kept, ())):
            if told is not None:
                found = _after(found, told, at)
    settled = Derivations(store).settled(unit, SERVICE) if found else {}
    return {key: one for key, one in found.items() if key not in settled or settled[key] < one.at}


def _after(found: dict[Key, Opened], told: Told, at: Moment) -> dict[Key, Opened]:
    """What is open after a session has told of it."""
    shown = {concern.key: Opened(concern, at[1], at) for concern in told.concerns}
    proposals = {(matter, place): why for matter, place, why in told.clear}

    def seen(key: Key, one: Opened) -> Opened:
        why = proposals.get(key) or proposals.get((key[0], ANY))
        return replace(one, proposal=why) if why and not one.proposal else one

    return {key: seen(key, one) for key, one in found.items()} | shown


def _concern(flag: Flag) -> Concern:
    """What a session told of before that was kept."""
    return Concern(flag.matter, flag.place, flag.severity, flag.summary)


def _bring(store: Store, occasion: Occasion, known: Flag | None, wanted: Opened) -> None:
    """Raises a flag, shows it again or proposes to resolve it."""
    own = replace(occasion, session=wanted.session)
    if known is None:
        number = Flags(store).add(own.unit, wanted.concern, own.session, own.at)
        tell(store, own, NoticeKind.RAISED, wanted.concern.summary, number)
        proposal = ""
    else:
        number, proposal = known.id, known.proposal
        was = (known.summary, known.severity, known.session)
        taken_back = bool(proposal) and not wanted.proposal
        if was != (wanted.concern.summary, wanted.concern.severity, wanted.session) or taken_back:
            see_again(store, own, known, wanted.concern)
            proposal = ""
    if wanted.proposal and wanted.proposal != proposal:
        Flags(store).put(number, own.at, proposal=wanted.proposal)
        tell(store, occasion, NoticeKind.CLEAR, wanted.proposal, number)
