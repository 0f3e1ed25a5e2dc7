"""Flow: the changes that a service would bring, before it is recorded: verdicts, the next calibration and flags.

The service is recorded in transactions that are undone, by the steps that record it: the preview is the state once its
unit's dates are worked out. Sessions are judged and dates forecast between the transactions, as always.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace

from estimator.message import say
from service.flags.records import Flag, Matter
from service.flags.store import Flags
from service.fleet.condition import UnitSummary
from service.fleet.store import Fleet
from service.judging.reference import known_unit
from service.kit.measures import day_of
from service.outlook.changes import gathered, known_of, worked_out
from service.outlook.rules.histories import type_evidence
from service.outlook.store import Outlooks
from service.records.changes import require_possible
from service.records.derive_again import Deriving, derive_again, sum_up
from service.records.follow import put_outlook
from service.records.judge_again import Foreseen as ForeseenVerdicts
from service.records.judge_again import judged, judging, needs_judging, places_of
from service.sessions.records import StoredSession
from service.sessions.states import RecordState
from service.sessions.store import Sessions
from service.sessions.words.conditions import condition_of
from service.storage import Storage
from service.storage.queries import Store
from service.units.records import ForeseenChange, ForeseenKind, NewService, ServicePreview
from service.units.store import Services, Units

RAISED, RESOLVED = ("none", "open"), ("open", "resolved")
"""States of a flag that a service raises or resolves, before and after."""
DIAGNOSED_AGAIN = ("open", "resolved until the sessions are diagnosed again")


@dataclass(frozen=True)
class _State:
    sessions: tuple[StoredSession, ...]
    next: str
    """Next calibration in words."""
    flags: Mapping[tuple[str, str], Flag]
    """Open flags by matter and place."""

    @property
    def counted(self) -> tuple[StoredSession, ...]:
        """Sessions that count."""
        return tuple(session for session in self.sessions if session.state is RecordState.ACCEPTED)


@dataclass(frozen=True)
class _Trial:
    """A service that is recorded again and again, and never kept."""

    storage: Storage
    context: Deriving
    serial: str
    new: NewService
    foreseen: ForeseenVerdicts

    @contextmanager
    def recorded(self) -> Iterator[Store]:
        """The store as it is with it, until the block ends."""
        with self.storage.database.trying() as store:
            number, _ = Services(store).add(Units(store).hold(self.serial), self.new, self.context.at)
            Services(store).put_state(number, RecordState.ACCEPTED)
            derive_again(store, self.context, self.serial, self.new.at, foreseen=self.foreseen)
            sum_up(store, self.context, self.serial)
            yield store


def preview_service(storage: Storage, context: Deriving, serial: str, new: NewService) -> ServicePreview:
    """The changes that a service would bring; RefusedError where it cannot be recorded."""
    with storage.database.reading() as store:
        require_possible(store, serial, new, context.at)
        before, foreseen = _state(store, serial), _judged_with(store, context, serial, new)
    after = _after(_Trial(storage, context, serial, new, foreseen)) if before.counted else before
    is_late = any(session.started_at >= new.at for session in before.counted)
    return ServicePreview(serial, new.at, is_late, tuple(_changes(before, after)))


def _judged_with(store: Store, context: Deriving, serial: str, new: NewService) -> ForeseenVerdicts:
    known = known_unit(store, Units(store).key(serial))
    breaks = tuple(sorted({*known.records.breaks, new.at}))
    known = replace(known, records=replace(known.records, breaks=breaks))
    places = needs_judging(places_of(known), new.at)
    return judged(known, judging(known, serial, places, context.files, context.coverage_factor, context.at), places)


def _after(trial: _Trial) -> _State:
    """The state after the service, with the dates, which are forecast between the transactions."""
    serial = trial.serial
    with trial.recorded() as store:
        known = known_of(store, serial)
    evidence = type_evidence(known)
    with trial.recorded() as store:
        Outlooks(store).put_histories(Units(store).key(serial), evidence)
        sources = gathered(store, serial, known)
    outlook = worked_out(sources)
    with trial.recorded() as store:
        put_outlook(store, sources.past, outlook, trial.context.at)
        return _state(store, serial)


def _state(store: Store, serial: str) -> _State:
    unit = Fleet(store).unit(serial)
    flags = {flag.key: flag for flag in Flags(store).open_of(Units(store).key(serial))}
    return _State(Sessions(store).of_unit(serial), _next(unit), flags)


def _next(unit: UnitSummary | None) -> str:
    if unit is None or unit.due is None:
        return (unit and unit.due_reason) or "not known"
    return day_of(unit.due)


def _changes(before: _State, after: _State) -> Iterator[ForeseenChange]:
    for was, now in zip(before.sessions, after.sessions, strict=True):
        words = _verdict(was), _verdict(now)
        if words[0] != words[1]:
            name = say("Session of {day}", day=day_of(was.started_at))
            yield ForeseenChange(ForeseenKind.VERDICT, name, *words, was.id)
    if before.next != after.next:
        yield ForeseenChange(ForeseenKind.DUE, "Next calibration", before.next, after.next)
    for key in sorted(before.flags.keys() - after.flags.keys()):
        flag = before.flags[key]
        of_diagnosis = flag.matter in (Matter.CAUSE, Matter.UNEXPLAINED)
        yield ForeseenChange(ForeseenKind.FLAG, flag.summary, *(DIAGNOSED_AGAIN if of_diagnosis else RESOLVED))
    for key in sorted(after.flags.keys() - before.flags.keys()):
        yield ForeseenChange(ForeseenKind.FLAG, after.flags[key].summary, *RAISED)
    for key in sorted(before.flags.keys() & after.flags.keys()):
        old, new = before.flags[key].summary, after.flags[key].summary
        if old != new:
            yield ForeseenChange(ForeseenKind.FLAG, old, "open", new)


def _verdict(session: StoredSession) -> str:
    return condition_of(session.verdict, is_reference=session.is_reference).word
