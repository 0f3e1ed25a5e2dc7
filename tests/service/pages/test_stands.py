"""The pages of stands: may each be used today, what its units show of it, and its certificate."""

from dataclasses import replace
from datetime import date

import httpx

from service.pages.stand.pages import StandLine, StandReport, stand_page, stands_page
from service.stands.records import StandCertificate, StandCondition, StandEvidence, StandSeating, StandUse
from tests.service.pages.records import NOON
from tests.service.papers.laboratory import STAND

ARCSEC = 4.84813681e-6
CERTIFICATE = StandCertificate("S2", "D-K-117", "PTB", date(2025, 12, 10), date(2026, 12, 10))
STEADY = StandEvidence("accelerometer", "scales", NOON, None, (1e-6,), 1e-6, 1e-6, 1.0, 0.8, 5, 1, has_shifted=False)
SHIFTED = StandEvidence(
    "accelerometer", "axes", NOON, None, (0.0, 0.0, 12 * ARCSEC), 12 * ARCSEC, 0.2 * ARCSEC, 90.0, 1e-6, 5, 4,
    has_shifted=True,
)  # fmt: skip
CONDITION = StandCondition(
    stand="S2",
    sessions=9,
    has_shifted=True,
    reason="It turns every block.",
    evidence=(SHIFTED, STEADY),
    shifts=(SHIFTED,),
    seating=(StandSeating("accelerometer", "axes", 0.1 * ARCSEC),),
    unreadable=(),
)
LINE = StandLine(StandUse("S2", 9, 5, NOON), CONDITION, (CERTIFICATE,), 0, is_pending=False)


def test_what_needs_a_hand_comes_first() -> None:
    ready = StandLine(StandUse("S1", 9, 5, NOON), None, (CERTIFICATE,), 0, is_pending=False)
    page = stands_page([ready, LINE], NOON)
    assert [(row.use.stand, row.word.word) for row in page.rows] == [("S2", "Check before use"), ("S1", "Ready to use")]


def test_a_shift_is_told_with_its_size_and_units_and_what_is_steady_too() -> None:
    page = stand_page(StandReport(LINE, (), (), {}, (), ()), NOON)
    shift, steady = page.shifts
    assert (shift.what, shift.when, shift.units, shift.word) == (
        "Turn of every block", "since 1 Mar 2026", "4 of 5", "shifted",
    )  # fmt: skip
    assert shift.size == "12.00\u00a0±\u00a00.40\u202farcsec"
    assert (steady.what, steady.tone) == ("Change of every scale factor", "pass")
    assert page.seating == (("Turn of every block", "±0.20 arcsec per axis"),)


def test_a_shift_that_was_taken_back_says_until_when() -> None:
    back = replace(CONDITION, has_shifted=False, shifts=(replace(SHIFTED, until=NOON),))
    page = stand_page(StandReport(replace(LINE, condition=back), (), (), {}, (), ()), NOON)
    assert (page.shifts[0].when, page.shifts[0].word) == ("1 Mar 2026 to before 1 Mar 2026", "shift has ended")
    assert page.word.word == "Ready to use"


def test_a_certificate_is_recorded_on_the_stand_s_page(flagged: httpx.Client) -> None:
    assert "none recorded" in flagged.get("/stands").text
    assert "No certificate recorded" in flagged.get("/stands/ODG-1").text
    origin = str(flagged.base_url).rstrip("/")
    answer = flagged.post("/stands/ODG-1/certificates", data=STAND, headers={"Origin": origin})
    assert (answer.status_code, answer.headers["location"]) == (303, "/stands/ODG-1#certificates")
    page = flagged.get("/stands/ODG-1").text
    assert "D-K-117" in page
    assert "10 Dec 2026" in page


def test_a_stand_s_page_leads_to_its_units_and_sessions(flagged: httpx.Client) -> None:
    page = flagged.get("/stands/ODG-1").text
    assert '<a href="/units/BA-017">BA-017</a>' in page
    assert page.count('class="text nowrap" href="/sessions/') == 2
    session = page.partition('class="text nowrap" href="')[2].partition('"')[0]
    assert '<a href="/stands/ODG-1">ODG-1</a>' in flagged.get(session).text
    assert flagged.get("/stands/none").status_code == 404
