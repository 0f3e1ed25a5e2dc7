"""Uses that a unit is fit for: one row of facts a case, as docs/api.md tables them."""

from dataclasses import replace
from datetime import date, timedelta
from typing import Any

import pytest

from service.flags.records import Matter
from service.fleet.use import Use
from service.judging import usable_words as words
from service.judging.records import OpenFlag, UseFacts
from service.judging.usable import usable
from service.outlook.records import Action
from service.sessions.decision import Verdict
from service.sessions.doubt import DoubtKind as Doubt
from service.sessions.doubt import Reservation
from service.stands.records import StandCertificate
from tests.service.pages.records import NOON, unit_summary

DAY = timedelta(days=1)
UNIT = replace(unit_summary(), due=NOON + 100 * DAY, due_reason="Last calibrated; calibrate again.")
PLAIN = UseFacts(UNIT)
CERTIFICATE = StandCertificate("ODG-1", "D-K-117", "PTB", date(2025, 1, 10), date(2026, 1, 10))


def of_unit(**changes: Any) -> UseFacts:
    return UseFacts(replace(UNIT, **changes))


def said_with(kind: Doubt, **more: Any) -> UseFacts:
    return of_unit(reservations=(Reservation(kind, "something is there", "repeat the session", **more),))


def flagged(matter: Matter) -> UseFacts:
    return replace(PLAIN, flags=(OpenFlag(3, matter, 1, "A3", "A3 moved."),))


CASES: dict[str, tuple[UseFacts, Use, str]] = {
    "fit": (PLAIN, Use.YES, ""),
    "probably fit": (of_unit(verdict=Verdict.CONDITIONAL_PASS), Use.RESERVED, ""),
    "unfit": (of_unit(verdict=Verdict.FAIL), Use.NO, "adjust, repair or withdraw it"),
    "probably unfit": (of_unit(verdict=Verdict.CONDITIONAL_FAIL), Use.NO, "adjust, repair or withdraw it"),
    "undecided": (of_unit(verdict=Verdict.UNDECIDABLE), Use.NO, "repeat the session"),
    "a sound reference only": (of_unit(verdict=Verdict.UNDECIDABLE, is_reference=True), Use.RESERVED, ""),
    "a reference that leaves too much open": (
        replace(of_unit(verdict=Verdict.UNDECIDABLE, is_reference=True), uncertain=("A1 bias",)),
        Use.NO,
        "measure more positions",
    ),
    "a reference of another programme": (
        replace(of_unit(verdict=Verdict.UNDECIDABLE, is_reference=True), is_calibration=False), Use.NO, "calibrate it",
    ),
    "no accepted session": (of_unit(verdict=None, last_at=None, last_session=None, due=None), Use.NO, "calibrate it"),
    "serviced since": (replace(PLAIN, serviced_at=NOON + DAY), Use.NO, "calibrate it"),
    "serviced before": (replace(PLAIN, serviced_at=NOON - DAY), Use.YES, ""),
    "dated in the future": (of_unit(last_at=NOON + 3 * DAY), Use.NO, "put the date of its session right"),
    "overdue": (of_unit(due=NOON - DAY), Use.NO, "calibrate it"),
    "perhaps out of tolerance already": (
        replace(of_unit(due=None), action=Action.REPEAT), Use.NO, "measure it again",
    ),
    "a calibration found it unfit before a recording did not": (
        replace(of_unit(due=None), action=Action.NOW), Use.NO, "adjust, repair or withdraw it",
    ),
    "no date for another reason": (of_unit(due=None), Use.NO, "calibrate it"),
    "dates being worked out, none known": (
        of_unit(due=None, is_undated=True), Use.PENDING, "ask again in a few seconds",
    ),
    "dates being worked out, one known": (of_unit(is_undated=True), Use.RESERVED, "ask again in a few seconds"),
    "verdict being worked out": (replace(PLAIN, is_waiting=True), Use.PENDING, "ask again in a few seconds"),
    "unfit, dates being worked out": (
        of_unit(verdict=Verdict.FAIL, due=None, is_undated=True), Use.NO, "adjust, repair or withdraw it",
    ),
    "dates failed, none known": (of_unit(due=None, failed="it broke"), Use.NO, "tell the administrator"),
    "dates failed, one known": (of_unit(failed="it broke"), Use.RESERVED, "tell the administrator"),
    "not diagnosed yet": (of_unit(reservations=None), Use.RESERVED, "ask again in a few seconds"),
    "diagnosis failed": (
        replace(of_unit(reservations=None), not_diagnosed="it broke"), Use.RESERVED, "tell the administrator",
    ),
    "a cause below the tolerance": (said_with(Doubt.CAUSE, share=0.7), Use.RESERVED, "repeat the session"),
    "a cause as large as the tolerance": (said_with(Doubt.CAUSE, share=1.0), Use.NO, "repeat the session"),
    "something unexplained, as large": (said_with(Doubt.UNEXPLAINED, share=1.2), Use.NO, "repeat the session"),
    "a wrong file": (said_with(Doubt.RECORD), Use.NO, "repeat the session"),
    "unfit under another model": (
        said_with(Doubt.OTHER_MODEL, verdict=Verdict.CONDITIONAL_FAIL), Use.NO, "repeat the session",
    ),
    "undecided under another model": (
        said_with(Doubt.OTHER_MODEL, verdict=Verdict.UNDECIDABLE), Use.RESERVED, "repeat the session",
    ),
    "measured at another temperature": (said_with(Doubt.TEMPERATURE, share=1.5), Use.RESERVED, "repeat the session"),
    "a flag out of tolerance": (flagged(Matter.TOLERANCE), Use.NO, "have an engineer resolve flag 3"),
    "another flag": (flagged(Matter.DRIFT), Use.RESERVED, "have an engineer resolve flag 3"),
    "the flag that it is overdue": (flagged(Matter.OVERDUE), Use.YES, ""),
    "a later session questioned": (
        replace(PLAIN, questioned_at=NOON + DAY), Use.RESERVED, "accept, correct or withdraw the session that waits",
    ),
    "the stand's certificate had expired": (
        replace(PLAIN, expired=CERTIFICATE), Use.RESERVED, "have the stand calibrated",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_a_case_has_its_answer_and_its_action(name: str) -> None:
    facts, use, action = CASES[name]
    found = usable(facts, NOON)
    assert (found.answer, found.action) == (use, action)
    assert found.usable is (use in (Use.YES, Use.RESERVED))
    assert bool(found.reasons) is not found.usable
    assert (found.reasons or (found.why,))[0] == found.why


def test_a_date_counts_only_where_nothing_must_be_done_first() -> None:
    shown = {name: usable(facts, NOON).due is not None for name, (facts, *_) in CASES.items()}
    assert [name for name in shown if shown[name] and not usable(CASES[name][0], NOON).usable] == ["overdue"]


def test_what_is_known_for_certain_comes_before_what_is_still_worked_out() -> None:
    both = usable(replace(of_unit(verdict=Verdict.FAIL), is_waiting=True), NOON)
    assert both.why == both.reasons[0] != words.VERDICT_PENDING
    assert len(both.reasons) == 2
