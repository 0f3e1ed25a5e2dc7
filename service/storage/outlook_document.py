"""An outlook as JSON and back, in two parts: what the whole fleet is read by, and what only a unit's page draws."""

from typing import Any

from service.records.outlook import UnitOutlook
from service.storage.documents import STORED


def outlook_to_dicts(outlook: UnitOutlook) -> tuple[dict[str, Any], dict[str, Any]]:
    """What `outlook_from_dicts` reads; times are ISO 8601."""
    written: dict[str, Any] = STORED.written(outlook)
    fans = [trend.pop("fan") for trend in written["trends"]]
    return written, {"risk": written.pop("risk"), "fans": fans}


def outlook_from_dicts(document: dict[str, Any], drawn: dict[str, Any] | None = None) -> UnitOutlook:
    """The outlook that was written; without its fans and its risk where what is drawn was left in the store."""
    if drawn is None:
        return STORED.read(UnitOutlook, document)
    trends = [trend | {"fan": fan} for trend, fan in zip(document["trends"], drawn["fans"], strict=True)]
    return STORED.read(UnitOutlook, document | {"trends": trends, "risk": drawn["risk"]})
