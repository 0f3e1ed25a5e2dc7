"""Step: sessions judged at their places, computed while no blocking transaction is open, and stored within one where
the result still holds.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from hashlib import sha256

from estimator.errors import SessionError
from estimator.health.temperature_law import NO_STEPS, Seen, Steps, can_tell, temperature_steps
from estimator.health.type_law import ENOUGH_WITH_TYPE
from estimator.health.warmth import ENOUGH_TO_BEND
from estimator.message import say
from estimator.parity import parity_check
from estimator.parity.as_calibration import parity_calibration
from estimator.results import Calibration
from estimator.session import IN_SERVICE
from service.ingest import read_upload
from service.judging.calibrate import ReferenceComparison
from service.judging.judge import judge, judge_recording
from service.judging.records import Counted, Decided, Moment
from service.judging.reference import KnownUnit, alike
from service.judging.store import Derivations
from service.kit.measures import YEAR
from service.records.flagging.fold import verdict_evidence
from service.records.keep import MadeCalibration, made
from service.sessions.calibrations_store import Calibrations
from service.sessions.decision import Judged, Opening
from service.sessions.history_store import History
from service.sessions.records import UNWEIGHED
from service.sessions.store import Sessions
from service.storage import Files
from service.storage.files import LOST
from service.types.records import UnitType
from service.types.rules import tolerances_of
from service.types.store import TypeThroughTime, UnitTypes, held_at

Group = tuple[str, tuple[str, ...], int]
"""Block, programmes that have one reference together, and which epoch."""
MOST_LEARNED = 30
"""Sessions, the newest before one, that a law over temperature is learned from: each is another calibration to read."""


@dataclass(frozen=True)
class Place:
    """A session in its epoch."""

    session: Counted
    reference: Counted | None
    """Reference against which it is judged; itself where it is the reference, None where the epoch has none."""
    since: datetime | None
    """Beginning of its epoch; None in the unit's first one."""
    is_chosen: bool = False
    """Whether an engineer ever chose it for the reference."""
    learned: tuple[Counted, ...] = ()
    """Sessions that may tell what its temperature is worth, in order of time; empty where they cannot."""

    @property
    def is_reference(self) -> bool:
        """Whether the others of its epoch are judged against it."""
        return self.reference is self.session

    @property
    def basis(self) -> str:
        """Everything that its verdict rests on: where this is another one, it is judged again."""
        session, known = self.session, self.reference
        against = "-" if known is None else f"{known.id}@{known.revision}"
        chosen = " chosen" if self.is_chosen and self.is_reference else ""
        since = "-" if self.since is None else self.since.isoformat()
        return f"{against} {session.revision} {since}{chosen}{self._law}"

    @property
    def _law(self) -> str:
        if not self.learned:
            return ""
        learned = ",".join(f"{session.id}@{session.revision}" for session in self.learned)
        return " law " + sha256(learned.encode()).hexdigest()[:16]


def placed(
    sessions: Sequence[Counted],
    breaks: Sequence[datetime],
    chosen: Sequence[str],
    is_blind: Callable[[Counted], bool],
    enough: int = ENOUGH_TO_BEND,
) -> tuple[Place, ...]:
    """Every accepted session with its reference, in order of time.

    ``chosen`` are the sessions that engineers chose, oldest choice first; ``is_blind`` tells whether a session gives no
    uncertainty that others could be judged with; ``enough`` is the number of sessions from which on a law over
    temperature is estimated.
    """
    ordered = sorted(sessions, key=_moment)
    groups: dict[Group, list[Counted]] = {}
    for counted in ordered:
        if counted.programme != IN_SERVICE:
            groups.setdefault(_group(counted, breaks), []).append(counted)
    rank = {id: number for number, id in enumerate(chosen)}
    references = {group: _reference(members, rank, is_blind) for group, members in groups.items()}

    def place(session: Counted) -> Place:
        group = _group(session, breaks)
        reference = references.get(group)
        learned = () if reference is None else _learned(session, reference, groups[group], enough)
        return Place(session, reference, _since(session.at, breaks), session.id in rank, learned)

    return tuple(place(session) for session in ordered)


