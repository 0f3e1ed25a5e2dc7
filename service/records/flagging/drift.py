"""Step: what a unit's outlook means for its flags: a parameter that drifts or has jumped."""

from collections.abc import Iterator

from estimator.message import joined
from service.flags.records import Concern, Flag, Matter
from service.flags.store import Flags
from service.judging.store import Derivations
from service.outlook.records import FoundChange, ParameterTrend, UnitOutlook
from service.outlook.words.changes import change_in_words
from service.records.flagging.settle import SERVICE, Occasion, raise_flag, resolve_as_done, see_again
from service.sessions.decision import Verdict
from service.sessions.store import Sessions
from service.storage.store import Store

MATTERS = {"jump": Matter.JUMP, "drift": Matter.DRIFT, "aging": Matter.DRIFT, "walk": Matter.DRIFT}
"""By kind of change; what moves at no steady rate moves on."""
GONE = "The history of the unit's accepted sessions does not show it any more."
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
        resolve_as_done(store, occasion, opened[key], TOLD if key[1] in out else GONE)
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
