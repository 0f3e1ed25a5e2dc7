"""Step: everything derived from a unit's accepted records, brought in line with them after a change.

It concerns references, verdicts with their decisions and common motions, the unit's line in the fleet and its open
flags. Every flow that changes which records count ends with it, within its own transaction, in which nothing is
computed: foreseen results are stored, the rest is left to be judged by `service.records.follow`. A session whose
verdict rests on the right records is left alone, so an ordinary upload judges one session.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime

from estimator.results import Calibration
from service.fleet.store import Fleet
from service.groups.records import Level
from service.groups.store import Groups
from service.judging.calibrate import Calibrated
from service.judging.records import Counted, UnitRecords
from service.judging.reference import KnownUnit, known_unit
from service.judging.store import Derivations
from service.outlook.store import Outlooks
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.flagging.acts import Occasion
from service.records.flagging.drift import flag_drift
from service.records.flagging.fold import settle_sessions, tell_verdict
from service.records.flagging.lasting import no_longer_overdue
from service.records.judge_again import (
    Foreseen,
    Judging,
    Place,
    fitting,
    judged,
    judging,
    needs_judging,
    places_of,
    put,
)
from service.sessions.records import StoredSession
from service.sessions.store import NOT_JUDGED
from service.storage import Files
from service.storage.queries import Store
from service.types.rules import type_of
from service.types.store import UnitTypes
from service.units.store import Units

AT_ONCE = 20
"""Sessions that are judged within the request that changed a record, about a second; of more, all but the request's
own are judged after it."""
NOTHING_FORESEEN = Foreseen()


@dataclass(frozen=True)
class Deriving:
    """Environment of a derivation, besides the transaction that changes a record."""

    files: Files
    coverage_factor: float
    at: datetime
    at_once: int | None = AT_ONCE
    """Most sessions judged at once; None where all are judged now."""
    outlook: bool = True
    """Whether the outlook is asked for: of many files in a row the last one brings it."""
    is_dated_later: bool = False
    """Whether background processes make it; else it is made after the transaction (`refresh_beside.date`)."""


@dataclass(frozen=True)
class Derived:
    """Result of a derivation, and the work that it left."""

    judged: tuple[str, ...]
    """Sessions judged before the answer."""
    waiting: int
    """Sessions that are to be judged after the answer."""
    latest: StoredSession | None
    """The unit's latest session that counts; None where that is still to be looked at."""
    is_left: bool = False
    """Whether anything is to be judged or weighed after the transaction."""


NOTHING_LEFT = Derived((), 0, None)


def derive_again(
    store: Store,
    context: Deriving,
    serial: str,
    since: datetime,
    touched: Sequence[str] = (),
    *,
    known: KnownUnit | None = None,
    foreseen: Foreseen = NOTHING_FORESEEN,
) -> Derived:
    """Makes all derived results of a unit again after its records changed from a date on; ``touched`` are judged in any
    case.

    ``known``: records of the unit that this transaction has read, where none of them changed since. ``foreseen``:
    results computed before it; the rest is left to `service.records.follow`.
    """
    known = known or known_unit(store, Units(store).hold(serial))
    places = places_of(known)
    stale = needs_judging(places, since)
    references = {p.session.id for p in places if p.is_reference}
    if references != known.records.references:
        Derivations(store).put_references(known.unit, references)
    now = _fitting(context, serial, known, stale, foreseen)
    diagnosed = _ask_again(context, known, since, [p.session.id for p in now], _as_before(known, since, touched))
    put(known, now, foreseen, diagnosed)
    left = [p for p in stale if p not in now]
    Derivations(store).wait([p.session.id for p in left])
    at_once = _own(left, touched, context.at_once)
    is_left = bool(left) or any(p.session.id in diagnosed for p in now)
    latest = sum_up(store, context, serial) if not is_left or len(at_once) < len(left) else None
    groups = Groups(store).of_unit(serial)
    WorkQueue(store, WorkKind.GROUP).enqueue_each((group.place for group in groups), context.at)
    shared = (group.place for group in groups if group.level is not Level.UNIT)
    WorkQueue(store, WorkKind.SUMMARY).enqueue_each(shared, context.at)
    return Derived((*(p.session.id for p in now), *at_once), len(left) - len(at_once), latest, is_left)


def _fitting(
    context: Deriving, serial: str, known: KnownUnit, stale: Sequence[Place], foreseen: Foreseen
) -> tuple[Place, ...]:
    """The sessions to be judged whose judgement from before the transaction still holds."""
    found = [p for p in stale if p.session.id in foreseen.outcomes]
    if not found:
        return ()
    return fitting(judging(known, serial, found, context.files, context.coverage_factor, context.at), found, foreseen)


