"""What somebody who follows an upload does at its steps: a job ends in the transaction that stores, or that refuses."""

from collections.abc import Callable
from dataclasses import dataclass

from service.records.session import Receipt
from service.storage.store import Store


def _nothing(*_: object) -> None:
    """Nobody follows it."""


@dataclass(frozen=True)
class Course:
    """Of one upload. Whatever raises here stops it, and nothing of it is stored."""

    keeping: Callable[[], None] = _nothing
    """Its readings are good, and its bytes are kept next."""
    stored: Callable[[Store, Receipt], None] = _nothing
    """Within the transaction that stores."""
    refused: Callable[[Store, int], None] = _nothing
    """Within the transaction that records the refusal, with its number."""


UNFOLLOWED = Course()
"""Whoever sent it waits for the answer."""
