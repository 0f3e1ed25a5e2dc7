"""Step: the open flags of a unit as its accepted sessions tell them, one after another in the order of time.

A session raises a matter, a later one shows it again or finds it in order; only a person resolves it. What a person
resolved stays resolved until a session measured later than those that the person had seen shows it again. So the open
flags are a function of the accepted sessions and of what people resolved, in whatever order the files came in.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from datetime import datetime

from estimator.causes import cause
from estimator.diagnosis import Finding
from estimator.message import joined, say
from estimator.session import CALIBRATIONS
from service.diagnosis.records import Diagnosed, StoredDiagnosis
from service.diagnosis.words.causes import UNKNOWN_CAUSE, what_is_wrong
from service.diagnosis.words.findings import summed_up
from service.flags.records import Concern, Flag, FlagState, Matter, NoticeKind
from service.flags.store import Flags, Notices
from service.fleet.store import Fleet, Refreshed
from service.judging.records import Told
from service.judging.store import Derivations, Key, Moment
from service.judging.words import reason, verdict_in_words
from service.kit.measures import day_of
from service.models.records import ModelRevision
from service.models.rules import in_force, places_of
from service.models.store import Models
from service.sessions.decision import Decision, Judged, Verdict, worst_of
from service.sessions.records import StoredSession
from service.sessions.store import Sessions
from service.sessions.words.conditions import condition_of
from service.storage.queries import Store
from service.units.store import Units

SERVICE = "imu-health"
"""Who raises flags."""


@dataclass(frozen=True)
class Occasion:
    """On which unit, by what and when flags are settled."""

    unit: int
    session: str | None
    """That was looked at; None where the clock or the other units tell."""
    at: datetime


def raise_flag(store: Store, occasion: Occasion, concern: Concern) -> None:
    """Opens a flag on a matter that the clock or the other units tell of, and that has none open."""
    number = Flags(store).add(occasion.unit, concern, occasion.session, occasion.at)
    tell(store, occasion, NoticeKind.RAISED, concern.summary, number)
    Fleet(store).count_flags(occasion.unit)


def see_again(store: Store, occasion: Occasion, known: Flag, concern: Concern) -> None:
    """The open flag speaks of the latest session; one that was acknowledged is raised again where it got worse."""
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


def propose(store: Store, occasion: Occasion, flag: Flag, why: str) -> None:
    """Says that a flag could be resolved, and leaves it to a person."""
    Flags(store).put(flag.id, occasion.at, proposal=why)
    tell(store, occasion, NoticeKind.CLEAR, why, flag.id)


def resolve_as_done(store: Store, occasion: Occasion, flag: Flag, why: str) -> None:
    """Resolves a flag by the service itself."""
    Flags(store).put(flag.id, occasion.at, state=FlagState.RESOLVED, proposal="")
    tell(store, occasion, NoticeKind.RESOLVED, why, flag.id)
    Fleet(store).count_flags(occasion.unit)


def tell(store: Store, occasion: Occasion, kind: NoticeKind, text: str, flag: int) -> None:
    """Keeps what happened to a flag, for people and for programs that are told."""
    Notices(store).add(occasion.unit, kind, occasion.at, SERVICE, text, flag=flag, session=occasion.session)


FAILS = (Verdict.FAIL, Verdict.CONDITIONAL_FAIL)
"""Verdicts that raise a flag."""
PASSES = (Verdict.PASS, Verdict.CONDITIONAL_PASS)
"""Verdicts that speak for resolving one."""
WITHIN = "The session of {day} finds every parameter of {sensor} within its tolerance."
NEW_REFERENCE = "{sensor} is now judged against the session of {day}."


def tell_verdict(store: Store, occasion: Occasion, latest: StoredSession, was: Refreshed) -> None:
    """Tells of another verdict of the unit, where its latest session has another than was known."""
    if was.before is None or was.before is latest.verdict:
        return
    before = condition_of(was.before, is_reference=was.was_reference).word
    now = verdict_in_words(condition_of(latest.verdict, is_reference=latest.is_reference), latest.reservations)
    text = say("{before} → {now}. {reason}", before=before, now=now, reason=latest.reason)
    Notices(store).add(occasion.unit, NoticeKind.VERDICT, occasion.at, SERVICE, text, session=latest.id)


def told_by(measured_at: datetime, judged: Judged) -> Told:
    """One concern a sensor that is out of tolerance; a sensor that is wholly within it is clear, and every sensor of a
    new reference."""
    day = day_of(measured_at)
    concerns, clear = [], []
    for sensor, own in _by_sensor(judged).items():
        failed = tuple(d for d in own if d.verdict in FAILS)
        if failed:
            concerns.append(_verdict_concern(sensor, failed))
        elif judged.is_reference:
            clear.append((Matter.TOLERANCE.value, sensor, say(NEW_REFERENCE, day=day, sensor=sensor)))
        elif own and all(d.verdict in PASSES for d in own):
            clear.append((Matter.TOLERANCE.value, sensor, say(WITHIN, day=day, sensor=sensor)))
    return Told(tuple(concerns), tuple(clear))


def _by_sensor(judged: Judged) -> dict[str, list[Decision]]:
    by_sensor: dict[str, list[Decision]] = {sensor.name: [] for sensor in judged.calibration.sensors}
    for decision in judged.decisions:
        by_sensor.setdefault(decision.sensor, []).append(decision)
    return by_sensor


def _verdict_concern(sensor: str, failed: tuple[Decision, ...]) -> Concern:
    """The worst parameter in a sentence, the others by name."""
    severity = max(d.verdict.severity for d in failed)
    others = [d.parameter for d in failed if d is not worst_of(failed)]
    more = say(" Also out of tolerance: {others}.", others=joined(", ", others)) if others else ""
    return Concern(Matter.TOLERANCE, sensor, severity, reason(failed) + more)


NO_LONGER_FOUND = "The diagnosis of the session of {day} no longer finds it."


def flag_diagnosis(store: Store, made: StoredDiagnosis, at: datetime) -> None:
    """Keeps what the diagnosis tells and settles the unit's flags. A session without a diagnosis tells nothing: a
    failed one, or a recording in which no causes are looked for. Nor does an alignment: how a block sits on a turntable
    is no fault of the unit, and nothing else is looked for there. One without a degree of freedom clears nothing."""
    session = Sessions(store).get(made.session)
    if made.found is None or session.programme not in CALIBRATIONS:
        return
    unit = Units(store).hold(session.unit)
    accepted = in_force(Models(store).of_session(session.id))
    concerns = tuple(_concerns(made.found, session, accepted))
    clear = () if made.found.calibration.fit.is_exact else tuple(_clear(session))
    Derivations(store).tell(session.id, Told(concerns, clear))
    settle_sessions(store, Occasion(unit, session.id, at))


def _clear(session: StoredSession) -> Iterator[tuple[str, str, str]]:
    """What the session no longer shows where it names nothing; on one stand it says nothing of another."""
    gone = say(NO_LONGER_FOUND, day=day_of(session.started_at))
    yield Matter.CAUSE.value, ANY, gone
    yield Matter.UNEXPLAINED.value, ANY, gone
    if session.stand is not None:
        yield Matter.STAND.value, session.stand, gone


def _concerns(found: Diagnosed, session: StoredSession, accepted: tuple[ModelRevision, ...]) -> Iterator[Concern]:
    """At most one a matter and place; what an engineer accepted into the model is known and raises nothing."""
    sensors = found.calibration.sensors
    known = {(revision.cause, place) for revision in accepted for place in places_of(revision, sensors)}
    done: set[tuple[str, str]] = set()
    for finding in found.findings:
        for concern in _of_finding(finding, found.findings, session, known):
            if concern.key not in done:
                done.add(concern.key)
                yield concern
    if found.structures:
        yield Concern(Matter.UNEXPLAINED, "", 1, summed_up(found.structures))


def _of_finding(
    finding: Finding, findings: tuple[Finding, ...], session: StoredSession, known: set[tuple[str, str]]
) -> Iterator[Concern]:
    """Where several causes are equally possible, all that are known must act on the sensor, or all on the stand.

    A mere change since earlier sessions is left to the tolerances: they say whether it matters. What only several
    sessions show together has a flag of theirs.
    """
    if finding.over_sessions is not None:
        return
    name, what = finding.cause, what_is_wrong(finding, findings)
    possible = [cause(identifier) for identifier in (name, *finding.alternatives) if identifier != UNKNOWN_CAUSE]
    if all(one.is_of_sensor for one in possible):
        for sensor in finding.sensors:
            if (name, sensor) not in known:
                yield Concern(Matter.CAUSE, sensor, 1, what)
    elif all(one.scope == "stand" for one in possible) and session.stand is not None and (name, "") not in known:
        yield Concern(Matter.STAND, session.stand, 1, what)


MATTERS = (Matter.TOLERANCE, Matter.CAUSE, Matter.UNEXPLAINED, Matter.STAND)
"""That sessions tell of; the clock and the other units tell of the rest."""
ANY = "*"
"""Every place."""
NOT_SHOWN = "No accepted session shows it."


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