def _learned(session: Counted, reference: Counted, group: Sequence[Counted], enough: int) -> tuple[Counted, ...]:
    """The sessions of its group, in order of time, before one, and its reference, that may tell what its temperature is
    worth."""
    if (
        session.temperature is None
        or reference.temperature is None
        or session.programme == IN_SERVICE
        or session is reference
    ):
        return ()
    earlier = group[: bisect_left(group, _moment(session), key=_moment)]
    before = [s for s in earlier if s.temperature is not None and s is not reference]
    kept = sorted([reference, *before[-MOST_LEARNED:]], key=_moment)
    warm = [s.temperature for s in kept if s.temperature is not None]
    return tuple(kept) if can_tell(warm, reference.temperature, session.temperature, enough) else ()


def _moment(session: Counted) -> Moment:
    return session.at, session.id


def needs_judging(places: Sequence[Place], since: datetime) -> tuple[Place, ...]:
    """The sessions whose verdict does not rest on the right records.

    A verdict from before this was stored is taken to be right, unless a change touches it: from a date on, or where the
    reference of its epoch is another one.
    """
    moved = {(p.session.block, p.since) for p in places if p.session.is_reference != p.is_reference}
    return tuple(p for p in places if _is_stale(p, since, moved))


def _is_stale(place: Place, since: datetime, moved: set[tuple[str, datetime | None]]) -> bool:
    session = place.session
    if session.basis is None:
        return session.at >= since or (session.block, place.since) in moved
    return session.rests_on != place.basis


def _group(session: Counted, breaks: Sequence[datetime]) -> Group:
    return session.block, alike(session.programme), bisect_right(breaks, session.at)


def _since(at: datetime, breaks: Sequence[datetime]) -> datetime | None:
    number = bisect_right(breaks, at)
    return breaks[number - 1] if number else None


def _reference(group: Sequence[Counted], rank: dict[str, int], is_blind: Callable[[Counted], bool]) -> Counted | None:
    """The session chosen last, or the first that gives an uncertainty."""
    chosen = max((s for s in group if s.id in rank), key=lambda s: rank[s.id], default=None)
    if chosen is not None:
        return chosen
    in_order = sorted(group, key=_moment)
    return next((s for s in in_order if not is_blind(s)), None)


NOTHING_TO_COMPARE = (
    "No calibration of the unit is accepted in this epoch, and a recording in service is compared with one."
)


@dataclass(frozen=True)
class Judging:
    """Basis for judging sessions of a unit."""

    files: Files
    coverage_factor: float
    at: datetime
    """Time of computation of the results that are stored now."""
    of_type: TypeThroughTime
    computed: Mapping[str, datetime]
    """Times at which the stored calibrations of sessions were computed, by session."""

    def unit_type(self, id: str) -> UnitType:
        """The unit type with the tolerances that held when the calibration of a session was computed."""
        return held_at(self.of_type, self.computed.get(id, self.at))


@dataclass(frozen=True, eq=False)
class Rejudgement:
    """Judgement of a session at its place, by a revision of the tolerances."""

    basis: str
    unit_type: UnitType
    judged: Judged
    moved: MadeCalibration | None = None
    """Calibration moved by a recording in service that can be compared."""


@dataclass(frozen=True)
class Foreseen:
    """Judgements that hold if nothing changes until their transaction."""

    outcomes: Mapping[str, Rejudgement] = field(default_factory=dict)
    references: Mapping[tuple[str, int], Calibration] = field(default_factory=dict)
    """References of these judgements, by session and revision: a session's calibration never changes under one."""


def places_of(known: KnownUnit) -> tuple[Place, ...]:
    """The unit's accepted sessions, each with its reference."""
    records = known.records
    enough = ENOUGH_WITH_TYPE if records.has_type_laws else ENOUGH_TO_BEND
    return placed(records.counted, records.breaks, records.choices, known.is_blind, enough)


def judging(
    known: KnownUnit, serial: str, places: Sequence[Place], files: Files, coverage_factor: float, at: datetime
) -> Judging:
    """The basis for judging some of a unit's sessions."""
    computed = Derivations(known.store).computed_at([p.session.id for p in places if p.session.id not in known.made])
    return Judging(files, coverage_factor, at, UnitTypes(known.store).of_unit_through_time(serial), computed)


