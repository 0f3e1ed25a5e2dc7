"""An outlook as JSON and back, in two parts: what the whole fleet is read by, and what only a unit's page draws."""

from dataclasses import is_dataclass
from datetime import datetime
from typing import Any

from service.records.outlook import (
    Action,
    DueBasis,
    DueRule,
    FanPoint,
    FoundChange,
    ParameterTrend,
    RiskPoint,
    TemperatureCoefficient,
    UnitOutlook,
)

TIMES = ("due", "reach_50", "reach_90")
"""Fields of an outlook that are times."""


def outlook_to_dicts(outlook: UnitOutlook) -> tuple[dict[str, Any], dict[str, Any]]:
    """What `outlook_from_dicts` reads; times are ISO 8601."""
    written: dict[str, Any] = _written(outlook)
    fans = [trend.pop("fan") for trend in written["trends"]]
    return written, {"risk": written.pop("risk"), "fans": fans}


def _written(part: Any) -> Any:
    if is_dataclass(part):
        return {key: _written(value) for key, value in vars(part).items()}
    if isinstance(part, list | tuple):
        return [_written(value) for value in part]
    return part.isoformat() if isinstance(part, datetime) else part


def outlook_from_dicts(document: dict[str, Any], drawn: dict[str, Any] | None = None) -> UnitOutlook:
    """The outlook that was written; without its fans and its risk where what is drawn was left in the store."""
    fans = [[]] * len(document["trends"]) if drawn is None else drawn["fans"]
    own = {**document, **{name: _time(document[name]) for name in TIMES}}
    own["trends"] = tuple(_trend(entry, fan) for entry, fan in zip(document["trends"], fans, strict=True))
    own["risk"] = tuple(RiskPoint(_at(point), point["risk"]) for point in (drawn or {}).get("risk", ()))
    own |= {"together": tuple(document["together"]), "action": Action(document["action"])}
    own["basis"] = _basis(document.get("basis"))
    return UnitOutlook(**own)


def _basis(entry: dict[str, Any] | None) -> DueBasis | None:
    """None of a document that an earlier version wrote."""
    if entry is None:
        return None
    return DueBasis(**{**entry, "rule": DueRule(entry["rule"]), "at": _time(entry["at"])})


def _trend(entry: dict[str, Any], fan: list[dict[str, Any]]) -> ParameterTrend:
    times = {name: _time(entry[name]) for name in ("reach_50", "reach_90", "since")}
    steps = tuple(datetime.fromisoformat(at) for at in entry["step_dates"])
    points = tuple(FanPoint(**{**point, "at": _at(point)}) for point in fan)
    warm = entry["temperature"]
    parts = {
        "step_dates": steps,
        "fan": points,
        "changes": tuple(FoundChange(**{**c, "after": _time(c["after"]), "before": _time(c["before"])})
                         for c in entry["changes"]),
        "temperature": None if warm is None else TemperatureCoefficient(**warm),
    }  # fmt: skip
    return ParameterTrend(**{**entry, **times, **parts})


def _at(point: dict[str, Any]) -> datetime:
    return datetime.fromisoformat(point["at"])


def _time(text: str | None) -> datetime | None:
    return None if text is None else datetime.fromisoformat(text)
