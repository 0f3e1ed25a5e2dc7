"""Step: what the diagnosis of a session tells of its unit's flags."""

from collections.abc import Iterator
from datetime import datetime

from estimator.causes import cause
from estimator.diagnosis import Finding
from estimator.message import say
from estimator.session import CALIBRATIONS
from service.diagnosis.records import Diagnosed, StoredDiagnosis
from service.diagnosis.words.causes import UNKNOWN_CAUSE, what_is_wrong
from service.diagnosis.words.structures import summed_up
from service.flags.records import Concern, Matter
from service.judging.records import Told
from service.judging.store import Derivations
from service.kit.names import day_of
from service.models.records import ModelRevision
from service.models.rules import in_force, places_of
from service.models.store import Models
from service.records.flagging.fold import ANY, settle_sessions
from service.records.flagging.settle import Occasion
from service.sessions.records import StoredSession
from service.sessions.store import Sessions
from service.storage.store import Store
from service.units.store import Units

GONE = "The diagnosis of the session of {day} no longer finds it."


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
    gone = say(GONE, day=day_of(session.started_at))
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
