"""Groups' answers and sessions' statistics, as they are kept."""

import json

from estimator.groups import GroupDiagnosis
from service.groups.records import Group, GroupShown, Members
from service.groups.words.group import NO_SESSION
from service.storage.documents import STORED
from service.storage.json_text import json_text


def group_document(group: Group, found: GroupDiagnosis | None, members: Members) -> str:
    """What was found, with what the pool leaves out; None of a group without a session to pool."""
    document = found or _empty(group)
    left = [{"session": m.session, "reason": m.why} for m in members.without]
    return json_text(STORED.written(document) | STORED.written({"left_out": members.left_out, "not_pooled": left}))


def read_group(text: str) -> GroupShown:
    """What `group_document` wrote."""
    return GroupShown.from_dict(json.loads(text))


def _empty(group: Group) -> GroupDiagnosis:
    return GroupDiagnosis(
        group.level.value, group.name, 0, None, None,
        findings=(), terms=(), structures=(), limits=(), gain=None, e_value=1.0, notes=(NO_SESSION,),
    )  # fmt: skip
