"""The fleet page's context."""

from dataclasses import replace

from service.fleet.condition import FleetCondition, ToleranceUsed
from service.pages.fleet.pages import fleet_page, margin_of
from service.pages.fleet.view import FleetView
from service.sessions.decision import Verdict
from tests.service.pages.records import unit_summary, uses_of

CONDITION = FleetCondition(units=120, verdicts={v: 20 + 2 * v.severity for v in Verdict}, simulated=0)


def test_tiles_count_every_condition_worst_first() -> None:
    tiles = fleet_page(CONDITION, (), {}, FleetView()).tiles
    assert [(t.condition.word, t.count) for t in tiles] == [
        ("Unfit", 28), ("Probably unfit", 26), ("Undecided", 24), ("Probably fit", 22), ("Fit", 20),
    ]  # fmt: skip


def test_units_with_a_reference_only_are_not_counted_as_undecided() -> None:
    page = fleet_page(replace(CONDITION, references=7), [], {}, FleetView())
    counts = {tile.condition.word: tile.count for tile in page.tiles}
    assert (counts["Undecided"], counts["Reference set"], sum(counts.values())) == (17, 7, CONDITION.units)


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
    view = FleetView(q="BA 1", condition="fail", page=3)
    assert view.url() == "/?q=BA+1&condition=fail&page=3"
    assert view.url(condition="pass", page=1) == "/?q=BA+1&condition=pass"
    assert FleetView().url() == "/"


def test_chosen_tile_leads_back_to_all() -> None:
    tiles = {t.condition.key: t for t in fleet_page(CONDITION, (), {}, FleetView(condition="fail")).tiles}
    assert tiles["fail"].chosen
    assert tiles["fail"].url == "/"


def test_margin_in_words_and_as_a_bar() -> None:
    found = [margin_of(ToleranceUsed(d, u)) for d, u in ((0.5, 0.1), (0.83, 0.71), (1.07, 0.17), (4.0, 0.1))]
    assert [" ".join(m.words.split()) for m in found] == ["50 ± 10 %", "83 ± 71 %", "107 ± 17 %", "400 ± 10 %"]
    assert [(round(m.used), round(m.reach)) for m in found] == [(50, 60), (83, 150), (107, 124), (150, 150)]


def test_margin_of_an_undecided_unit_is_not_claimed() -> None:
    unit = unit_summary(verdict=Verdict.UNDECIDABLE)
    rows = fleet_page(CONDITION, [unit], uses_of(unit), FleetView()).rows
    assert rows[0].margin is None
    assert rows[0].worst == "A3 bias"
