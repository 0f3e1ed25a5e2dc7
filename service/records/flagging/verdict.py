"""Step: what the decisions of a session tell of its unit's flags, and that its unit's verdict is another one now."""

from datetime import datetime

from estimator.message import joined, say
from service.flags.records import Concern, Matter, NoticeKind
from service.flags.store import Notices
from service.fleet.store import Refreshed
from service.judging.records import Told
from service.judging.words import reason, verdict_in_words
from service.kit.names import day_of
from service.records.flagging.settle import SERVICE, Occasion
from service.sessions.decision import Decision, Judged, Verdict, worst_of
from service.sessions.records import StoredSession
from service.sessions.words.conditions import condition_of
from service.storage.store import Store

FAILS = (Verdict.FAIL, Verdict.CONDITIONAL_FAIL)
"""Verdicts that raise a flag."""
PASSES = (Verdict.PASS, Verdict.CONDITIONAL_PASS)
"""Verdicts that speak for resolving one."""
WITHIN = "The session of {day} finds every parameter of {sensor} within its tolerance."
NEW_REFERENCE = "The session of {day} is the reference that {sensor} is judged against now."


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
            concerns.append(_concern(sensor, failed))
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


def _concern(sensor: str, failed: tuple[Decision, ...]) -> Concern:
    """The worst parameter in a sentence, the others by name."""
    severity = max(d.verdict.severity for d in failed)
    others = [d.parameter for d in failed if d is not worst_of(failed)]
    more = say(" Also out of tolerance: {others}.", others=joined(", ", others)) if others else ""
    return Concern(Matter.TOLERANCE, sensor, severity, reason(failed) + more)
