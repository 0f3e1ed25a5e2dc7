"""History points as changes from the reference that held at the time: relative for scale, else SI."""

from collections.abc import Sequence
from dataclasses import dataclass

from service.records import HistoryPoint, Service


@dataclass(frozen=True)
class Change:
    """One point of a history and what its change is measured from."""

    point: HistoryPoint
    epoch: int
    """Counts the service events before the session: a line never runs across one."""
    origin: float

    @property
    def value(self) -> float | None:
        """The change; None where the session does not observe the parameter."""
        return self._from_origin(self.point.value)

    @property
    def lower(self) -> float | None:
        """Lower end of the band; an angle between axes is never below zero."""
        low = self.point.lower
        return self._from_origin(low if low is None or not self.is_angle else max(0.0, low))

    @property
    def upper(self) -> float | None:
        """Upper end of the band."""
        return self._from_origin(self.point.upper)

    @property
    def expanded(self) -> float | None:
        """U of the value."""
        if self.point.upper is None or self.point.value is None:
            return None
        return (self.point.upper - self.point.value) / self._one

    @property
    def tolerance(self) -> float | None:
        """Largest allowed change; None where it is not judged."""
        if self.point.tolerance is None or self.point.reference is None:
            return None
        return self.point.tolerance / self._one

    @property
    def is_angle(self) -> bool:
        """Whether the value is the angle from the reference axis."""
        return self.point.parameter == "axis"

    @property
    def largest(self) -> float:
        """What a chart of this point must have room for."""
        return max(abs(self.value or 0.0), self.tolerance or 0.0)

    @property
    def _one(self) -> float:
        return (abs(self.origin) or 1.0) if self.point.parameter == "scale" else 1.0

    def _from_origin(self, value: float | None) -> float | None:
        return None if value is None else (value - self.origin) / self._one


def changes_of(points: Sequence[HistoryPoint], services: Sequence[Service]) -> tuple[Change, ...]:
    """The changes of one parameter of one sensor, oldest first; without a reference, from its epoch's first value."""
    epochs = [sum(service.at <= point.at for service in services) for point in points]
    starts: dict[int, float] = {}
    for epoch, point in zip(epochs, points, strict=True):
        start = point.value if point.reference is None else point.reference
        if start is not None:
            starts.setdefault(epoch, start)
    return tuple(
        Change(point, epoch, starts.get(epoch, 0.0) if point.reference is None else point.reference)
        for epoch, point in zip(epochs, points, strict=True)
    )
