"""Tolerances are tried, previewed and set.

A recording in service is judged by its stored comparison, as with its upload: no file is read.
"""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from datetime import datetime
from math import isclose, isfinite

from estimator.errors import Problem
from estimator.health.temperature_law import NO_STEPS, Steps
from estimator.message import say
from estimator.parity import ParityResult
from estimator.results import Calibration
from estimator.session import ACCELEROMETER, GYROSCOPE, IN_SERVICE
from estimator.wording import counted
from service.errors import ConflictError, RefusedError
from service.fleet.records import FleetQuery
from service.fleet.rows_store import FleetRows
from service.fleet.store import Fleet
from service.judging.calibrate import ReferenceComparison
from service.judging.judge import judge, judge_recording
from service.judging.reference import reference_of
from service.judging.store import Derivations
from service.kit.measures import COVERAGE, Measure, deviation_measure, heading, in_measure
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.derive_again import AT_ONCE, Deriving
from service.records.follow import date, judge_type
from service.sessions.calibrations_store import Calibrations
from service.sessions.records import PARAMETERS
from service.sessions.store import Sessions
from service.sessions.words.conditions import Condition, condition_of
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.queries import Store
from service.types.records import LatestSession, TolerancePreview, Tolerances, UnitType, VerdictChange, WantedTolerances
from service.types.store import UnitTypes
from service.units.store import Units

SAME = 1e-9
"""Relative: what a number loses as it is written and read again; so much is no change."""
LEAST, MOST = 1e-15, 1e6
"""SI; as the API has it."""
SHORTEST, LONGEST = 1, 36_525
"""Days: from one to a hundred years."""
INTERVAL, SHARE, STORED = "interval", "share", "stored"


@dataclass(frozen=True)
class ToleranceField:
    """One number."""

    key: str
    label: str
    unit: str
    value: str
    """Number in force; empty where it is not judged."""


@dataclass(frozen=True)
class Watch:
    """Interval and share for flags of a type's units; None leaves it as it is."""

    interval_days: float | None = None
    flag_share: float | None = None


@dataclass(frozen=True)
class ToleranceForm:
    """Values in the form."""

    tolerances: Tolerances
    gyro_tolerances: Tolerances | None
    watch: Watch


def tolerance_fields(known: UnitType) -> tuple[ToleranceField, ...]:
    """The fields that can be set, with the values in force."""
    return tuple(
        ToleranceField(
            f"{kind}.{name}", _label(known, kind, name), _measure(kind, name).label, _text(kind, name, given)
        )
        for kind, given in kinds_of(known)
        for name in PARAMETERS
    )


def days(known: UnitType) -> str:
    """The longest interval as the form has it."""
    return f"{known.maximum_interval_days:.12g}"


def share(known: UnitType) -> str:
    """The share of the tolerance, %, from which on a change has a flag, as text for the form."""
    return f"{100 * known.flag_share:.12g}"


def wanted(known: UnitType, form: Mapping[str, str]) -> ToleranceForm:
    """Reads a form; RefusedError with every number that is none."""
    faults: list[Problem] = []
    read = {kind: Tolerances(**{name: _read(kind, name, given, form, faults) for name in PARAMETERS})
            for kind, given in kinds_of(known)}  # fmt: skip
    watch = _watch(known, form, faults)
    if faults:
        raise RefusedError("The tolerances cannot be set.", tuple(faults))
    first, *others = read.values()
    return ToleranceForm(first, others[0] if others else None, watch)


def _watch(known: UnitType, form: Mapping[str, str], faults: list[Problem]) -> Watch:
    interval = _number(INTERVAL, form.get(INTERVAL, days(known)), faults)
    percent = _number(SHARE, form.get(SHARE, share(known)), faults)
    if interval is not None and not SHORTEST <= interval <= LONGEST:
        must = say("must be between {shortest} and {longest} days", shortest=SHORTEST, longest=f"{LONGEST:,}")
        faults.append(Problem(INTERVAL, must))
    if percent is not None and not 0 <= percent <= 100:
        faults.append(Problem(SHARE, "must be between 0 and 100 %"))
    return Watch(interval, None if percent is None else percent / 100)


def kinds_of(known: UnitType) -> tuple[tuple[str, Tolerances], ...]:
    """Kinds of sensor with their tolerances; none of a type of which no unit was measured yet."""
    if not known.block:
        return ()
    if known.gyro_tolerances is None:
        return ((known.block, known.tolerances),)
    return (ACCELEROMETER, known.tolerances), (GYROSCOPE, known.gyro_tolerances)


def _label(known: UnitType, kind: str, name: str) -> str:
    return (
        heading(name)
        if known.gyro_tolerances is None
        else say("{heading}, {kind}", heading=heading(name), kind=f"{kind}s")
    )


def _measure(kind: str, name: str) -> Measure:
    """Always the fine one, so that a number never changes its meaning with its size."""
    return deviation_measure(kind, name, 0.0)


