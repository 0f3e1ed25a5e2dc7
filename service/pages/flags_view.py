"""Which flags a visitor asked to see: it stands in the address."""

from dataclasses import dataclass

from pydantic import BaseModel

from service.pages.list_view import Asked, address_of
from service.records.flag import FlagState, Matter
from service.storage.queries.flags import FlagQuery

STATES = {FlagState.RAISED.value: "Not acknowledged", FlagState.ACKNOWLEDGED.value: "Acknowledged"}
"""Choices, in words."""


class FlagsAsked(BaseModel):
    """An address as it came."""

    q: Asked = ""
    matter: Asked = ""
    state: Asked = ""


@dataclass(frozen=True)
class FlagsView:
    """Empty where nothing is asked: all that are open."""

    text: str = ""
    matter: str = ""
    state: str = ""

    @classmethod
    def of(cls, asked: FlagsAsked) -> "FlagsView":
        """The view of an address; what it asks that nobody knows is left out."""
        return cls(
            text=asked.q.strip(),
            matter=asked.matter if asked.matter in set(Matter) else "",
            state=asked.state if asked.state in STATES else "",
        )

    def url(self, path: str) -> str:
        """The address of this view."""
        asked = {"q": self.text, "matter": self.matter, "state": self.state}
        return address_of(path, asked)

    def query(self, limit: int) -> FlagQuery:
        """What the store is asked."""
        return FlagQuery(
            state=FlagState(self.state) if self.state else None,
            limit=limit,
            matter=Matter(self.matter) if self.matter else None,
            text=self.text or None,
            unresolved=True,
        )