def judged(known: KnownUnit, rules: Judging, places: Sequence[Place]) -> Foreseen:
    """The judgements of sessions at their places, computed from stored results."""
    against = [p.reference for p in places if p.reference is not None]
    learned = {session.id for p in places for session in p.learned}
    known.read_all([*(p.session.id for p in places), *(session.id for session in against), *learned])
    return Foreseen(
        {place.session.id: _outcome(known, rules, place) for place in places},
        {(session.id, session.revision): known.calibration(session.id) for session in against},
    )


def _outcome(known: KnownUnit, rules: Judging, place: Place) -> Rejudgement:
    unit_type = rules.unit_type(place.session.id)
    if place.session.programme == IN_SERVICE:
        return _of_recording(known, rules, place, unit_type)
    calibration = known.calibration(place.session.id)
    against = None if place.is_reference or place.reference is None else known.calibration(place.reference.id)
    opening = Opening.CHOSEN if place.is_chosen else Opening.SERVICE if place.since is not None else Opening.FIRST
    steps = NO_STEPS if against is None else _steps(known, place, against, unit_type)
    decided = judge(calibration, against, unit_type, rules.coverage_factor, opening=opening, steps=steps)
    return Rejudgement(place.basis, unit_type, decided)


def _steps(known: KnownUnit, place: Place, reference: Calibration, unit_type: UnitType) -> Steps:
    """The effects of a session's temperature, by the sessions before it and the laws of its type."""
    if not place.learned or place.reference is None:
        return NO_STEPS
    start = place.learned[0].at
    seen = [
        Seen((session.at - start) / YEAR, session.temperature, known.calibration(session.id))
        for session in place.learned
        if session.temperature is not None
    ]
    between = place.reference.temperature, place.session.temperature
    assert between[0] is not None
    assert between[1] is not None
    steps, laws = (between[0], between[1]), unit_type.temperature_laws
    return temperature_steps(seen, reference, steps, tolerances_of(unit_type, reference), laws)


def _of_recording(known: KnownUnit, rules: Judging, place: Place, unit_type: UnitType) -> Rejudgement:
    """A recording in service moves the calibration that it is compared with, so it is compared anew."""
    calibration, id = known.calibration(place.session.id), place.session.id
    if place.reference is None:
        return Rejudgement(place.basis, unit_type, Judged(calibration, (), NOTHING_TO_COMPARE, is_reference=False))
    sha256, filename = known.file(id)
    try:
        source = read_upload(rules.files.content(sha256), filename)
    except (*LOST, SessionError) as lost:
        return Rejudgement(
            place.basis,
            unit_type,
            Judged(calibration, (), say("It cannot be compared: {lost}", lost=lost), is_reference=False),
        )
    reference = known.calibration(place.reference.id)
    found = ReferenceComparison(reference, parity_check(source, reference), source.started_at)
    moved = parity_calibration(found.result, reference)
    decided = judge_recording(moved, found, unit_type, rules.coverage_factor, place.session.temperature)
    return Rejudgement(place.basis, unit_type, decided, made(moved))


def fitting(rules: Judging, places: Sequence[Place], foreseen: Foreseen) -> tuple[Place, ...]:
    """The places that were foreseen so."""
    return tuple(p for p in places if _fits(rules, p, foreseen.outcomes.get(p.session.id)))


def _fits(rules: Judging, place: Place, found: Rejudgement | None) -> bool:
    return found is not None and (found.basis, found.unit_type) == (place.basis, rules.unit_type(place.session.id))


def put(known: KnownUnit, places: Sequence[Place], foreseen: Foreseen, diagnosed: Collection[str]) -> None:
    """Puts down what was worked out of sessions. Those that are diagnosed are still to be weighed."""
    decided = []
    for place in places:
        session, outcome = place.session, foreseen.outcomes[place.session.id]
        basis = (UNWEIGHED if session.id in diagnosed else "") + place.basis
        evidence = verdict_evidence(session.at, outcome.judged)
        decided.append(
            Decided(session.id, session.revision, outcome.judged, basis, evidence, is_first=session.id in known.made)
        )
        if session.programme == IN_SERVICE:
            _move(known, session.id, outcome.moved)
    Derivations(known.store).put_judged(decided)


def _move(known: KnownUnit, id: str, moved: MadeCalibration | None) -> None:
    session = Sessions(known.store).get(id)
    History(known.store).drop(session)
    if moved is not None:
        Calibrations(known.store).put(id, session.revision, moved.packed)
        History(known.store).add(known.unit, ((session, moved.values),))
