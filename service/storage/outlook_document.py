"""An outlook as JSON and back; times are ISO 8601."""

from dataclasses import asdict
from datetime import datetime
from typing import Any

from service.outlook import FanPoint, ParameterTrend, RiskPoint, UnitOutlook

TIMES = ("due", "reach_50", "reach_90")


def outlook_to_dict(outlook: UnitOutlook) -> dict[str, Any]:
    """What `outlook_from_dict` reads."""
    written: dict[str, Any] = _written(asdict(outlook))
    return written


def _written(part: Any) -> Any:
    if isinstance(part, dict):
        return {key: _written(value) for key, value in part.items()}
    if isinstance(part, list | tuple):
        return [_written(value) for value in part]
    return part.isoformat() if isinstance(part, datetime) else part


def outlook_from_dict(document: dict[str, Any]) -> UnitOutlook:
    """The outlook that was written."""
    own = {**document, **{name: _time(document[name]) for name in TIMES}}
    own["trends"] = tuple(_trend(entry) for entry in document["trends"])
    own["risk"] = tuple(RiskPoint(datetime.fromisoformat(p["at"]), p["risk"]) for p in document["risk"])
    own["together"] = tuple(document["together"])
    return UnitOutlook(**own)


def _trend(entry: dict[str, Any]) -> ParameterTrend:
    times = {name: _time(entry[name]) for name in ("reach_50", "reach_90", "since")}
    steps = tuple(datetime.fromisoformat(at) for at in entry["step_dates"])
    fan = tuple(FanPoint(**{**point, "at": datetime.fromisoformat(point["at"])}) for point in entry["fan"])
    return ParameterTrend(**{**entry, **times, "step_dates": steps, "fan": fan})


def _time(text: str | None) -> datetime | None:
    return None if text is None else datetime.fromisoformat(text)
