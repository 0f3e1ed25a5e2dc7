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
from service.records.flagging.accepted import AcceptedCauses, accepted_in_words
from service.records.flagging.acts import COVERED, SERVICE, Occasion, resolve_as_done, see_again, tell
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
    concerns = tuple(_concerns(made.found, session))
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


def _concerns(found: Diagnosed, session: StoredSession) -> Iterator[Concern]:
    """Concerns of every finding, with the causes that explain each."""
    kinds = {sensor.name: sensor.kind for sensor in found.calibration.sensors}
    for finding in found.findings:
        yield from _of_finding(finding, found.findings, session, kinds)
    if found.structures:
        yield Concern(Matter.UNEXPLAINED, "", 1, summed_up(found.structures))


def _of_finding(
    finding: Finding, findings: tuple[Finding, ...], session: StoredSession, kinds: dict[str, str]
) -> Iterator[Concern]:
    """The concerns of a finding. Where several causes are equally possible, all known ones must act on the sensor, or
    all on the stand.

    A mere change since earlier sessions is left to the tolerances: they decide whether it matters. An effect found only
    in several sessions together has a flag of its own. A course that sensors share is one matter, of the unit.
    """
    if finding.over_sessions is not None:
        return
    statement = what_is_wrong(finding, findings)
    possible = [cause(name) for name in (finding.cause, *finding.alternatives) if name != UNKNOWN_CAUSE]
    causes = tuple(c.identifier for c in possible)
    if all(c.is_of_sensor for c in possible):
        acts_on = tuple((sensor, kinds[sensor]) for sensor in finding.sensors)
        places = {sensor: ((sensor, kind),) for sensor, kind in acts_on} if finding.shared is None else {"": acts_on}
        for place, sensors in places.items():
            yield Concern(Matter.CAUSE, place, 1, statement, causes=causes, sensors=sensors)
    elif all(c.scope == "stand" for c in possible) and session.stand is not None:
        yield Concern(Matter.STAND, session.stand, 1, statement, causes=causes)


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
    lives = _lives(sessions, tuple(opened.values()), AcceptedCauses(store, sessions))
    settled = Derivations(store).settled(occasion.unit, SERVICE) if lives.opened else {}
    wanted, covered = _one_a_sensor(_unsettled(lives.opened, settled))
    for key, life in wanted.items():
        _bring(store, occasion, opened.get(key), life)
    for key, flag in opened.items():
        if key not in wanted:
            gone = COVERED if key in covered else lives.closed.get(key, NOT_SHOWN)
            why = OF_STAND if flag.matter is Matter.STAND else gone
            resolve_as_done(store, occasion, flag, why)
    if wanted.keys() - opened.keys():
        Fleet(store).count_flags(occasion.unit)
    for stand in sorted({*_faulty_stands(sessions), *Flags(store).open_stands_of(occasion.unit)}):
        settle_stand(store, occasion, stand)


def _unsettled(opened: dict[Key, Opened], settled: dict[Key, Moment]) -> dict[Key, Opened]:
    """The matters that a later session showed than those known when a person resolved them."""
    known = {key: max((settled[k] for k in _flags_of(key) & settled.keys()), default=None) for key in opened}
    return {key: life for key, life in opened.items() if (at := known[key]) is None or at < life.at}


def _flags_of(key: Key) -> set[Key]:
    """Flags that say a matter: a cause is also said by the flag of a sensor out of tolerance."""
    matter, place = key
    return {key, (Matter.TOLERANCE.value, place)} if matter == Matter.CAUSE else {key}


def _one_a_sensor(wanted: dict[Key, Opened]) -> tuple[dict[Key, Opened], set[Key]]:
    """One flag a sensor: what is out of tolerance, with its cause; and the matters that another flag covers."""
    out = {place: life for (matter, place), life in wanted.items() if matter == Matter.TOLERANCE}
    causes = {place: life for (matter, place), life in wanted.items() if matter == Matter.CAUSE and place in out}
    covered = {(Matter.CAUSE.value, place) for place in causes}
    merged = {(Matter.TOLERANCE.value, place): _with_cause(out[place], life) for place, life in causes.items()}
    return {key: life for key, life in (wanted | merged).items() if key not in covered}, covered


def _with_cause(out: Opened, cause: Opened) -> Opened:
    latest = max(out, cause, key=lambda life: life.at)
    said = joined(" ", (out.concern.summary, cause.concern.summary))
    return replace(out, concern=replace(out.concern, summary=said), session=latest.session, at=latest.at)


def _faulty_stands(sessions: Iterable[SessionEvidence]) -> Iterator[str]:
    """Stands that a unit's sessions find at fault."""
    for session in sessions:
        for concern in () if session.diagnosis is None else session.diagnosis.concerns:
            if concern.matter is Matter.STAND:
                yield concern.place


def _lives(sessions: Iterable[SessionEvidence], opened: Iterable[Flag], accepted: AcceptedCauses) -> Lives:
    """The open and the closed matters after a unit's sessions, one after another."""
    lives = Lives({}, {})
    for session in sessions:
        kept = tuple(_concern(flag) for flag in opened if flag.session == session.at[1]) if session.is_old else ()
        for evidence in (session.verdict, session.diagnosis, FlagEvidence(kept, ())):
            if evidence is not None:
                lives = _after(lives, _unexplained(evidence, session.unit, accepted), session.at)
    return lives


def _unexplained(evidence: FlagEvidence, unit: str, accepted: AcceptedCauses) -> FlagEvidence:
    """The evidence without the concerns that an accepted cause explains: it clears them."""
    known = [(concern, accepted.explain(unit, concern)) for concern in evidence.concerns]
    left = tuple(concern for concern, revision in known if revision is None)
    cleared = ((*concern.key, accepted_in_words(revision)) for concern, revision in known if revision is not None)
    return FlagEvidence(left, (*evidence.clear, *cleared))


def _after(lives: Lives, evidence: FlagEvidence, at: Moment) -> Lives:
    """The matters after one more session. A sensor out of tolerance is left to a person, who states why it is back; a
    finding of a diagnosis is closed by one that no longer has it.
    """
    shown = {concern.key: Opened(concern, at[1], at) for concern in _merged(evidence.concerns)}
    clear = {(matter, place): why for matter, place, why in evidence.clear}
    gone = {key: why for key in lives.opened if (why := clear.get(key) or clear.get((key[0], ANY)))}
    closed = {key: why for key, why in (clear | gone).items() if key[0] != Matter.TOLERANCE}
    left = {
        key: replace(life, proposal=life.proposal or gone.get(key, ""))
        for key, life in lives.opened.items()
        if key not in closed
    }
    return Lives(left | shown, {key: why for key, why in (lives.closed | closed).items() if key not in shown})


def _merged(concerns: Iterable[Concern]) -> Iterator[Concern]:
    """One a matter and place, which says all of it."""
    by_key: dict[Key, list[Concern]] = {}
    for concern in concerns:
        if concern.matter in MATTERS:
            by_key.setdefault(concern.key, []).append(concern)
    for first, *others in by_key.values():
        yield replace(first, summary=joined(" ", dict.fromkeys((first.summary, *(c.summary for c in others)))))


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
