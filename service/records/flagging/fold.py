"""Step: the open flags of a unit from its accepted sessions, one after another in the order of time.

A session raises a matter, a later one shows it again or finds it in order. A matter that a diagnosis no longer finds is
closed with its reason; only a person settles that a sensor was out of tolerance. A matter that a person resolved stays
resolved until a session measured later than those that the person had seen shows it again. So the open flags are a
function of the accepted sessions and of people's resolutions, in whatever order the files came in.
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
from service.flags.records import Concern, Flag, Matter, NoticeKind
from service.flags.store import Flags, Notices
from service.fleet.store import Fleet, Refreshed
from service.judging.judge import FAILS
from service.judging.records import FlagEvidence, Key, Moment, SessionEvidence
from service.judging.store import Derivations
from service.judging.words import reason, verdict_in_words
from service.kit.measures import day_of
from service.models.records import ModelRevision
from service.models.rules import in_force, places_of
from service.models.store import Models
from service.records.flagging.acts import SERVICE, Occasion, resolve_as_done, see_again, tell
from service.records.flagging.stands import NOT_SHOWN, OF_STAND, settle_stand
from service.sessions.decision import Decision, Judged, Verdict, worst_of
from service.sessions.records import StoredSession
from service.sessions.store import Sessions
from service.sessions.words.conditions import condition_of
from service.sessions.words.motion import beyond_in_words
from service.storage.queries import Store
from service.units.store import Units

PASSES = (Verdict.PASS, Verdict.CONDITIONAL_PASS)
"""Verdicts by which a flag could be resolved."""
WITHIN = "The session of {day} finds every parameter of {sensor} within its tolerance."
ALL_WITHIN = "The session of {day} finds every sensor within its tolerance."
NEW_REFERENCE = "{sensor} is now judged against the session of {day}."


def tell_verdict(store: Store, occasion: Occasion, latest: StoredSession, was: Refreshed) -> None:
    """A notice of another verdict of the unit, where its latest session has another than was known."""
    if was.before is None or was.before is latest.verdict:
        return
    before = condition_of(was.before, is_reference=was.was_reference).word
    now = verdict_in_words(condition_of(latest.verdict, is_reference=latest.is_reference), latest.reservations)
    text = say("{before} → {after}. {reason}", before=before, after=now, reason=latest.reason)
    Notices(store).add(occasion.unit, NoticeKind.VERDICT, occasion.at, SERVICE, text, session=latest.id)


def verdict_evidence(measured_at: datetime, judged: Judged) -> FlagEvidence:
    """One concern a sensor that is out of tolerance or fails within the session; a sensor that is wholly within it is
    clear, and every sensor of a new reference."""
    day = day_of(measured_at)
    concerns, clear = [*_fault_concerns(judged)], []
    at_fault = {sensor for fault in judged.faults for sensor in fault.sensors}
    for sensor, decisions in _by_sensor(judged).items():
        if sensor in at_fault:
            continue
        failed = tuple(d for d in decisions if d.verdict in FAILS)
        if failed:
            concerns.append(_verdict_concern(sensor, failed, judged))
        elif judged.is_reference:
            clear.append((Matter.TOLERANCE.value, sensor, say(NEW_REFERENCE, day=day, sensor=sensor)))
        elif decisions and all(d.verdict in PASSES for d in decisions):
            clear.append((Matter.TOLERANCE.value, sensor, say(WITHIN, day=day, sensor=sensor)))
    if len(clear) == len(judged.calibration.sensors) and not judged.is_reference:
        clear.append((Matter.TOLERANCE.value, "", say(ALL_WITHIN, day=day)))
    return FlagEvidence(tuple(concerns), tuple(clear))


def _fault_concerns(judged: Judged) -> Iterator[Concern]:
    """One a sensor; of the unit as a whole where no single one is named."""
    for place in dict.fromkeys(fault.place for fault in judged.faults):
        said = joined(" ", (fault.sentence for fault in judged.faults if fault.place == place))
        yield Concern(Matter.TOLERANCE, place, Verdict.FAIL.severity, said)


def _by_sensor(judged: Judged) -> dict[str, list[Decision]]:
    by_sensor: dict[str, list[Decision]] = {sensor.name: [] for sensor in judged.calibration.sensors}
    for decision in judged.decisions:
        by_sensor.setdefault(decision.sensor, []).append(decision)
    return by_sensor


def _verdict_concern(sensor: str, failed: tuple[Decision, ...], judged: Judged) -> Concern:
    """The worst parameter in a sentence, the others by name; that all scale factors changed together, with each."""
    severity = max(d.verdict.severity for d in failed)
    others = [d.parameter for d in failed if d is not worst_of(failed)]
    more = say(" Also out of tolerance: {parameters}.", parameters=joined(", ", others)) if others else ""
    together = [m for m in judged.motions if any(d.kind == m.kind and d.parameter == "scale" for d in failed)]
    said = (reason(failed) + more, *beyond_in_words(together, failed[0].nominal_factor))
    return Concern(Matter.TOLERANCE, sensor, severity, joined(" ", said))


NO_LONGER_FOUND = "The diagnosis of the session of {day} no longer finds it."


def flag_diagnosis(store: Store, made: StoredDiagnosis, at: datetime) -> None:
    """Keeps what the diagnosis says and settles the unit's flags. A session without a diagnosis says nothing: a
    failed one, or a recording in which no causes are looked for. Nor does an alignment: how a block sits on a turntable
    is no fault of the unit, and nothing else is looked for there. One without a degree of freedom clears nothing."""
    session = Sessions(store).get(made.session)
    if made.found is None or session.programme not in CALIBRATIONS:
        return
    unit = Units(store).hold(session.unit)
    accepted = in_force(Models(store).of_session(session.id))
    concerns = tuple(_concerns(made.found, session, accepted))
    clear = () if made.found.calibration.fit.is_exact else tuple(_clear(session))
    Derivations(store).keep_evidence(session.id, FlagEvidence(concerns, clear))
    settle_sessions(store, Occasion(unit, session.id, at))


def _clear(session: StoredSession) -> Iterator[tuple[str, str, str]]:
    """The matters that a session without findings closes; on one stand it says nothing of another."""
    gone = say(NO_LONGER_FOUND, day=day_of(session.started_at))
    yield Matter.CAUSE.value, ANY, gone
    yield Matter.UNEXPLAINED.value, ANY, gone
    if session.stand is not None:
        yield Matter.STAND.value, session.stand, gone


def _concerns(found: Diagnosed, session: StoredSession, accepted: tuple[ModelRevision, ...]) -> Iterator[Concern]:
    """One a matter and place; what an engineer accepted into the model is known and raises nothing."""
    sensors = found.calibration.sensors
    known = {(revision.cause, place) for revision in accepted for place in places_of(revision, sensors)}
    by_key: dict[tuple[str, str], list[Concern]] = {}
    for finding in found.findings:
        for concern in _of_finding(finding, found.findings, session, known):
            by_key.setdefault(concern.key, []).append(concern)
    for first, *others in by_key.values():
        said = dict.fromkeys((first.summary, *(concern.summary for concern in others)))
        yield replace(first, summary=joined(" ", said))
    if found.structures:
        yield Concern(Matter.UNEXPLAINED, "", 1, summed_up(found.structures))


def _of_finding(
    finding: Finding, findings: tuple[Finding, ...], session: StoredSession, known: set[tuple[str, str]]
) -> Iterator[Concern]:
    """The concerns of a finding. Where several causes are equally possible, all known ones must act on the sensor, or
    all on the stand.

    A mere change since earlier sessions is left to the tolerances: they decide whether it matters. An effect found only
    in several sessions together has a flag of its own. A course that sensors share is one matter, of the unit.
    """
    if finding.over_sessions is not None:
        return
    name, statement = finding.cause, what_is_wrong(finding, findings)
    possible = [cause(identifier) for identifier in (name, *finding.alternatives) if identifier != UNKNOWN_CAUSE]
    if all(c.is_of_sensor for c in possible):
        new = [sensor for sensor in finding.sensors if (name, sensor) not in known]
        for place in new if finding.shared is None else [""] * bool(new):
            yield Concern(Matter.CAUSE, place, 1, statement)
    elif all(c.scope == "stand" for c in possible) and session.stand is not None and (name, "") not in known:
        yield Concern(Matter.STAND, session.stand, 1, statement)


MATTERS = (Matter.TOLERANCE, Matter.CAUSE, Matter.UNEXPLAINED)
"""Matters that a unit's own sessions decide; the rest depends on sessions on a stand, on the clock and on other
units.
"""
ANY = "*"
"""Placeholder of every place."""


@dataclass(frozen=True)
class Opened:
    """A matter that is open."""

    concern: Concern
    session: str
    """Last session that showed it."""
    at: Moment
    """Moment of that session."""
    proposal: str = ""


@dataclass(frozen=True)
class Lives:
    """Open and closed matters after the sessions so far."""

    opened: dict[Key, Opened]
    closed: dict[Key, str]
    """Matters that were shown and are no longer, and why."""


def settle_sessions(store: Store, occasion: Occasion) -> None:
    """Brings the flags that sessions raise in line with the unit's accepted sessions."""
    sessions = Derivations(store).evidence(occasion.unit)
    opened = {f.key: f for f in Flags(store).open_of(occasion.unit) if f.matter in (*MATTERS, Matter.STAND)}
    lives = _lives(sessions, tuple(opened.values()))
    settled = Derivations(store).settled(occasion.unit, SERVICE) if lives.opened else {}
    wanted = {key: life for key, life in lives.opened.items() if key not in settled or settled[key] < life.at}
    for key, life in wanted.items():
        _bring(store, occasion, opened.get(key), life)
    for key, flag in opened.items():
        if key not in wanted:
            why = OF_STAND if flag.matter is Matter.STAND else lives.closed.get(key, NOT_SHOWN)
            resolve_as_done(store, occasion, flag, why)
    if wanted.keys() - opened.keys():
        Fleet(store).count_flags(occasion.unit)
    for stand in sorted({*_faulty_stands(sessions), *Flags(store).open_stands_of(occasion.unit)}):
        settle_stand(store, occasion, stand)


