"""Step: the findings of a group of sessions → flags, one an effect, on the unit, the type or the stand that has it. A
flag keeps the unit whose session showed it last.

An effect that an engineer accepted into the model is known and has none, nor has one that a worse flag covers. A flag
that a person resolved stays resolved; one whose effect the sessions no longer show is closed.
"""

from collections.abc import Iterable
from dataclasses import replace
from datetime import datetime

from estimator.groups import GroupFinding
from service.flags.records import Concern, Flag, FlagState, Matter, NoticeKind
from service.flags.store import FlagQuery, Flags
from service.groups.records import Group, Level, Member
from service.groups.words import holds, lasting_place, lasting_summary
from service.models.records import SCOPES, ModelRevision, Scope
from service.models.rules import in_force
from service.models.store import Models
from service.outlook.records import UnitOutlook
from service.outlook.words import NOTHING_DUE, calibrated, was_due
from service.records.flagging.accepted import accepted_in_words
from service.records.flagging.acts import COVERED, SERVICE, Occasion, raise_flag, resolve_as_done, see_again
from service.sessions.records import StoredSession
from service.storage.queries import Store
from service.units.store import Units


def no_longer_overdue(
    store: Store, occasion: Occasion, outlook: UnitOutlook | None, latest: StoredSession | None = None
) -> tuple[Flag, ...]:
    """Resolves flags on overdue units, the one matter that resolves itself, where nothing is due any more. Returns the
    open ones, with the present due date.

    ``latest``: the unit's latest calibration, the reason where it came after the flag was raised. These flags are
    raised as time passes (`overdue_units`) and not here: records that are entered late, one after another, would raise
    and resolve one with every record.
    """
    opened = tuple(flag for flag in Flags(store).open_of(occasion.unit) if flag.matter is Matter.OVERDUE)
    concern = overdue_by(outlook, occasion.at)
    if concern is not None:
        for flag in opened:
            if flag.summary != concern.summary:
                see_again(store, replace(occasion, session=flag.session), flag, concern)
        return opened
    for flag in opened:
        why = NOTHING_DUE if latest is None or latest.uploaded_at < flag.raised_at else calibrated(latest)
        resolve_as_done(store, occasion, flag, why)
    return ()


def overdue_by(outlook: UnitOutlook | None, now: datetime) -> Concern | None:
    """The concern of a unit whose date has passed; None for any other."""
    if outlook is None or outlook.due is None or outlook.due >= now:
        return None
    return Concern(Matter.OVERDUE, "", 1, was_due(outlook.due, outlook.reason))


NO_LONGER_SHOWN = "The sessions together no longer show it."
OF_SENSORS = (Matter.TOLERANCE, Matter.CAUSE, Matter.JUMP, Matter.DRIFT)
"""Matters of flags whose place is a sensor."""


def flag_lasting(
    store: Store, group: Group, found: Iterable[GroupFinding], latest: Member | None, at: datetime
) -> None:
    """Brings the flags of a group's own effects in line with its answer; others' flags follow from theirs.

    ``latest``: the session that was measured last; None where the group has none.
    """
    scope = SCOPES[group.level.value]
    accepted = in_force(Models(store).of_subject(scope, group.name))
    known = {flag.place: flag for flag in Flags(store).of_group(Matter.LASTING, lasting_place(scope, group.name))}
    of_group = [f for f in found if (f.level, f.subject) == (group.level.value, group.name)]
    covered = {lasting_place(scope, group.name, f) for f in of_group if _is_covered(store, group, f)}
    shown: set[str] = set()
    for finding in of_group:
        place = lasting_place(scope, group.name, finding)
        if place not in covered:
            shown.add(place)
            subject = "" if scope is Scope.UNIT else group.name
            concern = Concern(Matter.LASTING, place, 1, lasting_summary(scope, finding), scope, subject)
            _settle(store, concern, known.get(place), _revision(accepted, finding), latest, at)
    for place, flag in known.items():
        if place not in shown and flag.state is not FlagState.RESOLVED:
            occasion = Occasion(Units(store).hold(flag.unit), flag.session, at)
            resolve_as_done(store, occasion, flag, COVERED if place in covered else NO_LONGER_SHOWN)


def _is_covered(store: Store, group: Group, finding: GroupFinding) -> bool:
    """Whether a worse flag covers it: of every sensor that has it, or of the stand."""
    if group.level is Level.STAND:
        query = FlagQuery(matter=Matter.STAND, stand=group.name, unresolved=True, limit=1)
        return bool(Flags(store).page(query))
    if group.level is not Level.UNIT:
        return False
    flagged = {flag.place for flag in Flags(store).open_of(group.key) if flag.matter in OF_SENSORS}
    return bool(finding.sensors) and flagged.issuperset(finding.sensors)


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
    """Resolves the flags on an effect that an engineer accepted into a model: it is known."""
    place = lasting_place(revision.scope, revision.subject, finding)
    for flag in Flags(store).of_group(Matter.LASTING, place):
        if flag.place == place and flag.state is not FlagState.RESOLVED:
            _resolve(store, Occasion(Units(store).hold(flag.unit), None, at), flag, revision)


def _resolve(store: Store, occasion: Occasion, flag: Flag, revision: ModelRevision) -> None:
    resolve_as_done(store, occasion, flag, accepted_in_words(revision))


def _revision(accepted: Iterable[ModelRevision], finding: GroupFinding) -> ModelRevision | None:
    return next((revision for revision in accepted if holds(revision, finding)), None)


def _by_person(store: Store, flag: Flag) -> bool:
    """Whether a person settled the matter, the last time."""
    done = [change for change in Flags(store).get(flag.id).changes if change.kind is NoticeKind.RESOLVED]
    return bool(done) and done[-1].who != SERVICE
