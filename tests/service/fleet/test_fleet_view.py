"""The view that a visitor of the fleet page asked for, and its address."""

import httpx
import pytest

from service.fleet.records import Order
from service.pages.fleet.view import FleetView
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import session_bytes
from tests.service.pages.records import NOON


def test_a_view_comes_back_from_its_own_address() -> None:
    view = FleetView(q="BA", use="no", due="overdue", type="RA-6", stand="S 1", sort="-due")
    assert view.url() == "/?q=BA&use=no&due=overdue&type=RA-6&stand=S+1&sort=-due"
    assert (view.order, view.backwards) == (Order.DUE, True)


def test_what_nobody_knows_is_left_out() -> None:
    assert FleetView(use="odd", due="soon", sort="colour").url() == "/"


def test_a_heading_orders_the_list_and_then_turns_it_round() -> None:
    view = FleetView(stand="S", sort="due")
    assert view.sorted_by("unit") == "/?stand=S&sort=unit"
    assert view.sorted_by("due") == "/?stand=S&sort=-due"


@pytest.mark.parametrize(("due", "days"), [("overdue", 0), ("30", 30), ("90", 90)])
def test_a_choice_of_dates_is_counted_from_now(due: str, days: int) -> None:
    until = FleetView(due=due).query(NOON).due_before
    assert until is not None
    assert (until - NOON).days == days


def test_the_list_is_narrowed_and_ordered_by_its_address(client: httpx.Client) -> None:
    for unit in ("BA-1", "BA-2"):
        client.post("/api/v1/sessions", content=session_bytes(unit=unit))
    page = client.get("/?sort=-unit").text
    assert page.index("/units/BA-2") < page.index("/units/BA-1")
    assert 'aria-sort="descending"' in page
    assert "No unit matches" in client.get("/?stand=elsewhere").text
    units = client.get("/api/v1/units", params={"order": "unit", "backwards": True}).json()["units"]
    assert [unit["serial"] for unit in units] == ["BA-2", "BA-1"]
