"""A stand's condition as JSON and back; times are ISO 8601."""

from dataclasses import asdict
from datetime import datetime
from typing import Any

from service.records.stand import StandCondition, StandEvidence, StandSeating


def condition_to_dict(condition: StandCondition) -> dict[str, Any]:
    """What `condition_from_dict` reads."""
    own = asdict(condition)
    for name in ("evidence", "shifts"):
        own[name] = [_written(one) for one in own[name]]
    return own


def condition_from_dict(document: dict[str, Any]) -> StandCondition:
    """The condition that was written."""
    own = {name: tuple(_evidence(one) for one in document[name]) for name in ("evidence", "shifts")}
    seating = tuple(StandSeating(**one) for one in document["seating"])
    return StandCondition(**{**document, **own, "seating": seating, "unreadable": tuple(document["unreadable"])})


def _written(evidence: dict[str, Any]) -> dict[str, Any]:
    until = evidence["until"]
    times = {"since": evidence["since"].isoformat(), "until": None if until is None else until.isoformat()}
    return {**evidence, **times, "value": list(evidence["value"])}


def _evidence(written: dict[str, Any]) -> StandEvidence:
    since, until = datetime.fromisoformat(written["since"]), written["until"]
    times = {"since": since, "until": None if until is None else datetime.fromisoformat(until)}
    return StandEvidence(**{**written, **times, "value": tuple(written["value"])})
