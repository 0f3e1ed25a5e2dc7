"""Step: everything that is derived of a unit's accepted records, brought in line with them after a change.

References, verdicts with their decisions and common motions, the unit's line in the fleet and its open flags; the
outlook is asked for, and made after the transaction. Every flow that changes which records count ends with it, within
its own transaction. A session whose verdict rests on what it must rest on is left alone, so an ordinary upload judges
one session.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime

from estimator.errors import SessionError
from estimator.parity import parity_check
from estimator.parity.as_calibration import parity_calibration
from estimator.results import Calibration
from estimator.session import IN_SERVICE
from service.flows.flagging.drift import flag_drift
from service.flows.flagging.fold import settle_sessions
from service.flows.flagging.overdue import no_longer_overdue
from service.flows.flagging.settle import Occasion
from service.flows.flagging.verdict import tell_verdict, told_by
from service.flows.refresh_outlook import END_OF_TIME
from service.flows.summarise import ask_for_summaries
from service.flows.weigh import weigh_again
from service.ingest import read_upload
from service.judging.calibrate import Comparison
from service.judging.epochs import Place, needs_judging, placed
from service.judging.judge import judge, judge_recording
from service.judging.known_unit import Foreseen, KnownUnit, known_unit
from service.judging.parameter_values import parameter_values
from service.records.decision import Judged, Opening
from service.records.derivation import Counted, Decided
from service.records.group import Level
from service.records.session import StoredSession
from service.records.unit import UnitType
from service.storage import Files
from service.storage.files import LOST
from service.storage.queries.sessions import NOT_JUDGED
from service.storage.queries.unit_types import TypeThroughTime, held_at
from service.storage.store import Store

AT_ONCE = 20
"""Sessions that are judged within the request that changed a record, about a second; of more, all but the request's
own are judged after it."""
NOTHING_TO_COMPARE = (
    "No calibration of the unit is accepted in this epoch, and a recording in service is compared with one."
)


@dataclass(frozen=True)
class Deriving:
    """What a derivation takes beside the transaction that changes a record."""

    files: Files
    coverage_factor: float
    at: datetime
    at_once: int | None = AT_ONCE
    """None where all are judged now."""
    outlook: bool = True
    """Whether the outlook is asked for: of many files in a row the last one brings it."""
    is_dated_later: bool = False
    """Whether processes beside the requests make it; else it is made after the transaction (`refresh_beside.date`)."""


@dataclass(frozen=True)
class Derived:
    """What a derivation did and left."""

    judged: tuple[str, ...]
    waiting: int
    """Sessions that are to be judged after the answer."""
    latest: StoredSession | None
    """The unit's latest session that counts."""


def derive_again(
    store: Store,
    way: Deriving,
    serial: str,
    since: datetime,
    touched: Sequence[str] = (),
    *,
    known: KnownUnit | None = None,
) -> Derived:
    """Derives what is known of a unit after its records changed from a date on; ``touched`` are judged in any case.

    ``known``: what this transaction has read of the unit, where nothing of it changed since.
    """
    known = known or known_unit(store, store.units.hold(serial))
    places = _placed(known)
    stale = needs_judging(places, since)
    references = {p.session.id for p in places if p.is_reference}
    if references != known.records.references:
        store.derivations.put_references(known.unit, references)
    now, later = _shared(stale, touched, way.at_once)
    store.derivations.wait([p.session.id for p in later])
    _judge_all(way, serial, known, now)
    _ask_again(way, known, since, [p.session.id for p in now], _as_before(known, since, touched))
    for place in now:
        if place.session.id in known.records.diagnosed:
            weigh_again(store, way.files, place.session.id)
    latest = _sum_up(store, way, serial, touched)
    groups = store.groups.of_unit(serial)
    store.pending_groups.ask(groups, way.at)
    store.pending_summaries.ask((group for group in groups if group.level is not Level.UNIT), way.at)
    return Derived(tuple(p.session.id for p in now), len(later), latest)


def _placed(known: KnownUnit) -> tuple[Place, ...]:
    """The unit's accepted sessions, each with its reference."""
    own = known.records
    return placed(own.counted, own.breaks, own.choices, known.is_blind)


def _as_before(known: KnownUnit, since: datetime, touched: Collection[str]) -> tuple[str, ...]:
    """Sessions whose diagnosis looks at nothing that has changed: a change of a record is none for itself, and another
    calibration is none for any."""
    own = known.records.diagnosed
    return tuple(id for id in touched if id in known.made or (id in own and own[id] <= since))


def _ask_again(
    way: Deriving, known: KnownUnit, since: datetime, judged: Collection[str], same: Collection[str]
) -> None:
    """Diagnoses that looked at what has changed are asked for again, and those that are being made look again."""
    store, own = known.store, known.records
    store.fleet.touch(known.unit)
    if any(at >= since or id in judged for id, at in own.waiting.items() if id not in known.made):
        store.pending.look_again(known.unit, since, judged)
    if any(at >= since and id not in same for id, at in own.diagnosed.items()):
        store.pending.add(store.derivations.forget_diagnoses(known.unit, since, same), way.at)


def _shared(
    stale: Sequence[Place], touched: Sequence[str], most: int | None
) -> tuple[tuple[Place, ...], tuple[Place, ...]]:
    """What is judged now and what later."""
    if most is None or len(stale) <= most:
        return tuple(stale), ()
    return (
        tuple(p for p in stale if p.session.id in touched),
        tuple(p for p in stale if p.session.id not in touched),
    )


