"""imu-fleet-diagnosis/1 of a group, as the service hands it out."""

import json
from typing import Any

from estimator.diagnosis.results import Limit
from estimator.groups import GroupDiagnosis
from estimator.groups.results import EmpiricalTerm, GroupFinding, GroupGain, Moved, PoolLimit, Rival, SessionAmplitude
from estimator.moments import in_utc
from service.records.group import Group, GroupShown, Members
from service.storage.diagnosis_document import finite
from service.storage.json_text import json_text
from service.words.group import NO_SESSION


def group_document(group: Group, found: GroupDiagnosis | None, members: Members) -> str:
    """What was found, with what the pool leaves out; None of a group without a session to pool."""
    document = _empty(group) if found is None else finite(found.to_dict())
    left = [{"session": m.session, "reason": m.why} for m in members.without]
    whole = document | {"left_out": members.left_out, "not_pooled": left}
    return json_text(whole)


def read_group(text: str) -> GroupShown:
    """What `group_document` wrote."""
    document = json.loads(text)
    return GroupShown(
        sessions=document["sessions"],
        first=in_utc(document["first"]),
        last=in_utc(document["last"]),
        left_out=document["left_out"],
        findings=tuple(map(_finding, document["findings"])),
        limits=tuple(map(_limit, document["limits"])),
        gain=None if document["gain"] is None else _gain(document["gain"]),
        terms=tuple(map(_term, document["terms"])),
        structures=tuple(f"{one['where']} ({one['subject']})" for one in document["structures"]),
        notes=tuple(document["notes"]),
    )


def _finding(entry: dict[str, Any]) -> GroupFinding:
    """Lists are the tuples that they were; moments are in UTC."""
    own: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in entry.items()}
    own["rivals"] = tuple(Rival(**rival | {"sensors": tuple(rival["sensors"])}) for rival in entry["rivals"])
    own["sessions"] = tuple(
        SessionAmplitude(in_utc(s["started_at"]), s["unit"], tuple(s["amplitude"]), tuple(s["sigma"]))
        for s in entry["sessions"]
    )
    return GroupFinding(**own | {"since": in_utc(entry["since"])})


def _term(entry: dict[str, Any]) -> EmpiricalTerm:
    own: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in entry.items()}
    return EmpiricalTerm(**own)


def _gain(entry: dict[str, Any]) -> GroupGain:
    return GroupGain(**entry | {"moved": tuple(Moved(**one) for one in entry["moved"])})


def _limit(entry: dict[str, Any]) -> PoolLimit:
    of_pool, of_one = (
        Limit(entry["cause"], None if size is None else tuple(size), tuple(entry["units"]), entry["reason"])
        for size in (entry["amplitude"], entry["one_session"])
    )
    return PoolLimit(of_pool, of_one)


def _empty(group: Group) -> dict[str, Any]:
    nothing: dict[str, Any] = {name: [] for name in ("findings", "terms", "structures", "limits")}
    unknown = dict.fromkeys(("first", "last", "gain"))
    head = {"format": "imu-fleet-diagnosis/1", "level": group.level.value, "id": group.name, "sessions": 0}
    return {**head, **nothing, **unknown, "unexplained": False, "e_value": 1.0, "notes": [NO_SESSION]}
