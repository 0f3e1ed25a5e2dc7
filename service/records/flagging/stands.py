"""Step: findings on a stand by sessions and units → flags of the stand, one a matter, that name the units.

Sessions on it are taken in the order of time, whatever unit they measure: one finds the stand at fault, a later one of
a block of the same kind no longer does. A shift shows in the common motions of its units, which are examined now and
then. A matter that is no longer found is closed with its reason; one that a person resolved stays resolved until a
later session shows it again.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from datetime import datetime

from estimator.message import joined, say
from service.errors import ServiceError
from service.flags.records import Concern, Flag, FlagState, Matter
from service.flags.store import FlagQuery, Flags
from service.judging.records import Moment, SessionEvidence
from service.judging.store import Derivations
from service.kit.guard import Alone, plainly
from service.models.records import Scope
from service.records.flagging.accepted import AcceptedCauses, accepted_in_words
from service.records.flagging.acts import SERVICE, Occasion, raise_flag, resolve_as_done, see_again
from service.stands.health import stand_health
from service.stands.records import StandCondition
from service.stands.store import Stands
from service.storage import Storage
from service.storage.queries import Store
from service.units.store import Units

OF_STAND = "The flag of the stand covers it."
"""Reason for resolving a flag on one unit, as an earlier version raised them."""
NOT_SHOWN = "No accepted session still shows it."
SEEN_WITH = "Seen with {units}."
MOST_NAMED = 12
"""Units of a stand that a flag names."""


@dataclass(frozen=True)
class _Fault:
    concern: Concern
    at: Moment
    """Moment of the last session that shows it."""
    units: tuple[str, ...]
    """Units that showed it since it was last found in order."""


def settle_stand(store: Store, occasion: Occasion, stand: str) -> None:
    """Brings the flag on a stand in line with the findings of all accepted sessions on it."""
    Stands(store).hold(stand)
    sessions = Derivations(store).evidence_on_stand(stand)
    found, why = _fault(sessions, stand, AcceptedCauses(store, sessions))
    opened = _open(store, Matter.STAND, stand)
    settled = None if found is None else Derivations(store).settled_of_stand(stand, SERVICE)
    if found is None or (settled is not None and settled >= found.at):
        for flag in opened:
            resolve_as_done(store, occasion, flag, why)
        return
    _bring(store, replace(occasion, session=found.at[1]), opened, _of_stand(found.concern, stand, found.units))


def _fault(sessions: Iterable[SessionEvidence], stand: str, accepted: AcceptedCauses) -> tuple[_Fault | None, str]:
    """The open fault of a stand, or else the reason why none is open."""
    by_block: dict[str, _Fault] = {}
    why = NOT_SHOWN
    for session in sessions:
        if session.diagnosis is None:
            continue
        found = [concern for concern in session.diagnosis.concerns if concern.key == (Matter.STAND, stand)]
        known = [accepted.explain(session.unit, concern) for concern in found]
        new = [concern for concern, revision in zip(found, known, strict=True) if revision is None]
        if new:
            before = by_block.get(session.block)
            units = (*(() if before is None else before.units), session.unit)
            by_block[session.block] = _Fault(new[0], session.at, tuple(dict.fromkeys(units)))
        elif found:
            why = next(accepted_in_words(revision) for revision in known if revision is not None)
        else:
            gone = next((w for m, p, w in session.diagnosis.clear if (m, p) == (Matter.STAND, stand)), None)
            why = gone if gone and by_block.pop(session.block, None) else why
    return max(by_block.values(), key=lambda fault: fault.at, default=None), why


def _of_stand(concern: Concern, stand: str, units: Iterable[str]) -> Concern:
    """A flag of the stand that names its units."""
    names = sorted(units)
    more = [say("{number} more", number=len(names) - MOST_NAMED)] if len(names) > MOST_NAMED else []
    seen = say(SEEN_WITH, units=joined(", ", [*names[:MOST_NAMED], *more]))
    summary = joined(" ", (concern.summary, seen)) if names else concern.summary
    return replace(concern, summary=summary, scope=Scope.STAND, subject=stand)


def _open(store: Store, matter: Matter, stand: str) -> tuple[Flag, ...]:
    found = Flags(store).page(FlagQuery(matter=matter, stand=stand, unresolved=True))
    return tuple(flag for flag in found if flag.scope is Scope.STAND)


def _bring(store: Store, occasion: Occasion, opened: tuple[Flag, ...], concern: Concern) -> None:
    """Raises the flag, or updates the open one."""
    if not opened:
        raise_flag(store, occasion, concern)
    for flag in opened:
        if (flag.summary, flag.session, flag.proposal) != (concern.summary, occasion.session, ""):
            see_again(store, occasion, flag, concern)


NO_LONGER_SHIFTED = "The units measured on {stand} no longer show a shift."


def flag_shifted_stands(storage: Storage, now: datetime, alone: Alone = plainly) -> None:
    """One flag a stand; a shift whose flag somebody resolved after it began is known and raises no other."""
    with storage.database.reading() as store:
        conditions = stand_health(store)
        opened = Flags(store).open_about(Matter.SHIFTED)
    shifted = {condition.stand for condition in conditions if condition.has_shifted}
    for flag in opened:
        if flag.scope is not Scope.STAND or flag.place not in shifted:
            with alone("stands", flag.place):
                _close(storage, flag, now)
    for condition in conditions:
        with alone("stands", condition.stand):
            if condition.has_shifted:
                _flag_shift(storage, condition, now)
            _require_whole(condition)


def _flag_shift(storage: Storage, condition: StandCondition, now: datetime) -> None:
    """Raises or updates the flag on a shift, also where the shift is dated anew. It is on the unit that comes first."""
    since = min(shift.since for shift in condition.shifts if shift.until is None)
    with storage.database.writing() as store:
        Stands(store).hold(condition.stand)
        units = Stands(store).last_measured(condition.stand, since)
        concern = _of_stand(Concern(Matter.SHIFTED, condition.stand, 1, condition.reason), condition.stand, units)
        opened = _open(store, Matter.SHIFTED, condition.stand)
        if opened or (units and not _is_known(store, condition.stand, since)):
            first = opened[0].unit if opened else units[0]
            _bring(store, Occasion(Units(store).key(first), None, now), opened, concern)


def _is_known(store: Store, stand: str, since: datetime) -> bool:
    """Whether somebody settled the matter after the shift began."""
    query = FlagQuery(matter=Matter.SHIFTED, stand=stand, state=FlagState.RESOLVED)
    resolved = (flag for flag in Flags(store).page(query) if flag.changes[-1].who != SERVICE)
    return any(flag.changed_at >= since for flag in resolved)


def _close(storage: Storage, flag: Flag, now: datetime) -> None:
    """Closes a flag that no unit supports any more, or that one unit had of its own."""
    why = say(NO_LONGER_SHIFTED, stand=flag.place) if flag.scope is Scope.STAND else OF_STAND
    with storage.database.writing() as store:
        unit = Units(store).hold(flag.unit)
        if Flags(store).get(flag.id).state is not FlagState.RESOLVED:
            resolve_as_done(store, Occasion(unit, None, now), flag, why)


def _require_whole(condition: StandCondition) -> None:
    """Raises for sessions whose common motion cannot be used; without them the stand is still judged."""
    if condition.unreadable:
        raise ServiceError(
            "What is stored of these sessions cannot be used: {reason}.", reason=", ".join(condition.unreadable)
        )
