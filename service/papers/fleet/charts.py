"""The fleet in one picture: how much of its tolerance each unit uses."""

from collections.abc import Iterable, Mapping
from functools import cache

from estimator.json_object import Json
from estimator.message import say
from estimator.wording import counted
from service.fleet.records import LAST, NOT_JUDGED, STEP, Tally
from service.kit.libraries import alt
from service.sessions.charts import DATA_FORM, ChartSet, Panel, specification
from service.sessions.decision import Verdict
from service.sessions.words.conditions import CONDITIONS, Condition, condition_of

HEIGHT = 120
"""Pixels: the whole fleet in one low strip above its table."""
TITLE = say(
    "tolerance used, U included, %; two bars beyond 100: within U of the tolerance; last bar: from {limit} on",
    limit=LAST,
)
LIMIT = 100 // STEP
"""The first bar beyond the tolerance."""
BARS = {
    Verdict.PASS: (0, LIMIT - 1),
    Verdict.CONDITIONAL_PASS: (LIMIT, LIMIT),
    Verdict.CONDITIONAL_FAIL: (LIMIT + 1, LIMIT + 1),
    Verdict.FAIL: (LIMIT + 2, LAST // STEP),
}
"""First and last bar of a verdict: a unit within U of its tolerance has a bar of its own, so that a better verdict is
never to the right of a worse one, however large U is.
"""
TICKS = list(range(0, LAST + 1, 2 * STEP))
"""Numbered bars of the tolerance axis: every other one, so that the numbers do not overlap."""


def fleet_chart(tallies: Iterable[Tally]) -> ChartSet:
    """Units by the share of the tolerance that their worst parameter uses, uncertainty included."""
    counts: dict[tuple[int, Condition], int] = {}
    for tally in tallies:
        if is_drawn(tally):
            key = (bar_by_verdict(tally) * STEP, condition_of(tally.verdict))
            counts[key] = counts.get(key, 0) + tally.units
    rows = _stacked(counts)
    text = say("{counts} by tolerance used", counts=counted(sum(counts.values()), "unit"))
    return ChartSet("fleet", "Tolerance used", _spec(), (Panel("", text, {DATA_FORM: rows}),))


def is_drawn(tally: Tally) -> bool:
    """Whether its units were judged against their tolerance: an undecided unit has no stated share of it."""
    return tally.bar != NOT_JUDGED and tally.verdict is not Verdict.UNDECIDABLE


def bar_by_verdict(tally: Tally) -> int:
    """The bar of a tally, within the limits set by its verdict."""
    first, last = BARS.get(tally.verdict, (tally.bar, tally.bar))
    return min(max(tally.bar, first), last)


def _stacked(counts: Mapping[tuple[int, Condition], int]) -> list[Json]:
    """Bars with the better conditions below."""
    rows: list[Json] = []
    top: dict[int, int] = {}
    for (left, condition), count in sorted(counts.items(), key=lambda item: (item[0][0], -item[0][1].rank)):
        below = top.get(left, 0)
        top[left] = below + count
        rows.append({"left": left, "right": left + STEP, "low": below, "high": top[left], "verdict": condition.word})
    return rows


@cache
def _spec() -> Json:
    names = [condition.word for condition in CONDITIONS]
    colours = [f"var(--{condition.key})" for condition in CONDITIONS]
    x = alt.X("left:Q", title=TITLE, scale=alt.Scale(domain=[0, LAST + STEP]), axis=alt.Axis(values=TICKS))
    y = alt.Y("low:Q", title="units", axis=alt.Axis(tickCount=4, format="d", tickMinStep=1))
    bars = (
        alt.Chart(alt.NamedData(name=DATA_FORM))
        .mark_rect(stroke="var(--card)", strokeWidth=0.7)
        .encode(
            x=x,
            x2="right:Q",
            y=y,
            y2="high:Q",
            color=alt.Color("verdict:N", legend=None, scale=alt.Scale(domain=names, range=colours)),
        )
    )
    limit = (
        alt.Chart(alt.InlineData(values=[{"limit": 100}]))
        .mark_rule(color="var(--tolerance)", strokeDash=[5, 3], strokeWidth=1.5)
        .encode(x="limit:Q")
    )
    return specification([bars, limit], HEIGHT)
