"""Permitted use of a unit: decided here alone, from all its facts. Pages, labels, exports, the calendar, reports and
programs all give this answer. In doubt it may not be used.

It rests on the unit's latest accepted session. The cases are tabled in `docs/api.md`.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import datetime

from estimator.message import joined, say
from service.flags.records import Matter
from service.fleet.use import SLACK, Use, in_words
from service.judging import usable_words as words
from service.judging.fault_words import remedy_in
from service.judging.records import Usable, UseFacts
from service.kit.failure import session_failed, unit_failed
from service.kit.measures import day_of
from service.outlook.records import Action
from service.outlook.words import UNFIT
from service.sessions.decision import Verdict
from service.sessions.doubt import DoubtKind as Doubt
from service.sessions.doubt import Reservation
from service.sessions.words.conditions import advice_of, condition_of

FORBIDDING = (Matter.TOLERANCE,)
"""Flags that forbid the use until they are resolved, acknowledged or not: others are reservations. That a calibration
is overdue is asked of the clock, because its flag is raised once an hour only."""
WHOLE_TOLERANCE = 1.0
"""Share of a tolerance from which on an effect that the verdict leaves out forbids the use."""
MOST_NAMED = 4
"""Parameters, by name, before the rest are counted."""


@dataclass(frozen=True)
class Objection:
    """One reason against the use, or fact to know."""

    text: str
    """Objection in a sentence."""
    action: str = ""
    """Action to take, as a clause."""
    is_pending: bool = False
    """Whether it passes by itself."""


Rule = Callable[[UseFacts, datetime], Iterator[Objection]]


def usable(facts: UseFacts, now: datetime) -> Usable:
    """The answer for one unit."""
    against = tuple(sorted(_found(AGAINST, facts, now), key=lambda objection: objection.is_pending))
    reserved = _found(RESERVING, facts, now)
    use, unit = _use(against, reserved), facts.unit
    action = next((objection.action for objection in (against or reserved) if objection.action), "")
    is_judged = not unit.is_reference and not _is_serviced_since(facts)
    return Usable(
        usable=not against,
        answer=use,
        use=in_words(use, action),
        why=against[0].text if against else _yes(facts),
        action=action,
        reasons=tuple(objection.text for objection in against),
        reservations=tuple(objection.text for objection in reserved),
        until=None if unit.retired_at is not None else unit.due,
        verdict=unit.verdict if is_judged else None,
        session=unit.last_session if is_judged else None,
        correction=facts.correction,
        as_of=now,
        due_reason=unit.due_reason,
    )


def _found(rules: tuple[Rule, ...], facts: UseFacts, now: datetime) -> tuple[Objection, ...]:
    return tuple(objection for rule in rules for objection in rule(facts, now))


def _use(against: tuple[Objection, ...], reserved: tuple[Objection, ...]) -> Use:
    if against:
        return Use.PENDING if all(objection.is_pending for objection in against) else Use.NO
    return Use.RESERVED if reserved else Use.YES


def _yes(facts: UseFacts) -> str:
    unit = facts.unit
    assert unit.last_at is not None  # without a session or a date something speaks against the use
    assert unit.due is not None
    if unit.is_reference:
        return words.on(words.BY_REFERENCE, unit.last_at, due=day_of(unit.due))
    return words.on(words.YES, unit.last_at, word=condition_of(unit.verdict).word, due=day_of(unit.due))


def _is_serviced_since(facts: UseFacts) -> bool:
    """Whether the unit was serviced after its latest session."""
    serviced, last = facts.serviced_at, facts.unit.last_at
    return serviced is not None and (last is None or last < serviced)


def _is_measured(facts: UseFacts) -> bool:
    """Whether a session shows the unit as it is now."""
    return facts.unit.last_at is not None and not _is_serviced_since(facts)


def _retired(facts: UseFacts, _: datetime) -> Iterator[Objection]:
    if facts.unit.retired_at is not None:
        yield Objection(words.on(words.RETIRED, facts.unit.retired_at), words.RETURN)


def _unmeasured(facts: UseFacts, _: datetime) -> Iterator[Objection]:
    unit = facts.unit
    if facts.serviced_at is not None and _is_serviced_since(facts):
        yield Objection(words.on(words.SINCE_SERVICE, facts.serviced_at), words.CALIBRATE)
    elif unit.last_at is None or (unit.is_reference and not facts.is_calibration):
        yield Objection(words.NOTHING_JUDGED, words.CALIBRATE)


def _unfit(facts: UseFacts, _: datetime) -> Iterator[Objection]:
    unit = facts.unit
    if unit.last_at is None or not _is_measured(facts) or unit.is_reference:
        return
    if unit.verdict in UNFIT:
        yield Objection(unit.reason, remedy_in(unit.reason) or words.ADJUST)
    elif unit.verdict is Verdict.UNDECIDABLE:
        yield Objection(unit.reason, remedy_in(unit.reason) or words.REPEAT)


def _uncertain(facts: UseFacts, _: datetime) -> Iterator[Objection]:
    found, at = facts.uncertain, facts.unit.last_at
    if found and at is not None and _is_measured(facts):
        more = say(" and {most_named} more", most_named=len(found) - MOST_NAMED) if len(found) > MOST_NAMED else ""
        parameters = joined(", ", found[:MOST_NAMED]) + more
        yield Objection(words.on(words.TOO_COARSE, at, what=parameters), words.MORE_POSITIONS)


def _dated_later(facts: UseFacts, now: datetime) -> Iterator[Objection]:
    at = facts.unit.last_at
    if at is not None and at > now + SLACK:
        yield Objection(words.on(words.FUTURE, at), words.DATE)


def _gravely_reserved(facts: UseFacts, _: datetime) -> Iterator[Objection]:
    if _is_measured(facts) and facts.unit.verdict not in UNFIT:
        yield from _said_with(facts, forbidding=True)


def _said_with(facts: UseFacts, *, forbidding: bool) -> Iterator[Objection]:
    """The verdict's reservations, with the one action that the verdict itself ends with."""
    every = facts.unit.reservations or ()
    action = advice_of(every)
    for reservation in every:
        if forbids(reservation) is forbidding:
            yield Objection(words.reserved(reservation), action)


