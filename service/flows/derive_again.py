"""Step: everything that is derived of a unit's accepted records, brought in line with them after a change.

References, verdicts with their decisions and common motions, the outlook, the unit's line in the fleet and its open
flags. Every flow that changes which records count ends with it, within its own transaction. A session whose verdict
rests on what it must rest on is left alone, so an ordinary upload judges one session.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import datetime

from estimator.errors import SessionError
from estimator.parity import parity_check
from estimator.parity.as_calibration import parity_calibration
from estimator.results import Calibration
from estimator.session import CALIBRATIONS, IN_SERVICE
from service.flows.flagging.drift import flag_drift
from service.flows.flagging.fold import settle_sessions
from service.flows.flagging.settle import Occasion
from service.flows.flagging.verdict import no_longer_overdue, tell_verdict, told_by
from service.flows.refresh_outlook import END_OF_TIME, refresh_outlook
from service.flows.summarise import ask_for_summaries
from service.flows.weigh import weigh_again
from service.ingest import read_upload
from service.judging.calibrate import Comparison
from service.judging.epochs import Place, needs_judging, placed
from service.judging.judge import judge, judge_recording
from service.judging.parameter_values import parameter_values
from service.records.decision import Judged, Opening
from service.records.derivation import Counted
from service.records.group import Level
from service.records.session import StoredSession
from service.storage import Files
from service.storage.files import LOST
from service.storage.store import Store
from service.words.advice import too_few

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
    """Whether the outlook is made too: of many files in a row the last one brings it."""
    is_dated_later: bool = False
    """Whether the outlook is asked for only, because processes beside the requests make it."""


@dataclass(frozen=True)
class Derived:
    """What a derivation did and left."""

    judged: tuple[str, ...]
    waiting: int
    """Sessions that are to be judged after the answer."""


@dataclass(frozen=True)
class _Known:
    """Calibrations that this derivation has read."""

    store: Store
    by_id: dict[str, Calibration] = field(default_factory=dict)

    def get(self, id: str) -> Calibration:
        if id not in self.by_id:
            self.by_id[id] = self.store.calibrations.get(id)
        return self.by_id[id]

    def is_blind(self, one: Counted) -> bool:
        """Whether a session gives no uncertainty; a reference gave one when it was taken for it."""
        return not one.is_reference and bool(too_few(self.get(one.id)))


def derive_again(store: Store, way: Deriving, serial: str, since: datetime, touched: Sequence[str] = ()) -> Derived:
    """Derives what is known of a unit after its records changed from a date on; ``touched`` are judged in any case."""
    unit, known = store.units.hold(serial), _Known(store)
    choices = tuple(choice.session for choice in store.states.choices(unit))
    places = placed(store.derivations.counted(unit), store.services.breaks(unit), choices, known.is_blind)
    stale = needs_judging(places, since)
    store.derivations.put_references(unit, (p.session.id for p in places if p.is_reference))
    now, later = _shared(stale, touched, way.at_once)
    for place in now:
        _judge(store, way, place, known)
    store.derivations.wait(p.session.id for p in later)
    store.pending.look_again(unit, since, [p.session.id for p in now])
    store.pending.add(store.derivations.forget_diagnoses(unit, since, touched), way.at)
    for place in now:
        weigh_again(store, way.files, place.session.id)
    _sum_up(store, way, serial, touched)
    groups = store.groups.of_unit(serial)
    store.pending_groups.ask(groups, way.at)
    store.pending_summaries.ask((group for group in groups if group.level is not Level.UNIT), way.at)
    return Derived(tuple(p.session.id for p in now), len(later))


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
    unit, known = store.units.hold(serial), _Known(store)
    choices = tuple(choice.session for choice in store.states.choices(unit))
    places = placed(store.derivations.counted(unit), store.services.breaks(unit), choices, known.is_blind)
    waiting = tuple(p for p in places if p.session.basis == "")
    store.pending.look_again(unit, END_OF_TIME, [p.session.id for p in waiting[:most]])
    for place in waiting[:most]:
        _judge(store, way, place, known)
        weigh_again(store, way.files, place.session.id)
    left = max(len(waiting) - most, 0)
    if not left:
        _sum_up(store, way, serial, ())
        ask_for_summaries(store, serial, way.at)
    return left


def _judge(store: Store, way: Deriving, place: Place, known: _Known) -> None:
    """A session judged as its place says, with what it tells of flags."""
    session = store.sessions.get(place.session.id)
    judged = _recording(store, way, session, place, known) if session.programme == IN_SERVICE else None
    if judged is None:
        judged = _calibration(store, way, session, place, known)
    store.derivations.put_judged(session.id, session.revision, judged, place.basis, told_by(session, judged))
    store.sessions.add_decisions(session.id, judged.decisions, session.revision)
    store.sessions.add_motions(session.id, judged.motions, session.revision)


def _calibration(store: Store, way: Deriving, session: StoredSession, place: Place, known: _Known) -> Judged:
    """By the tolerances that held when it was computed."""
    against = None if place.is_reference or place.reference is None else known.get(place.reference.id)
    unit_type = store.unit_types.of_unit_at(session.unit, store.derivations.computed_at(session.id))
    opening = Opening.CHOSEN if place.is_chosen else Opening.SERVICE if place.since is not None else Opening.FIRST
    return judge(known.get(session.id), against, unit_type, way.coverage_factor, opening=opening)


def _recording(store: Store, way: Deriving, session: StoredSession, place: Place, known: _Known) -> Judged:
    """A recording in service moves the calibration that it is compared with, so it is compared anew."""
    computed_at = store.derivations.computed_at(session.id)
    store.history.drop(session)
    if place.reference is None:
        return Judged(known.get(session.id), (), NOTHING_TO_COMPARE, is_reference=False)
    try:
        source = read_upload(way.files.content(session.sha256), session.filename)
    except (*LOST, SessionError) as lost:
        return Judged(known.get(session.id), (), f"It cannot be compared: {lost}", is_reference=False)
    reference = known.get(place.reference.id)
    found = Comparison(reference, parity_check(source, reference))
    unit_type = store.unit_types.of_unit_at(session.unit, computed_at)
    judged = judge_recording(parity_calibration(found.result, reference), found, unit_type, way.coverage_factor)
    store.calibrations.put(session.id, session.revision, judged, computed_at)
    store.history.add(store.units.key(session.unit), session, parameter_values(judged.calibration))
    return judged


def _sum_up(store: Store, way: Deriving, serial: str, touched: Sequence[str]) -> None:
    """The outlook, the unit's line and its flags."""
    unit = store.units.key(serial)
    was = store.fleet.refresh(unit)
    occasion = Occasion(unit, was.last_session, way.at)
    if was.last_session is None:
        store.outlooks.drop(unit)
        store.pending_outlooks.settle(unit)
        settle_sessions(store, occasion)
        flag_drift(store, occasion, None)
        return
    latest = store.sessions.get(was.last_session)
    tell_verdict(store, occasion, latest, was)
    settle_sessions(store, occasion)
    if way.outlook and way.is_dated_later:
        store.pending_outlooks.ask(unit, way.at)
    elif way.outlook:
        refresh_outlook(store, serial)
        flag_drift(store, occasion, store.outlooks.of_unit(serial))
    if latest.id in touched and latest.programme in CALIBRATIONS:
        no_longer_overdue(store, occasion, latest)
