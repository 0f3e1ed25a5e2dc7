"""imu-fleet-diagnosis/1 of a group, as the service hands it out."""

import json
from typing import Any

from estimator.groups import GroupDiagnosis
from service.records.group import Group, Members
from service.storage.diagnosis_document import finite
from service.words.group import NO_SESSION


def group_document(group: Group, found: GroupDiagnosis | None, members: Members) -> str:
    """What was found, with what the pool leaves out; None of a group without a session to pool."""
    document = _empty(group) if found is None else finite(found.to_dict())
    left = [{"session": m.session, "reason": m.why} for m in members.without]
    whole = document | {"left_out": members.left_out, "not_pooled": left}
    return json.dumps(whole, separators=(",", ":"), allow_nan=False)


def _empty(group: Group) -> dict[str, Any]:
    nothing: dict[str, Any] = {name: [] for name in ("findings", "terms", "structures", "limits")}
    unknown = dict.fromkeys(("first", "last", "gain"))
    head = {"format": "imu-fleet-diagnosis/1", "level": group.level.value, "id": group.name, "sessions": 0}
    return {**head, **nothing, **unknown, "unexplained": False, "e_value": 1.0, "notes": [NO_SESSION]}
