"""Reservations as the store keeps them beside a diagnosis."""

from collections.abc import Sequence
from typing import Any

from estimator.json_object import Json
from service.sessions.doubt import Reservation, Reservations
from service.storage.json_text import STORED


def reservations_to_list(reservations: Sequence[Reservation]) -> list[Json] | None:
    """Every reservation, or None where there are none."""
    return STORED.written(list(reservations)) or None


def reservations_from_list(diagnosed: str | None, entries: list[Any] | None) -> Reservations:
    """What `reservations_to_list` wrote; None where no diagnosis is stored yet."""
    return None if diagnosed is None else tuple(STORED.read(Reservation, entry) for entry in entries or ())
