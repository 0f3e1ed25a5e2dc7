"""The addresses that are told of notices, and what is under way to them."""

from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum

from service.records.flag import Matter, Notice


@dataclass(frozen=True)
class Webhook:
    """An address that is told of notices."""

    id: int
    url: str
    secret: str = field(repr=False)
    who: str
    """Who registered it."""
    created_at: datetime


class DeliveryState(StrEnum):
    """How far a delivery has come."""

    WAITING = "waiting"
    DELIVERED = "delivered"
    FAILED = "failed"
    """Given up."""


@dataclass(frozen=True)
class Delivery:
    """One notice on its way to one address."""

    id: int
    notice: Notice
    state: DeliveryState
    attempts: int
    next_at: datetime
    """When the next attempt is made; of one that has ended, when it ended."""
    outcome: str
    """Of the latest attempt."""


@dataclass(frozen=True)
class Outgoing:
    """A delivery that is to be attempted now."""

    delivery: int
    attempt: int
    """Counted from 1."""
    webhook: Webhook
    notice: Notice
    matter: Matter | None
    """Of the notice's flag; None where it is about no flag."""
    place: str
