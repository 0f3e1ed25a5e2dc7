"""What two sessions of a unit have in common, and what that does to the uncertainty of their difference."""

from collections.abc import Sequence

from service.records.event import Service
from service.records.session import StoredSession
from service.words.names import day_of

DIRECT = "They are compared directly, so the reference that both are judged against plays no part in the difference."
ONE_STAND = (
    "Both were measured on stand {stand}: unless it was set anew between them, its constant errors act on both alike "
    "and cancel in the difference. “On one stand” leaves them out; ± U counts them in full for each, as the decision "
    "rule does, and is the larger of the two."
)
TWO_STANDS = (
    "They were measured on different stands, {first} and {second}: the constant errors of each count in full, and what "
    "differs between the stands is part of the difference."
)
NO_STAND = "They were not both measured on a stand: the errors of each count in full."
SERVICED = "Between them the unit was serviced ({days}): a change may be what was done to it."
OTHER_MODEL = (
    "They were calibrated with different causes in the model, revisions {first} and {second}: a part of the difference "
    "may be the model's."
)
OTHER_METHOD = "They were measured in different ways, {first} and {second}."


def in_common(first: StoredSession, second: StoredSession, services: Sequence[Service]) -> tuple[str, ...]:
    """One sentence for each matter that there is something to say of."""
    said = [_stand(first.stand, second.stand), DIRECT]
    if services:
        said.append(SERVICED.format(days=", ".join(dict.fromkeys(day_of(service.at) for service in services))))
    if first.revision != second.revision:
        said.append(OTHER_MODEL.format(first=first.revision, second=second.revision))
    if first.programme != second.programme:
        named = (one.programme.replace("-", " ") for one in (first, second))
        said.append(OTHER_METHOD.format(**dict(zip(("first", "second"), named, strict=True))))
    return tuple(said)


def _stand(first: str | None, second: str | None) -> str:
    if first is None or second is None:
        return NO_STAND
    return ONE_STAND.format(stand=first) if first == second else TWO_STANDS.format(first=first, second=second)
