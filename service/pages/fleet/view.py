"""What a visitor of the fleet page asked to see."""

from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Annotated

from pydantic import BaseModel, Field

from service.fleet.records import FleetQuery, Order
from service.sessions.decision import Verdict
from service.sessions.words.conditions import RESERVED
from service.web.list_view import Asked, ListView, known_order

PAGE_SIZE = 50
"""Units on a page: two screens."""
DUE = {"overdue": "Overdue", "30": "Due within 30 days", "90": "Due within 90 days", "now": "Do not use, or repeat"}
"""Choices of the next calibration's date, in words."""
ORDERS: dict[str, str] = {
    Order.CONDITION.value: "by condition, least margin to tolerance first",
    Order.DUE.value: "by next calibration",
    Order.SERIAL.value: "by serial number",
    Order.TYPE.value: "by type",
    Order.LAST.value: "by last session",
}
NAMES = {
    "text": "q", "condition": "condition", "due": "due", "unit_type": "type", "stand": "stand", "lot": "lot",
    "flagged": "flagged", "sort": "sort", "page": "page", "after": "after", "before": "before",
}  # fmt: skip
"""Fields of a view as they are called in an address."""
PLAIN = {"page": 1, "sort": Order.CONDITION.value}
"""What an address need not say."""
FIRST: dict[str, str | int] = {"page": 1, "after": "", "before": ""}
"""What leads to the first page."""


class FleetAsked(BaseModel):
    """An address as it came."""

    q: Asked = ""
    condition: Asked = ""
    due: Asked = ""
    type: Asked = ""
    stand: Asked = ""
    lot: Asked = ""
    flagged: Asked = ""
    sort: Asked = ""
    page: Annotated[int, Field(ge=1, le=1_000_000)] = 1
    after: Asked = ""
    before: Asked = ""


@dataclass(frozen=True)
class FleetView(ListView):
    """Units."""

    PATH = "/"
    NAMES = NAMES
    PLAIN = PLAIN
    FIRST = FIRST
    ORDERS = ORDERS
    sort: str = Order.CONDITION.value
    text: str = ""
    condition: str = ""
    due: str = ""
    unit_type: str = ""
    stand: str = ""
    lot: str = ""
    flagged: str = ""
    page: int = 1
    """Its number, for people; what is read begins after a unit."""
    after: str = ""
    """The unit that this page follows."""
    before: str = ""
    """The unit that it comes before."""

    @classmethod
    def of(cls, asked: FleetAsked) -> "FleetView":
        """The view of an address; what it asks that nobody knows is left out."""
        return cls(
            sort=known_order(asked.sort, ORDERS, Order.CONDITION.value),
            text=asked.q.strip(),
            condition=asked.condition if asked.condition in {*Verdict, RESERVED.key} else "",
            due=asked.due if asked.due in DUE else "",
            unit_type=asked.type,
            stand=asked.stand,
            lot=asked.lot,
            flagged=asked.flagged,
            page=asked.page,
            after=asked.after,
            before="" if asked.after else asked.before,
        )

    def query(self, now: datetime) -> FleetQuery:
        """What the store is asked: one unit more than fit on the page, which says whether there is a next one."""
        until = {"overdue": now, "30": now + timedelta(days=30), "90": now + timedelta(days=90)}
        return FleetQuery(
            verdict=Verdict(self.condition) if self.condition in set(Verdict) else None,
            text=self.text or None,
            offset=0 if self.after or self.before else (self.page - 1) * PAGE_SIZE,
            after=self.after or None,
            before=self.before or None,
            limit=PAGE_SIZE + 1,
            reserved=True if self.condition == RESERVED.key else None,
            due_before=until.get(self.due),
            undated=self.due == "now",
            unit_type=self.unit_type or None,
            stand=self.stand or None,
            lot=self.lot or None,
            flagged=bool(self.flagged),
            order=Order(self.order),
            backwards=self.backwards,
        )