def derive_batch(store: Store, way: Deriving, serial: str, most: int) -> int:
    """Judges the first of the sessions that wait, and returns how many still do."""
    known = known_unit(store, store.units.hold(serial))
    waiting = tuple(p for p in _placed(known) if p.session.basis == NOT_JUDGED)
    ids = [p.session.id for p in waiting[:most]]
    store.pending.look_again(known.unit, END_OF_TIME, ids)
    _judge_all(way, serial, known, waiting[:most])
    for id in ids:
        weigh_again(store, way.files, id)
    left = max(len(waiting) - most, 0)
    if not left:
        store.failures.settle_derivation(known.unit)
        _sum_up(store, way, serial, ())
        ask_for_summaries(store, serial, way.at)
    return left


@dataclass(frozen=True)
class _Judging:
    """What sessions of a unit are judged by."""

    way: Deriving
    serial: str
    known: KnownUnit
    computed: Mapping[str, datetime]
    """When each calibration was computed."""
    of_type: TypeThroughTime

    def unit_type(self, id: str) -> UnitType:
        """With the tolerances that held when the calibration of a session was computed."""
        return held_at(self.of_type, self.computed.get(id, self.way.at))


def _judge_all(way: Deriving, serial: str, known: KnownUnit, places: Sequence[Place]) -> None:
    """Sessions judged as their places say, with what they tell of flags."""
    if not places:
        return
    store, ids = known.store, [p.session.id for p in places]
    computed = store.derivations.computed_at([id for id in ids if id not in known.made])
    known.read_all([*ids, *(p.reference.id for p in places if p.reference is not None)])
    by = _Judging(way, serial, known, computed, store.unit_types.of_unit_through_time(serial))
    store.derivations.put_judged([_decided(by, place) for place in places])


def _decided(by: _Judging, place: Place) -> Decided:
    """A session with what was decided of it."""
    own = place.session
    judged = _recording(by, place) if own.programme == IN_SERVICE else None
    if judged is None:
        judged = _calibration(by, place)
    told = told_by(own.at, judged)
    return Decided(own.id, own.revision, judged, place.basis, told, is_first=own.id in by.known.made)


def foresee(store: Store, way: Deriving, serial: str, new: Counted, calibration: Calibration) -> Foreseen | None:
    """How a calibration that is to be stored is judged if nothing changes until then; None where that is soon done:
    it is a unit's first, or becomes a reference."""
    unit = store.units.find(serial)
    if unit is None or new.programme == IN_SERVICE:
        return None
    found = known_unit(store, unit, {new.id: calibration})
    counted = tuple(sorted((*found.records.counted, new), key=lambda one: (one.at, one.id)))
    known = replace(found, records=replace(found.records, counted=counted))
    place = next(p for p in _placed(known) if p.session.id == new.id)
    if place.is_reference or place.reference is None:
        return None
    by = _Judging(way, serial, known, {}, store.unit_types.of_unit_through_time(serial))
    judged, against = _calibration(by, place), known.calibration(place.reference.id)
    return Foreseen(place.basis, by.unit_type(new.id), judged, place.reference, against)


def _calibration(by: _Judging, place: Place) -> Judged:
    """By the tolerances that held when it was computed."""
    known, unit_type, foreseen = by.known, by.unit_type(place.session.id), by.known.foreseen
    is_foreseen = foreseen is not None and place.session.id in known.made
    if foreseen is not None and is_foreseen and (foreseen.basis, foreseen.unit_type) == (place.basis, unit_type):
        return foreseen.judged
    own, k = known.calibration(place.session.id), by.way.coverage_factor
    against = None if place.is_reference or place.reference is None else known.calibration(place.reference.id)
    opening = Opening.CHOSEN if place.is_chosen else Opening.SERVICE if place.since is not None else Opening.FIRST
    return judge(own, against, unit_type, k, opening=opening)


def _recording(by: _Judging, place: Place) -> Judged:
    """A recording in service moves the calibration that it is compared with, so it is compared anew."""
    store, id = by.known.store, place.session.id
    session, own = store.sessions.get(id), by.known.calibration(id)
    store.history.drop(session)
    if place.reference is None:
        return Judged(own, (), NOTHING_TO_COMPARE, is_reference=False)
    try:
        source = read_upload(by.way.files.content(session.sha256), session.filename)
    except (*LOST, SessionError) as lost:
        return Judged(own, (), f"It cannot be compared: {lost}", is_reference=False)
    reference = by.known.calibration(place.reference.id)
    found = Comparison(reference, parity_check(source, reference))
    moved = parity_calibration(found.result, reference)
    judged = judge_recording(moved, found, by.unit_type(id), by.way.coverage_factor)
    store.calibrations.put(id, session.revision, judged.calibration)
    store.history.add(by.known.unit, ((session, parameter_values(judged.calibration)),))
    return judged


def _sum_up(store: Store, way: Deriving, serial: str, touched: Sequence[str]) -> StoredSession | None:
    """The outlook, the unit's line and its flags; the latest session that counts."""
    unit = store.units.key(serial)
    was = store.fleet.refresh(unit)
    latest = was.latest
    occasion = Occasion(unit, None if latest is None else latest.id, way.at)
    if latest is None:
        store.outlooks.drop(unit)
        store.pending_outlooks.settle(unit)
        settle_sessions(store, occasion)
        flag_drift(store, occasion, None)
        no_longer_overdue(store, occasion, None)
        return None
    if was.before is None:
        store.fleet.count_flags(unit)
    tell_verdict(store, occasion, latest, was)
    settle_sessions(store, occasion)
    if way.outlook:
        store.pending_outlooks.ask(unit, way.at)
    return latest
