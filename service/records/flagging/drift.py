"""Step: the history of a unit's sensors → flags, one a sensor, for its worst kind of change.

A change has a flag where somebody must act (`is_worth_a_flag`); a smaller change is a remark. A sensor that is, or is
flagged, out of tolerance has no second one for the change behind it, nor has one whose drift has made the calibration
due that is overdue. A flag that a person resolved stays resolved until a later session.
"""

from collections.abc import Iterator
from datetime import datetime, timedelta

from estimator.message import joined
from service.flags.records import Concern, Flag, Matter
from service.flags.store import Flags
from service.judging.records import Key, Moment
from service.judging.store import Derivations
from service.kit.measures import YEAR
from service.outlook.records import FoundChange, ParameterTrend, UnitOutlook
from service.outlook.words import change_in_words
from service.records.flagging.acts import COVERED, SERVICE, Occasion, raise_flag, resolve_as_done, see_again
from service.sessions.decision import Verdict
from service.sessions.store import Sessions
from service.storage.queries import Store
from service.types.records import UnitType
from service.types.store import UnitTypes

MATTERS = (Matter.JUMP, Matter.DRIFT)
FAILS = (Verdict.FAIL, Verdict.CONDITIONAL_FAIL)
"""Verdicts that have a flag of their own."""
NOT_SHOWN = "The history of the unit's accepted sessions no longer shows it."
SMALL = "The change is too small for a flag; it is listed on the unit's page."
OUT = "The sensor is out of tolerance."
LATE = "The flag on the overdue calibration covers it."
Found = tuple[ParameterTrend, FoundChange]


def flag_drift(store: Store, occasion: Occasion, outlook: UnitOutlook | None) -> None:
    """Brings the flags of changes through time in line with the outlook."""
    every = Flags(store).open_of(occasion.unit)
    opened = {flag.key: flag for flag in every if flag.matter in MATTERS}
    found = {} if outlook is None else _by_sensor(outlook)
    settled = Derivations(store).settled(occasion.unit, SERVICE) if found else {}
    covered = _covered_elsewhere(store, occasion, every, outlook)
    concerns = () if outlook is None else _concerns(_unknown(found, settled), outlook, _type(store, outlook))
    wanted = {concern.key: concern for concern in concerns if concern.place not in covered}
    sensors = {sensor for _, sensor in wanted}
    for key in sorted(opened.keys() - wanted.keys()):
        why = covered.get(key[1]) or (COVERED if key[1] in sensors else SMALL if key[1] in found else NOT_SHOWN)
        resolve_as_done(store, occasion, opened[key], why)
    for key, concern in wanted.items():
        if key in opened:
            _show_again(store, occasion, opened[key], concern)
        elif not _is_settled(store, occasion, settled.get(key)):
            raise_flag(store, occasion, concern)


def _covered_elsewhere(
    store: Store, occasion: Occasion, every: tuple[Flag, ...], outlook: UnitOutlook | None
) -> dict[str, str]:
    """Sensors whose changes another flag covers, and why."""
    late = any(flag.matter is Matter.OVERDUE for flag in every)
    basis = None if outlook is None or not late else outlook.basis
    covered = {} if basis is None or basis.sensor is None else {basis.sensor: LATE}
    out = {flag.place for flag in every if flag.matter is Matter.TOLERANCE} | _failed(store, occasion)
    return covered | dict.fromkeys(out, OUT)


def _failed(store: Store, occasion: Occasion) -> set[str]:
    """Sensors that the latest session found out of tolerance."""
    decisions = () if occasion.session is None else Sessions(store).decisions(occasion.session)
    return {decision.sensor for decision in decisions if decision.verdict in FAILS}


def _show_again(store: Store, occasion: Occasion, known: Flag, concern: Concern) -> None:
    if (known.summary, known.session) != (concern.summary, occasion.session):
        see_again(store, occasion, known, concern)


def _is_settled(store: Store, occasion: Occasion, settled: Moment | None) -> bool:
    """Whether a person resolved it when the latest session was there already."""
    if settled is None or occasion.session is None:
        return False
    latest = Sessions(store).get(occasion.session)
    return settled >= (latest.started_at, latest.id)


def _by_sensor(outlook: UnitOutlook) -> dict[str, list[Found]]:
    found: dict[str, list[Found]] = {}
    for trend in outlook.trends:
        for change in trend.changes:
            found.setdefault(trend.sensor, []).append((trend, change))
    return {sensor: sorted(changes, key=lambda pair: pair[1].p_value) for sensor, changes in found.items()}


def _unknown(found: dict[str, list[Found]], settled: dict[Key, Moment]) -> dict[str, list[Found]]:
    """The changes without jumps that a person knew of when the sensor's flag was resolved: they are over."""
    known = {sensor: at for (matter, sensor), (at, _) in settled.items() if matter == Matter.JUMP}
    return {
        sensor: [pair for pair in changes if pair[1].kind in GOES_ON or not _is_before(pair[1], known.get(sensor))]
        for sensor, changes in found.items()
    }


def _is_before(change: FoundChange, at: datetime | None) -> bool:
    return at is not None and change.before <= at


def _type(store: Store, outlook: UnitOutlook) -> UnitType:
    return UnitTypes(store).of_unit(outlook.serial)


def _concerns(found: dict[str, list[Found]], outlook: UnitOutlook, unit_type: UnitType) -> Iterator[Concern]:
    """One a sensor: a change that goes on is worse than one that is over."""
    for sensor, changes in found.items():
        worth = [pair for pair in changes if is_worth_a_flag(*pair, outlook, unit_type)]
        if worth:
            goes_on = any(change.kind in GOES_ON for _, change in worth)
            matter = Matter.DRIFT if goes_on else Matter.JUMP
            yield Concern(matter, sensor, 1, joined(" ", (change_in_words(*pair) for pair in worth)))


GOES_ON = ("drift", "aging", "walk")
"""Kinds of change that have not come to an end."""
A_YEAR = 1.0


def is_worth_a_flag(trend: ParameterTrend, change: FoundChange, outlook: UnitOutlook, unit_type: UnitType) -> bool:
    """Whether a change takes the share of the tolerance that its type says, or goes on and may pass the tolerance
    before the unit comes back."""
    latest, back = outlook.risk[0].at, comes_back(outlook, unit_type)
    years = max(A_YEAR, (back - latest) / YEAR)
    if taken_by(change, years) >= unit_type.flag_share * trend.tolerance:
        return True
    return change.kind in GOES_ON and trend.reach_90 is not None and trend.reach_90 <= back


def taken_by(change: FoundChange, years: float) -> float:
    """The share of the tolerance that a change takes, SI or relative: a jump its size, a drift its growth in so many
    years, aging that of its first year, after which it slows, a walk its present size.
    """
    return abs(change.size) * (years if change.kind == "drift" else 1.0)


def comes_back(outlook: UnitOutlook, unit_type: UnitType) -> datetime:
    """The due date of the next calibration; where the unit waits for no date, the longest interval from the latest."""
    return outlook.due or outlook.risk[0].at + timedelta(days=unit_type.maximum_interval_days)