def forbids(reservation: Reservation) -> bool:
    """Whether the verdict cannot be relied on at all: the file is wrong, the unit is unfit under a model that the
    readings leave standing, or what the verdict leaves out is as large as the tolerance."""
    if reservation.kind is Doubt.OTHER_MODEL:
        return reservation.verdict in UNFIT
    is_large = reservation.share is not None and reservation.share >= WHOLE_TOLERANCE
    return reservation.kind is Doubt.RECORD or (is_large and reservation.kind in (Doubt.CAUSE, Doubt.UNEXPLAINED))


def _flagged(facts: UseFacts, _: datetime) -> Iterator[Objection]:
    for flag in facts.flags:
        if flag.matter in FORBIDDING:
            yield Objection(words.flagged(flag), say(words.SETTLE, id=flag.id))


def _undue(facts: UseFacts, now: datetime) -> Iterator[Objection]:
    """The objection to a unit without a date that is still to come."""
    unit = facts.unit
    if unit.retired_at is not None:
        return
    if unit.due is not None:
        if unit.due < now:
            yield Objection(say(words.OVERDUE, due=day_of(unit.due), reason=unit.due_reason), words.CALIBRATE)
    elif _is_measured(facts) and (unit.is_reference or unit.verdict not in (*UNFIT, Verdict.UNDECIDABLE)):
        yield next(_undated(facts, now), _without_date(facts))


def _without_date(facts: UseFacts) -> Objection:
    """The objection with the action that the outlook names instead of a date."""
    actions = {Action.NOW: words.ADJUST, Action.REPEAT: words.MEASURE_AGAIN}
    if facts.action in actions and facts.unit.due_reason:
        return Objection(facts.unit.due_reason, actions[facts.action])
    return Objection(words.NO_DUE, words.CALIBRATE)


def _undated(facts: UseFacts, _: datetime) -> Iterator[Objection]:
    if facts.unit.failed:
        yield Objection(unit_failed(facts.unit.failed), words.ADMINISTRATOR)
    elif facts.unit.is_undated:
        yield Objection(words.DATES_PENDING, words.ASK_AGAIN, is_pending=True)


def _unjudged(facts: UseFacts, _: datetime) -> Iterator[Objection]:
    if facts.is_waiting and not facts.unit.failed and _is_measured(facts):
        yield Objection(words.VERDICT_PENDING, words.ASK_AGAIN, is_pending=True)


def _slightly_reserved(facts: UseFacts, _: datetime) -> Iterator[Objection]:
    unit = facts.unit
    if unit.last_at is None or not _is_measured(facts):
        return
    yield from _said_with(facts, forbidding=False)
    if unit.reservations is None:
        failed = facts.not_diagnosed
        text = session_failed(failed) if failed else words.on(words.NOT_DIAGNOSED, unit.last_at)
        yield Objection(text, words.ADMINISTRATOR if failed else words.ASK_AGAIN)


def _questioned(facts: UseFacts, _: datetime) -> Iterator[Objection]:
    if facts.questioned_at is not None:
        yield Objection(words.on(words.WAITS, facts.questioned_at), words.ENGINEER)


def _untraceable(facts: UseFacts, _: datetime) -> Iterator[Objection]:
    lapsed, at = facts.expired, facts.unit.last_at
    if lapsed is not None and at is not None and _is_measured(facts):
        text = words.on(words.EXPIRED, at, number=lapsed.number, stand=lapsed.stand, until=day_of(lapsed.valid_until))
        yield Objection(text, words.CERTIFY)


def _unproven(facts: UseFacts, _: datetime) -> Iterator[Objection]:
    at = facts.unit.last_at
    if at is not None and facts.unit.is_reference and facts.is_calibration and _is_measured(facts):
        yield Objection(words.on(words.UNPROVEN, at))


def _close(facts: UseFacts, _: datetime) -> Iterator[Objection]:
    if facts.unit.verdict is Verdict.CONDITIONAL_PASS and _is_measured(facts):
        yield Objection(say(words.CLOSE, reason=facts.unit.reason))


def _noted(facts: UseFacts, _: datetime) -> Iterator[Objection]:
    for flag in facts.flags:
        if flag.matter not in (*FORBIDDING, Matter.OVERDUE):
            yield Objection(words.flagged(flag), say(words.SETTLE, id=flag.id))


AGAINST: tuple[Rule, ...] = (
    _retired, _unmeasured, _unfit, _uncertain, _dated_later, _flagged, _gravely_reserved, _undue, _unjudged
)  # fmt: skip
"""Rules that forbid the use, the gravest first."""
RESERVING: tuple[Rule, ...] = (
    _slightly_reserved, _questioned, _untraceable, _unproven, _close, _noted, _undated
)  # fmt: skip
"""Rules that make reservations, the gravest first."""
