"""Every parameter of every sensor as a share of its tolerance, at a glance."""

from collections.abc import Sequence
from dataclasses import dataclass

from service.fleet.condition import ToleranceUsed
from service.outlook.charts import judged_as, natural
from service.outlook.rules.histories import changes_of
from service.pages.fleet.pages import Margin, margin_of
from service.pages.unit.parameters import ParameterHead
from service.sessions.records import HistoryPoint
from service.sessions.words.conditions import Condition

MOST = 12
"""Sensors that are shown at once; of more the furthest come first."""


@dataclass(frozen=True)
class Share:
    """One parameter of one sensor."""

    condition: Condition
    margin: Margin
    per_cent: str
    anchor: str
    """The parameter's name in addresses."""


@dataclass(frozen=True)
class ShareTable:
    """Sensors down, parameters across; a cell is None where nothing was judged."""

    heads: tuple[str, ...]
    rows: tuple[tuple[str, tuple[Share | None, ...]], ...]

    @property
    def most(self) -> int:
        """Number of rows that are shown at once."""
        return MOST


def share_table(latest: Sequence[HistoryPoint], heads: Sequence[ParameterHead]) -> ShareTable | None:
    """The latest point of every parameter; None where none was judged."""
    shares = {(point.sensor, point.parameter): share for point in latest if (share := _share(point)) is not None}
    if not shares:
        return None
    names = {head.parameter: head.heading.partition(",")[0] for head in heads}
    shown = [name for name in names if any(parameter == name for _, parameter in shares)]
    sensors = sorted({sensor for sensor, _ in shares}, key=natural)
    if len(sensors) > MOST:
        sensors.sort(key=lambda sensor: -max(shares[key].margin.reach for key in shares if key[0] == sensor))
    rows = tuple((sensor, tuple(shares.get((sensor, name)) for name in shown)) for sensor in sensors)
    return ShareTable(tuple(names[name] for name in shown), rows)


def _share(point: HistoryPoint) -> Share | None:
    (change,) = changes_of([point], ())
    if point.is_reference or not change.tolerance or change.value is None or change.expanded is None:
        return None
    used = ToleranceUsed(abs(change.value) / change.tolerance, change.expanded / change.tolerance)
    anchor = ParameterHead(point.parameter, point.kind, "", judged_as(point)).anchor
    return Share(judged_as(point), margin_of(used), f"{100 * used.deviation:.0f}", anchor)
