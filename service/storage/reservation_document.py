"""Reservations as the store keeps them beside a diagnosis."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from service.records.decision import Verdict
from service.records.reservation import Doubt, Reservation, Reservations


def reservations_to_list(reservations: Sequence[Reservation]) -> list[dict[str, Any]] | None:
    """Every reservation, or None where there are none."""
    return [asdict(reservation) for reservation in reservations] or None


def reservations_from_list(diagnosed: str | None, entries: list[Any] | None) -> Reservations:
    """What `reservations_to_list` wrote; None where no diagnosis is stored yet."""
    return None if diagnosed is None else tuple(_reservation(entry) for entry in entries or ())


def _reservation(entry: dict[str, Any]) -> Reservation:
    verdict = entry["verdict"]
    plain = {name: value for name, value in entry.items() if name not in ("kind", "sensors", "verdict")}
    return Reservation(
        kind=Doubt(entry["kind"]),
        sensors=tuple(entry["sensors"]),
        verdict=None if verdict is None else Verdict(verdict),
        **plain,
    )
