"""Filter and order of the due list, in its address."""

import re
from datetime import UTC, datetime
from typing import Annotated, ClassVar

from pydantic import AfterValidator

from service.fleet.records import FleetQuery, Order
from service.outlook.changes import END_OF_TIME
from service.web.fields import Sought
from service.web.list_view import ListView

OVERDUE, UNKNOWN = "overdue", "unknown"
MONTH = re.compile(r"(19|20|21)\d\d-(0[1-9]|1[0-2])")


def _known(asked: str) -> str:
    return asked if asked in (OVERDUE, UNKNOWN) or MONTH.fullmatch(asked) else ""


def month_after(start: datetime) -> datetime:
    """The first moment of the next month."""
    return start.replace(year=start.year + start.month // 12, month=start.month % 12 + 1)


def month_begin(at: datetime) -> datetime:
    """The first moment of a month, UTC."""
    return datetime(at.year, at.month, 1, tzinfo=UTC)


class DueView(ListView):
    """Units by the date of their next calibration."""

    PATH = "/due"
    ORDERS: ClassVar = {
        Order.DUE.value: "by next calibration",
        Order.SERIAL.value: "by serial number",
        Order.TYPE.value: "by type",
    }
    when: Annotated[Sought, AfterValidator(_known)] = ""
    """``overdue``, ``unknown``, or a month such as ``2026-12``; all dates where nothing is asked."""
    location: Sought = ""
    custodian: Sought = ""

    def query(self, now: datetime) -> FleetQuery:
        """The query to the store: one unit more than fit on the page."""
        since, before = self._between(now)
        return FleetQuery(
            due_since=since,
            due_before=None if self.when == UNKNOWN else before,
            undated=self.when == UNKNOWN,
            location=self.location or None,
            custodian=self.custodian or None,
            order=Order(self.order),
            backwards=self.backwards,
            after=self.after or None,
            before=self.before or None,
            limit=self.PAGE_SIZE + 1,
        )

    def _between(self, now: datetime) -> tuple[datetime | None, datetime]:
        if self.when == OVERDUE:
            return None, now
        if self.when in ("", UNKNOWN):
            return None, END_OF_TIME
        start = datetime.strptime(self.when, "%Y-%m").replace(tzinfo=UTC)
        return max(start, now), max(month_after(start), now)