def _text(kind: str, name: str, given: Tolerances) -> str:
    shown = in_measure(getattr(given, name), _measure(kind, name))
    return "" if shown is None else f"{shown:.12g}"


def _read(kind: str, name: str, given: Tolerances, form: Mapping[str, str], faults: list[Problem]) -> float | None:
    """The number in SI; the one in force where it was not changed."""
    key, current = f"{kind}.{name}", getattr(given, name)
    text = form.get(key, _text(kind, name, given)).strip()
    number = _number(key, text, faults) if text else None
    if number is None:
        return None
    tolerance = number / _measure(kind, name).factor
    if current is not None and isclose(tolerance, current, rel_tol=SAME):
        return float(current)
    if not LEAST <= tolerance <= MOST:
        faults.append(Problem(key, "must be greater than zero and within the measurable range"))
    return tolerance


def _number(key: str, text: str, faults: list[Problem]) -> float | None:
    """A number with a point or a comma; None, and a fault, where it is none."""
    try:
        found = float(text.strip().replace(",", "."))
    except ValueError:
        found = float("nan")
    if isfinite(found):
        return found
    faults.append(Problem(key, "is not a number"))
    return None


def headline_of(found: TolerancePreview) -> str:
    """``With these, 3 of 40 units change``: of those that were judged by them."""
    changed = len(found.changes)
    if not found.judged:
        return "No unit of this type has a session that can be judged by tolerances"
    if not changed:
        return "With these tolerances, no verdict changes"
    return (
        say(
            "With these tolerances, the verdict of {changed} of {judged} units changes",
            changed=changed,
            judged=found.judged,
        )
        if changed == 1
        else say(
            "With these tolerances, the verdicts of {changed} of {judged} units change",
            changed=changed,
            judged=found.judged,
        )
    )


def notes_of(found: TolerancePreview) -> Iterator[str]:
    """The notes on units that were not examined."""
    if found.references:
        yield say(
            "{references} not counted: the latest session is a reference, which is not judged.",
            references=counted(found.references, "unit"),
        )
    if found.recordings:
        units = counted(found.recordings, "unit")
        yield say(
            "{units} not counted: the latest session is a recording in service without a calibration.", units=units
        )
    if found.beyond:
        yield say("Only the worst units were checked; not checked: {beyond}.", beyond=counted(found.beyond, "unit"))


CARRIED_APART = ("by", "why", "csrf")
"""Fields that the form of the page asks for."""


@dataclass(frozen=True)
class VerdictChangeRow:
    """One unit with another verdict."""

    unit: str
    before: Condition
    after: Condition
    reason: str


@dataclass(frozen=True)
class PreviewPage:
    """Everything the page shows."""

    name: str
    headline: str
    rows: tuple[VerdictChangeRow, ...]
    notes: tuple[str, ...]
    interval: str
    """New interval in the form; empty where it stays."""
    share: str
    """New share of the tolerance in the form, %; empty where it stays."""
    carried: tuple[tuple[str, str], ...]
    """Numbers as they were written, to be set as they are."""
    why: str
    judges_stored: bool
    """Whether stored sessions are to be judged by them too."""


def preview_page(
    known: UnitType, asked: ToleranceForm, form: Mapping[str, str], found: TolerancePreview
) -> PreviewPage:
    """The changes under other tolerances, and the form that sets them."""
    other = _others(known, asked.watch)
    return PreviewPage(
        name=known.name,
        headline=headline_of(found),
        rows=tuple(
            VerdictChangeRow(change.unit, condition_of(change.before), condition_of(change.after), change.reason)
            for change in found.changes
        ),
        notes=tuple(notes_of(found)),
        interval=days(other) if other.maximum_interval_days != known.maximum_interval_days else "",
        share=share(other) if other.flag_share != known.flag_share else "",
        carried=tuple((key, value) for key, value in form.items() if key not in CARRIED_APART),
        why=form.get("why", ""),
        judges_stored=STORED in form,
    )


AS_IT_IS = Watch()


def set_tolerances(
    storage: Storage,
    name: str,
    tolerances: Tolerances,
    gyro_tolerances: Tolerances | None,
    now: datetime,
    *,
    watch: Watch = AS_IT_IS,
    who: str = "crew",
    why: str = "",
    seen: int | None = None,
    stored: bool = False,
) -> UnitType:
    """Adds a revision of the type's tolerances; the same ones again change nothing, and past decisions keep theirs,
    unless ``stored`` sessions are to be judged by them too: then defaults are confirmed.

    ConflictError where ``seen``, the revision that somebody changed, is no longer the one in force.

    How units are watched holds for all units of the type at once.
    """
    undated: tuple[str, ...] = ()
    unjudged = 0
    with storage.database.writing() as store:
        current = UnitTypes(store).hold(name)
        if seen is not None and seen != current.revision:
            raise ConflictError(
                "Other tolerances were set meanwhile, revision {revision}: check them, then set yours.",
                revision=current.revision,
            )
        said = {"why": why} if why else {}
        wished = _others(current, watch)
        if wished != current:
            for action, numbers in _differences(current, wished):
                Audit(store).write(now, who, action, name, numbers | said)
            current = UnitTypes(store).set_watch(name, days=wished.maximum_interval_days, share=wished.flag_share)
            undated = tuple(Units(store).of_type(name))
            for serial in undated:
                WorkQueue(store, WorkKind.OUTLOOK).enqueue_again(serial, now)
        wished = replace(current, tolerances=tolerances, gyro_tolerances=gyro_tolerances)
        if stored or current != wished:
            before = asdict(current)
            current = UnitTypes(store).revise(replace(wished, are_entered=True, holds_before=stored), now)
            unjudged = Derivations(store).wait_of_type(name) if stored else 0
            Audit(store).write(now, who, "tolerances", name, {"before": before, **asdict(current), **said})
    context = Deriving(storage.files, COVERAGE, now)
    if 0 < unjudged <= AT_ONCE:
        judge_type(storage, context, name)
    date(storage, context, *undated)
    return current