def _as_before(known: KnownUnit, since: datetime, touched: Collection[str]) -> tuple[str, ...]:
    """Sessions whose diagnosis looks at nothing that has changed: a change of a record is none for itself, and another
    calibration is none for any."""
    diagnosed = known.records.diagnosed
    return tuple(id for id in touched if id in known.made or (id in diagnosed and diagnosed[id] <= since))


def _ask_again(
    context: Deriving, known: KnownUnit, since: datetime, judged: Collection[str], same: Collection[str]
) -> frozenset[str]:
    """Diagnoses that looked at what has changed are asked for again, and those that are being made look again; the
    sessions that keep theirs."""
    store, records = known.store, known.records
    Fleet(store).touch(known.unit)
    if any(at >= since or id in judged for id, at in records.waiting.items() if id not in known.made):
        Derivations(store).look_again(known.unit, since, judged)
    gone: tuple[str, ...] = ()
    if any(at >= since and id not in same for id, at in records.diagnosed.items()):
        gone = Derivations(store).forget_diagnoses(known.unit, since, same)
        WorkQueue(store, WorkKind.DIAGNOSIS).enqueue_once(gone, context.at)
    return frozenset(records.diagnosed.keys() - {*gone})


def _own(left: Sequence[Place], touched: Sequence[str], most: int | None) -> tuple[str, ...]:
    """The remaining sessions that the caller that changed the records judges itself: the touched ones, or all if
    few.
    """
    few = most is None or len(left) <= most
    return tuple(p.session.id for p in left if few or p.session.id in touched)


def sum_up(store: Store, context: Deriving, serial: str) -> StoredSession | None:
    """The outlook, the unit's line and its flags; the latest session that counts."""
    unit = Units(store).key(serial)
    was = Fleet(store).refresh(unit)
    latest = was.latest
    occasion = Occasion(unit, None if latest is None else latest.id, context.at)
    if latest is None:
        Outlooks(store).drop(unit)
        WorkQueue(store, WorkKind.OUTLOOK).drop(serial)
        settle_sessions(store, occasion)
        flag_drift(store, occasion, None)
        no_longer_overdue(store, occasion, None)
        return None
    if was.before is None:
        Fleet(store).count_flags(unit)
    tell_verdict(store, occasion, latest, was)
    settle_sessions(store, occasion)
    if context.outlook:
        WorkQueue(store, WorkKind.OUTLOOK).enqueue_again(serial, context.at)
    return latest


NOTHING_STORED = UnitRecords((), (), (), frozenset(), {}, {})
"""Records of a unit that is not known yet."""
NOT_STORED = 0
"""Number of such a unit, under which nothing is found."""


def foresee_upload(store: Store, context: Deriving, new: StoredSession, made: Calibrated, but: str | None) -> Foreseen:
    """The verdict of a session that is to be stored; ``but`` is the session that it supersedes."""
    unit, block = Units(store).find(new.unit), made.checked.session.block
    added = Counted(
        new.id,
        block,
        new.programme,
        new.started_at,
        new.revision,
        is_reference=False,
        basis=NOT_JUDGED,
        temperature=new.temperature,
    )
    if unit is None:
        known = KnownUnit(store, NOT_STORED, replace(NOTHING_STORED, counted=(added,)), {new.id: made.calibration})
        rules = _of_new_unit(store, context, made)
        return judged(known, rules, places_of(known))
    known = known_unit(store, unit, {new.id: made.calibration})
    counted = _in_order([session for session in known.records.counted if session.id != but] + [added])
    files = {new.id: (new.sha256, new.filename)}
    known = replace(known, records=replace(known.records, counted=counted), files=files)
    places = [place for place in places_of(known) if place.session.id == new.id]
    return judged(known, judging(known, new.unit, places, context.files, context.coverage_factor, context.at), places)


def foresee_revisions(
    store: Store, context: Deriving, serial: str, made: Mapping[str, tuple[int, Calibration]], since: datetime
) -> Foreseen:
    """The verdicts of a unit under other calibrations of its sessions, by session with the revision of each."""
    known = known_unit(store, Units(store).key(serial), {id: calibration for id, (_, calibration) in made.items()})
    revised = [
        replace(session, revision=made[session.id][0], basis=NOT_JUDGED) if session.id in made else session
        for session in known.records.counted
    ]
    known = replace(known, records=replace(known.records, counted=_in_order(revised)))
    places = needs_judging(places_of(known), since)
    return judged(known, judging(known, serial, places, context.files, context.coverage_factor, context.at), places)


def _of_new_unit(store: Store, context: Deriving, made: Calibrated) -> Judging:
    kind = type_of(made.checked)
    kind = UnitTypes(store).find(kind.name) or kind
    return Judging(context.files, context.coverage_factor, context.at, ((context.at, kind),), {})


def _in_order(sessions: Sequence[Counted]) -> tuple[Counted, ...]:
    return tuple(sorted(sessions, key=lambda session: (session.at, session.id)))
