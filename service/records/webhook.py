"""The addresses that are told of notices, and what is under way to them."""

from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum

from service.records.answer import Hidden, answer
from service.records.flag import Matter, Notice


@answer
@dataclass(frozen=True)
class Webhook:
    """An address that is told."""

    id: int
    """Number of the webhook."""
    url: str
    """Where messages are sent."""
    secret: Hidden[str] = field(repr=False)
    who: str
    """Who registered it."""
    created_at: datetime
    """When, UTC."""


class DeliveryState(StrEnum):
    """How far a delivery has come."""

    WAITING = "waiting"
    DELIVERED = "delivered"
    FAILED = "failed"
    """Given up."""


@answer
@dataclass(frozen=True)
class Delivery:
    """One message to one address."""

    id: int
    """Number of the delivery."""
    notice: Notice
    """What the address is told."""
    state: DeliveryState
    """`waiting`, `delivered`, or `failed`: given up."""
    attempts: int
    """How often it was sent."""
    next_at: datetime
    """When it is sent next, UTC; of one that has ended, when it ended."""
    outcome: str
    """What the latest attempt came to."""


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
