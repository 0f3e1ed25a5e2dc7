"""History points as changes from the reference that held at the time: relative for scale, else SI."""

from collections.abc import Sequence
from dataclasses import dataclass

from service.sessions.records import HistoryPoint
from service.units.records import Service


@dataclass(frozen=True)
class Change:
    """One point of a history and what its change is measured from."""

    point: HistoryPoint
    epoch: int
    """Counts the service events before the session: a line never runs across one."""
    origin: float

    @property
    def value(self) -> float | None:
        """The change as it was judged; None where the session does not observe the parameter."""
        if self.point.deviation is not None:
            return self.point.deviation
        return None if self.point.value is None else (self.point.value - self.origin) / self._one

    @property
    def lower(self) -> float | None:
        """Lower end of the band; an angle between axes is never below zero."""
        if self.value is None or self.expanded is None:
            return None
        return max(0.0, self.value - self.expanded) if self.is_angle else self.value - self.expanded

    @property
    def upper(self) -> float | None:
        """Upper end of the band."""
        return None if self.value is None or self.expanded is None else self.value + self.expanded

    @property
    def expanded(self) -> float | None:
        """U of the change; of a reference, of the value itself."""
        if self.point.expanded is not None:
            return self.point.expanded
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
