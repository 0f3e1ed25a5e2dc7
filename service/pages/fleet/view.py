"""Filter and order of the fleet page, in its address."""

from datetime import datetime, timedelta
from typing import Annotated, ClassVar

from pydantic import Field

from service.fleet.records import FleetQuery, Order, UseAt
from service.fleet.use import WORDS, Use
from service.web.fields import Sought
from service.web.list_view import ListView, Words, one_of

DUE = {"overdue": "Overdue", "30": "Due within 30 days", "90": "Due within 90 days"}
"""Choices of the next calibration's date, in words."""
RETIRED = {"only": "Retired units only", "too": "Retired units too"}
"""Choices for retired units, in words; without a choice they are left out."""
USES = {use.value: word for use, word in WORDS.items()}
"""Choices of permitted use, in words."""
RETIRED_OF = {"": False, "only": True, "too": None}


class FleetView(ListView):
    """Units."""

    PATH = "/"
    ORDERS: ClassVar = {
        Order.USE.value: "by use, least margin to tolerance first",
        Order.DUE.value: "by next calibration",
        Order.SERIAL.value: "by serial number",
        Order.TYPE.value: "by type",
        Order.LAST.value: "by last session",
    }
    q: Words = ""
    use: Annotated[Sought, one_of(set(Use))] = ""
    due: Annotated[Sought, one_of(DUE)] = ""
    type: Sought = ""
    stand: Sought = ""
    lot: Sought = ""
    location: Sought = ""
    custodian: Sought = ""
    retired: Annotated[Sought, one_of(RETIRED)] = ""
    page: Annotated[int, Field(ge=1, le=1_000_000)] = 1
    """Number of the page, for people; reading begins after a unit."""

    def query(self, now: datetime) -> FleetQuery:
        """The query to the store: one unit more than fit on the page, which tells whether there is a next one."""
        until = {"overdue": now, "30": now + timedelta(days=30), "90": now + timedelta(days=90)}
        return FleetQuery(
            use=UseAt(Use(self.use), now) if self.use else None,
            text=self.q or None,
            due_before=until.get(self.due),
            unit_type=self.type or None,
            stand=self.stand or None,
            lot=self.lot or None,
            location=self.location or None,
            custodian=self.custodian or None,
            retired=RETIRED_OF[self.retired],
            order=Order(self.order),
            backwards=self.backwards,
            after=self.after or None,
            before=self.before or None,
            offset=0 if self.after or self.before else (self.page - 1) * self.PAGE_SIZE,
            limit=self.PAGE_SIZE + 1,
        )

    def earlier(self, entry: str, *, others: bool) -> str:
        """The address of the previous page. The first page is read from its beginning, so that no new entry is missed
        before it.
        """
        if self.page <= 2 or not entry:
            return "" if self.page == 1 else self.first()
        return self.url(page=self.page - 1, before=entry, after="")

    def later(self, entry: str, *, others: bool) -> str:
        """The address of the next page, with its number."""
        return self.url(page=self.page + 1, after=entry, before="") if entry and (others or self.before) else ""
