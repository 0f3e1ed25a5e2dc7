"""Step: what a group of sessions shows means a flag: raised once an effect, of whose it is: the unit,
the type or the stand. It keeps the unit whose session showed it last.

An effect that an engineer accepted into the model is known and has none. What a person resolved stays resolved; what
the sessions no longer show is proposed to be resolved.
"""

from collections.abc import Iterable
from datetime import datetime

from estimator.groups import GroupFinding
from estimator.message import say
from service.flags.records import Concern, Flag, FlagState, Matter, NoticeKind
from service.flags.store import Flags
from service.groups.records import Group, Member
from service.groups.words.group import lasting_place, lasting_summary
from service.groups.words.group_finding import holds
from service.models.records import SCOPES, ModelRevision, Scope
from service.models.rules import in_force
from service.models.store import Models
from service.records.flagging.settle import SERVICE, Occasion, propose, raise_flag, resolve_as_done, see_again
from service.storage.store import Store
from service.units.store import Units

GONE = "The sessions together no longer show it."
ACCEPTED = "Accepted into the model of {whose}, revision {revision}."


def flag_lasting(
    store: Store, group: Group, found: Iterable[GroupFinding], latest: Member | None, at: datetime
) -> None:
    """Brings the flags of a group's own effects in line with its answer; those of others are told by theirs.

    ``latest``: the session that was measured last; None where the group has none.
    """
    scope = SCOPES[group.level.value]
    accepted = in_force(Models(store).of_subject(scope, group.name))
    known = {flag.place: flag for flag in Flags(store).of_group(Matter.LASTING, lasting_place(scope, group.name))}
    shown: set[str] = set()
    for finding in found:
        if (finding.level, finding.subject) == (group.level.value, group.name):
            place = lasting_place(scope, group.name, finding)
            shown.add(place)
            subject = "" if scope is Scope.UNIT else group.name
            concern = Concern(Matter.LASTING, place, 1, lasting_summary(scope, finding), scope, subject)
            _settle(store, concern, known.get(place), _revision(accepted, finding), latest, at)
    for place, flag in known.items():
        if place not in shown and flag.state is not FlagState.RESOLVED and not flag.proposal:
            propose(store, Occasion(Units(store).hold(flag.unit), flag.session, at), flag, GONE)


def _settle(
    store: Store, concern: Concern, flag: Flag | None, revision: ModelRevision | None, latest: Member | None,
    at: datetime,
) -> None:  # fmt: skip
    """One effect that is shown."""
    is_open = flag is not None and flag.state is not FlagState.RESOLVED
    if flag is not None and is_open:
        occasion = Occasion(Units(store).hold(flag.unit), None if latest is None else latest.session, at)
        if revision is not None:
            _resolve(store, occasion, flag, revision)
        elif (flag.summary, flag.proposal) != (concern.summary, ""):
            see_again(store, occasion, flag, concern)
    elif revision is None and latest is not None and (flag is None or not _by_person(store, flag)):
        raise_flag(store, Occasion(Units(store).hold(latest.unit), latest.session, at), concern)


def settle_accepted(store: Store, revision: ModelRevision, finding: GroupFinding, at: datetime) -> None:
    """What an engineer accepted into a model is known."""
    place = lasting_place(revision.scope, revision.subject, finding)
    for flag in Flags(store).of_group(Matter.LASTING, place):
        if flag.place == place and flag.state is not FlagState.RESOLVED:
            _resolve(store, Occasion(Units(store).hold(flag.unit), None, at), flag, revision)


def _resolve(store: Store, occasion: Occasion, flag: Flag, revision: ModelRevision) -> None:
    why = say(
        ACCEPTED, whose=say("{scope} {subject}", scope=revision.scope, subject=revision.subject), revision=revision.id
    )
    resolve_as_done(store, occasion, flag, why)


def _revision(accepted: Iterable[ModelRevision], finding: GroupFinding) -> ModelRevision | None:
    return next((revision for revision in accepted if holds(revision, finding)), None)


def _by_person(store: Store, flag: Flag) -> bool:
    """Whether a person settled the matter, the last time."""
    done = [change for change in Flags(store).get(flag.id).changes if change.kind is NoticeKind.RESOLVED]
    return bool(done) and done[-1].who != SERVICE