def _others(known: UnitType, watch: Watch) -> UnitType:
    """The type watched otherwise; the same number written again is no other one."""
    days = known.maximum_interval_days if watch.interval_days is None else watch.interval_days
    share = known.flag_share if watch.flag_share is None else watch.flag_share
    same = isclose(share, known.flag_share, rel_tol=SAME)
    return replace(known, maximum_interval_days=days, flag_share=known.flag_share if same else share)


def _differences(was: UnitType, now: UnitType) -> Iterator[tuple[str, dict[str, float]]]:
    """Lines of the audit trail: the action and the numbers."""
    for action, name in (("interval", "maximum_interval_days"), ("flag share", "flag_share")):
        before, after = getattr(was, name), getattr(now, name)
        if before != after:
            yield action, {"before": before, name: after}


MOST_UNITS = 100
"""Units that are looked at, the worst first: about two seconds; those far within their tolerances change last."""


def preview_tolerances(store: Store, name: str, wanted: WantedTolerances, coverage_factor: float) -> TolerancePreview:
    """The effect of other tolerances by the rule that judges uploads, against the same references; NotFoundError where
    there is no such type.
    """
    known = UnitTypes(store).get(name)
    other = replace(known, tolerances=wanted.tolerances, gyro_tolerances=wanted.gyro_tolerances, are_entered=True)
    units = sum(UnitTypes(store).uses(name)[name].verdicts.values())
    serials = tuple(unit.serial for unit in Fleet(store).units(FleetQuery(unit_type=name, limit=MOST_UNITS)))
    latest = FleetRows(store).latest_sessions(serials)
    against = {session.session: _reference(store, session) for session in latest.values()}
    known_of = {session: reference for session, reference in against.items() if reference is not None}
    calibrations = Calibrations(store).in_force({*known_of, *known_of.values()})
    alone = {session.session for session in latest.values() if _is_uncompared(session, known_of, calibrations)}
    compared = {session: reference for session, reference in known_of.items() if session not in alone}
    judged = [latest[serial] for serial in serials if serial in latest and latest[serial].session in compared]
    steps = Sessions(store).temperature_steps(compared)
    found = (
        _change(s, tuple(calibrations[id] for id in (s.session, compared[s.session])), other, coverage_factor, steps)
        for s in judged
    )
    return TolerancePreview(
        units=units,
        judged=len(judged),
        references=len(against) - len(compared) - len(alone),
        recordings=len(alone),
        beyond=units - len(latest),
        changes=tuple(sorted(filter(None, found), key=lambda change: -change.after.severity)),
    )


def _reference(store: Store, last: LatestSession) -> str | None:
    """The session that it is judged against; None of a reference, and where there is none."""
    if last.is_reference:
        return None
    return reference_of(store, last.key, last.block, last.programme, last.started_at).session


def _is_uncompared(last: LatestSession, against: Mapping[str, str], calibrations: Mapping[str, Calibration]) -> bool:
    """Whether it is a recording in service without a calibration to compare it with, or whose file could not be read
    when it was to be compared."""
    return last.programme == IN_SERVICE and (last.session not in against or calibrations[last.session].parity is None)


def _change(
    last: LatestSession,
    pair: tuple[Calibration, ...],
    other: UnitType,
    coverage_factor: float,
    steps: Mapping[str, Steps],
) -> VerdictChange | None:
    """A session and its reference are the pair."""
    calibration, reference = pair
    if calibration.parity is None:
        found = judge(calibration, reference, other, coverage_factor, steps=steps.get(last.session, NO_STEPS))
    else:
        seen = ReferenceComparison(reference, ParityResult.from_dict(calibration.parity))
        found = judge_recording(calibration, seen, other, coverage_factor, last.temperature)
    if found.verdict is last.verdict:
        return None
    worst = found.worst
    place = ("", "") if worst is None else (worst.sensor, worst.parameter)
    return VerdictChange(last.unit, last.session, last.verdict, found.verdict, *place, found.reason)
