"""Step: what a group of sessions shows means a flag: raised once an effect, of whose it is: the unit,
the type or the stand. It keeps the unit whose session showed it last.

An effect that an engineer accepted into the model is known and has none. What a person resolved stays resolved; what
the sessions no longer show is proposed to be resolved.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from datetime import datetime

from estimator.groups import GroupFinding
from estimator.message import joined, say
from service.errors import ServiceError
from service.flags.records import Concern, Flag, FlagState, Matter, NoticeKind
from service.flags.store import FlagQuery, Flags
from service.groups.records import Group, Member
from service.groups.words import holds, lasting_place, lasting_summary
from service.judging.store import Derivations
from service.kit.guard import Alone, plainly
from service.models.records import SCOPES, ModelRevision, Scope
from service.models.rules import in_force
from service.models.store import Models
from service.outlook.records import FoundChange, ParameterTrend, UnitOutlook
from service.outlook.words import NOTHING_DUE, calibrated, change_in_words, was_due
from service.records.flagging.fold import SERVICE, Occasion, propose, raise_flag, resolve_as_done, see_again
from service.sessions.decision import Verdict
from service.sessions.records import StoredSession
from service.sessions.store import Sessions
from service.stands.health import stand_health
from service.stands.records import StandCondition
from service.stands.store import Stands
from service.storage import Storage
from service.storage.queries import Store
from service.units.store import Units


def no_longer_overdue(
    store: Store, occasion: Occasion, outlook: UnitOutlook | None, latest: StoredSession | None = None
) -> tuple[Flag, ...]:
    """The one matter that resolves itself: nothing is due, or not yet. What is open still is returned, and says what is
    due now.

    ``latest``: the unit's latest calibration, the reason where it came after the flag was raised.
    It is raised by the clock (`overdue_units`) and not here: records that are entered late, one after another, would
    raise and resolve it with every one.
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
    """What is said of a unit whose date has passed; None of any other."""
    if outlook is None or outlook.due is None or outlook.due >= now:
        return None
    return Concern(Matter.OVERDUE, "", 1, was_due(outlook.due, outlook.reason))


MATTERS = {"jump": Matter.JUMP, "drift": Matter.DRIFT, "aging": Matter.DRIFT, "walk": Matter.DRIFT}
"""By kind of change; what moves at no steady rate moves on."""
NO_LONGER_DRIFTS = "The unit's accepted sessions no longer show it."
TOLD = "The sensor is out of tolerance."
FAILS = (Verdict.FAIL, Verdict.CONDITIONAL_FAIL)
"""Verdicts that have a flag of their own."""


def flag_drift(store: Store, occasion: Occasion, outlook: UnitOutlook | None) -> None:
    """Brings the flags of changes through time in line with the outlook; what a person resolved stays resolved until a
    later session. A sensor that is, or is flagged, out of tolerance has no second one for how it came there."""
    every = Flags(store).open_of(occasion.unit)
    out = {flag.place for flag in every if flag.matter is Matter.TOLERANCE} | _failed(store, occasion)
    opened = {flag.key: flag for flag in every if flag.matter in MATTERS.values()}
    concerns = () if outlook is None else tuple(_concerns(outlook))
    wanted = {concern.key: concern for concern in concerns if concern.place not in out}
    for key in sorted(opened.keys() - wanted.keys()):
        resolve_as_done(store, occasion, opened[key], TOLD if key[1] in out else NO_LONGER_DRIFTS)
    for key, concern in wanted.items():
        if key in opened:
            _show_again(store, occasion, opened[key], concern)
        elif not _is_settled(store, occasion, concern):
            raise_flag(store, occasion, concern)


def _failed(store: Store, occasion: Occasion) -> set[str]:
    """Sensors that the latest session found out of tolerance."""
    decisions = () if occasion.session is None else Sessions(store).decisions(occasion.session)
    return {decision.sensor for decision in decisions if decision.verdict in FAILS}


def _show_again(store: Store, occasion: Occasion, known: Flag, concern: Concern) -> None:
    if (known.summary, known.session) != (concern.summary, occasion.session):
        see_again(store, occasion, known, concern)