def _faulty_stands(sessions: Iterable[SessionEvidence]) -> Iterator[str]:
    """Stands that a unit's sessions find at fault."""
    for session in sessions:
        for concern in () if session.diagnosis is None else session.diagnosis.concerns:
            if concern.matter is Matter.STAND:
                yield concern.place


def _lives(sessions: Iterable[SessionEvidence], opened: Iterable[Flag]) -> Lives:
    """The open and the closed matters after a unit's sessions, one after another."""
    lives = Lives({}, {})
    for session in sessions:
        kept = tuple(_concern(flag) for flag in opened if flag.session == session.at[1]) if session.is_old else ()
        for evidence in (session.verdict, session.diagnosis, FlagEvidence(kept, ())):
            if evidence is not None:
                lives = _after(lives, evidence, session.at)
    return lives


def _after(lives: Lives, evidence: FlagEvidence, at: Moment) -> Lives:
    """The matters after one more session. A sensor out of tolerance is left to a person, who states why it is back; a
    finding of a diagnosis is closed by one that no longer has it.
    """
    shown = {c.key: Opened(c, at[1], at) for c in evidence.concerns if c.matter in MATTERS}
    clear = {(matter, place): why for matter, place, why in evidence.clear}
    gone = {key: why for key in lives.opened if (why := clear.get(key) or clear.get((key[0], ANY)))}
    closed = {key: why for key, why in gone.items() if key[0] != Matter.TOLERANCE}
    left = {
        key: replace(life, proposal=life.proposal or gone.get(key, ""))
        for key, life in lives.opened.items()
        if key not in closed
    }
    return Lives(left | shown, {key: why for key, why in (lives.closed | closed).items() if key not in shown})


def _concern(flag: Flag) -> Concern:
    return Concern(flag.matter, flag.place, flag.severity, flag.summary)


def _bring(store: Store, occasion: Occasion, known: Flag | None, wanted: Opened) -> None:
    """Raises a flag, shows it again or proposes to resolve it."""
    of_session = replace(occasion, session=wanted.session)
    if known is None:
        number = Flags(store).add(of_session.unit, wanted.concern, of_session.session, of_session.at)
        tell(store, of_session, NoticeKind.RAISED, wanted.concern.summary, number)
        proposal = ""
    else:
        number, proposal = known.id, known.proposal
        was = (known.summary, known.severity, known.session)
        taken_back = bool(proposal) and not wanted.proposal
        if was != (wanted.concern.summary, wanted.concern.severity, wanted.session) or taken_back:
            see_again(store, of_session, known, wanted.concern)
            proposal = ""
    if wanted.proposal and wanted.proposal != proposal:
        Flags(store).put(number, of_session.at, proposal=wanted.proposal)
        tell(store, occasion, NoticeKind.CLEAR, wanted.proposal, number)
