"""Step: what the decisions of a unit's latest session mean for its verdict and its flags."""

from estimator.session import CALIBRATIONS
from service.flows.flagging.settle import SERVICE, Found, Occasion, resolve_as_done, settle
from service.records.decision import Decision, Verdict, worst_of
from service.records.flag import Concern, Flag, Matter, NoticeKind
from service.records.session import StoredSession
from service.storage.queries.fleet import Refreshed
from service.storage.store import Store
from service.words.conditions import condition_of
from service.words.names import day_of
from service.words.verdict import reason

FAILS = (Verdict.FAIL, Verdict.CONDITIONAL_FAIL)
"""Verdicts that raise a flag."""
PASSES = (Verdict.PASS, Verdict.CONDITIONAL_PASS)
"""Verdicts that speak for resolving one."""
WITHIN = "The session of {day} finds every parameter of {sensor} within its tolerance."
NEW_REFERENCE = "The session of {day}, after a service, is the new reference."


def flag_verdict(
    store: Store, occasion: Occasion, session: StoredSession, decisions: tuple[Decision, ...], was: Refreshed
) -> None:
    """Tells of another verdict of the unit and settles its flags; an older session than its latest says nothing."""
    if was.last_session != session.id:
        return
    if was.before is not None and was.before is not session.verdict:
        before = condition_of(was.before, is_reference=was.was_reference).word
        now = condition_of(session.verdict, is_reference=session.is_reference).word
        text = f"{before} → {now}. {session.reason}"
        store.notices.add(occasion.unit, NoticeKind.VERDICT, occasion.at, SERVICE, text, session=session.id)
    opened = store.flags.open_of(occasion.unit)
    settle(store, occasion, opened, found_by(session, decisions))
    if session.programme in CALIBRATIONS:
        _no_longer_overdue(store, occasion, opened, session)


def found_by(session: StoredSession, decisions: tuple[Decision, ...]) -> Found:
    """One concern a sensor that is out of tolerance; a sensor that is wholly within it is clear."""
    by_sensor: dict[str, list[Decision]] = {}
    for decision in decisions:
        by_sensor.setdefault(decision.sensor, []).append(decision)
    day = day_of(session.started_at)
    concerns, clear = [], {}
    for sensor, own in by_sensor.items():
        failed = tuple(d for d in own if d.verdict in FAILS)
        if failed:
            concerns.append(_concern(sensor, failed))
        elif session.is_reference:
            clear[(Matter.TOLERANCE.value, sensor)] = NEW_REFERENCE.format(day=day)
        elif all(d.verdict in PASSES for d in own):
            clear[(Matter.TOLERANCE.value, sensor)] = WITHIN.format(day=day, sensor=sensor)
    return Found(tuple(concerns), clear)


def _concern(sensor: str, failed: tuple[Decision, ...]) -> Concern:
    """The worst parameter in a sentence, the others by name."""
    severity = max(d.verdict.severity for d in failed)
    others = [d.parameter for d in failed if d is not worst_of(failed)]
    more = f" Also out of tolerance: {', '.join(others)}." if others else ""
    return Concern(Matter.TOLERANCE, sensor, severity, reason(failed) + more)


def _no_longer_overdue(store: Store, occasion: Occasion, opened: tuple[Flag, ...], session: StoredSession) -> None:
    """The one matter that resolves itself: the calibration that was due has been done, and the next is not yet due."""
    overdue = [flag for flag in opened if flag.matter is Matter.OVERDUE]
    outlook = store.outlooks.of_unit(session.unit) if overdue else None
    if outlook is None or (outlook.due is not None and outlook.due < occasion.at):
        return
    for flag in overdue:
        resolve_as_done(store, occasion, flag, f"Calibrated on {day_of(session.started_at)}.")