def _is_settled(store: Store, occasion: Occasion, concern: Concern) -> bool:
    """Whether a person resolved it when the latest session was there already."""
    settled = Derivations(store).settled(occasion.unit, SERVICE).get(concern.key)
    if settled is None or occasion.session is None:
        return False
    latest = Sessions(store).get(occasion.session)
    return settled >= (latest.started_at, latest.id)


def _concerns(outlook: UnitOutlook) -> Iterator[Concern]:
    """At most one a matter and sensor: its parameters' changes, the most evident first."""
    found: dict[tuple[Matter, str], list[tuple[ParameterTrend, FoundChange]]] = {}
    for trend in outlook.trends:
        for change in trend.changes:
            found.setdefault((MATTERS[change.kind], trend.sensor), []).append((trend, change))
    for (matter, sensor), changes in found.items():
        ordered = sorted(changes, key=lambda pair: pair[1].p_value)
        yield Concern(matter, sensor, 1, joined(" ", (change_in_words(trend, change) for trend, change in ordered)))


NO_LONGER_SHOWN = "The sessions together no longer show it."
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
            propose(store, Occasion(Units(store).hold(flag.unit), flag.session, at), flag, NO_LONGER_SHOWN)


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


EVERY = 10_000
"""Flags of one unit: more than any unit has."""
NO_LONGER_SHIFTED = "The units measured on {stand} no longer show a shift."


def flag_shifted_stands(storage: Storage, now: datetime, alone: Alone = plainly) -> None:
    """One flag a unit and stand; a shift whose flag was resolved after it began is known and raises no other."""
    with storage.database.reading() as store:
        conditions = stand_health(store)
        opened = Flags(store).open_about(Matter.SHIFTED)
    shifted = [one for one in conditions if one.has_shifted]
    for one in shifted:
        with alone("stands", one.stand):
            _flag_all(storage, one, now, alone)
    for one in conditions:
        with alone("stands", one.stand):
            _require_whole(one)
    named = {one.stand for one in shifted}
    for flag in opened:
        if flag.place not in named:
            with alone("stands", flag.unit):
                _propose(storage, flag, now)


def _flag_all(storage: Storage, one: StandCondition, now: datetime, alone: Alone) -> None:
    """On every unit that the stand measured last."""
    since = min(shift.since for shift in one.shifts if shift.until is None)
    with storage.database.reading() as store:
        concerned = Stands(store).last_measured(one.stand, since)
    for serial in concerned:
        with alone("stands", serial):
            _flag(storage, serial, one, since, now)


def _flag(storage: Storage, serial: str, one: StandCondition, since: datetime, now: datetime) -> None:
    """An open flag says what is known now, also where the shift is dated anew."""
    concern = Concern(Matter.SHIFTED, one.stand, 1, one.reason)
    with storage.database.writing() as store:
        unit = Units(store).hold(serial)
        known = [flag for flag in Flags(store).page(FlagQuery(unit=serial, limit=EVERY)) if flag.key == concern.key]
        opened = [flag for flag in known if flag.state is not FlagState.RESOLVED]
        occasion = Occasion(unit, None, now)
        for flag in opened:
            if (flag.summary, flag.proposal) != (concern.summary, ""):
                see_again(store, occasion, flag, concern)
        if not opened and not _is_known(known, since):
            raise_flag(store, occasion, concern)


def _is_known(resolved: Iterable[Flag], since: datetime) -> bool:
    """Whether somebody settled the matter after the shift began."""
    return any(flag.changed_at >= since for flag in resolved)


def _propose(storage: Storage, flag: Flag, now: datetime) -> None:
    """Proposes to resolve a flag that no unit speaks for any more."""
    with storage.database.writing() as store:
        unit = Units(store).hold(flag.unit)
        for own in Flags(store).open_of(unit):
            if own.id == flag.id and not own.proposal:
                propose(store, Occasion(unit, None, now), own, say(NO_LONGER_SHIFTED, stand=flag.place))


def _require_whole(one: StandCondition) -> None:
    """Tells of sessions whose common motion cannot be used; without them the stand is still judged."""
    if one.unreadable:
        raise ServiceError(
            say("The stored data of these sessions cannot be used: {why}.", why=", ".join(one.unreadable))
        )
