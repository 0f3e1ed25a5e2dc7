"""The fleet page's context."""

from service.fleet.condition import FleetCondition, ToleranceUsed
from service.fleet.use import Use
from service.pages.fleet.pages import fleet_page, margin_of
from service.pages.fleet.view import FleetView
from service.sessions.decision import Verdict
from tests.service.pages.records import unit_summary, uses_of

CONDITION = FleetCondition(units=120, verdicts={v: 20 + 2 * v.severity for v in Verdict}, simulated=0)


USED = {Use.YES: 3, Use.RESERVED: 2, Use.NO: 9, Use.PENDING: 0}


def test_units_are_counted_by_use_those_that_must_not_be_used_first() -> None:
    counts = fleet_page(CONDITION, (), {}, FleetView(), used=USED).counts
    assert [(one.count, one.words) for one in counts] == [
        (9, "must not be used"), (2, "with reservation"), (3, "may be used"),
    ]  # fmt: skip


def test_units_are_numbered_through_the_pages() -> None:
    units = [unit_summary(f"U{i}") for i in range(FleetView.PAGE_SIZE + 1)]
    page = fleet_page(CONDITION, units, uses_of(*units), FleetView(page=2))
    assert (page.first, page.last) == (FleetView.PAGE_SIZE + 1, 2 * FleetView.PAGE_SIZE)
    assert page.shown.later


def test_a_page_that_is_read_backwards_holds_the_units_next_to_where_it_was_left() -> None:
    units = [unit_summary(f"U{i}") for i in range(200)]
    forwards, backwards = (
        fleet_page(CONDITION, units, uses_of(*units), view)
        for view in (FleetView(page=2, after="X"), FleetView(page=2, before="X"))
    )
    size = len(forwards.rows)
    assert 0 < size < len(units)
    assert [row.serial for row in forwards.rows] == [unit.serial for unit in units[:size]]
    assert [row.serial for row in backwards.rows] == [unit.serial for unit in units[-size:]]


def test_changing_the_filter_goes_back_to_the_first_page() -> None:
    view = FleetView(q="BA 1", use="no", page=3)
    assert view.url() == "/?q=BA+1&use=no&page=3"
    assert view.url(use="yes", page=1) == "/?q=BA+1&use=yes"
    assert FleetView().url() == "/"


def test_a_chosen_count_leads_back_to_all() -> None:
    counts = {one.use: one for one in fleet_page(CONDITION, (), {}, FleetView(use="no"), used=USED).counts}
    assert (counts[Use.NO].chosen, counts[Use.NO].url) == (True, "/")
    assert counts[Use.YES].url == "/?use=yes"


def test_margin_in_words_and_as_a_bar() -> None:
    found = [margin_of(ToleranceUsed(d, u)) for d, u in ((0.5, 0.1), (0.83, 0.71), (1.07, 0.17), (4.0, 0.1))]
    assert [" ".join(m.words.split()) for m in found] == ["50 ± 10 %", "83 ± 71 %", "107 ± 17 %", "400 ± 10 %"]
    assert [(round(m.used), round(m.reach)) for m in found] == [(50, 60), (83, 150), (107, 124), (150, 150)]


def test_margin_of_an_undecided_unit_is_not_claimed() -> None:
    unit = unit_summary(verdict=Verdict.UNDECIDABLE)
    rows = fleet_page(CONDITION, [unit], uses_of(unit), FleetView()).rows
    assert rows[0].margin is None
    assert rows[0].worst == "A3 bias"
