"""Charts of a group's findings: each session's own amplitude beside the pooled one, and the pooled residuals without
the effect and with it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from math import degrees, isfinite
from statistics import median

from estimator.groups import GroupFinding
from estimator.groups.layout import EVERY
from estimator.groups.pictures import ANGLES
from estimator.groups.results import Picture
from estimator.json_object import Json
from estimator.message import joined, say
from estimator.moments import moment
from service.diagnosis.words.amplitudes import amplitude_measure, part_of
from service.kit.libraries import alt
from service.kit.measures import ARCSEC, COVERAGE, Measure, day_of, deviation_measure, measured, number
from service.sessions.charts import (
    BETA,
    DATA_FORM,
    ChartSet,
    Panel,
    filled,
    hints,
    padded,
    specification,
    ticks,
    x_scale,
    y_axis,
    y_scale,
    zero_line,
)

HEIGHT = 150
"""Pixels."""
UNSURE = 3.0
"""Times the usual session's U that another one's may be and still set the scale of the chart."""
AIR = 0.04
"""Share of the time that is left empty on either side, so that no mark is cut."""
POOLED, VALUE = "pooled", "{value}"
SIDES = ("without it", "with it")
WHAT = {EVERY: "Every sensor", "δβ": "The angle β,", "δα": "The elevation α,"}
"""Subject of a picture, unless it is a single sensor."""
BY_ANGLE = "β"
TITLES = {BY_ANGLE: "β, °", "(T − T̄)": "T − T̄, K", "(t − t̄)": "t − t̄, h", "a": "input, of the applied vector"}
"""Title of the axis that a picture is drawn over."""
FACTORS = {BY_ANGLE: degrees(1.0), "(t − t̄)": 1 / 3600}
"""Factors from SI to the unit of the axis."""


@dataclass(frozen=True)
class Element:
    """One amplitude of a finding: its place in the tuples, its name and its measure."""

    number: int
    name: str
    measure: Measure


def elements_of(finding: GroupFinding) -> Iterator[Element]:
    """The amplitudes that the sessions observe."""
    width = max(1, len(finding.amplitude) // max(1, len(finding.sensors)))
    for k, (value, sigma) in enumerate(zip(finding.amplitude, finding.sigma, strict=True)):
        if sigma is not None:
            who = finding.sensors[k // width] if len(finding.sensors) > 1 else ""
            which = part_of(finding.cause, k % width) if width > 1 else ""
            unit = finding.units[k % len(finding.units)]
            largest = max(abs(value), COVERAGE * sigma)
            yield Element(
                k,
                (joined(" ", filter(None, (who, which.removesuffix(" ="))))) or "Amplitude",
                amplitude_measure(finding.cause, unit, largest),
            )


def forest_chart(finding: GroupFinding, name: str) -> ChartSet | None:
    """A panel an amplitude; None where no session sees one, or none has a date."""
    elements = list(elements_of(finding))
    times = [moment(session.started_at) for session in finding.sessions if session.started_at]
    if not elements or not times:
        return None
    span = [_iso(min(times)), _iso(max(times))]
    reach = max(_reach(finding, element) for element in elements)
    air = (max(times) - min(times)) * AIR
    x = (_iso(min(times) - air), _iso(max(times) + air))
    return ChartSet(
        name=f"{name}-forest",
        heading="In each session",
        spec=filled(_forest_spec(), x, padded(-reach, reach), elements[0].measure.label),
        panels=tuple(_forest_panel(finding, element, span) for element in elements),
    )


def _spreads(finding: GroupFinding, element: Element) -> list[tuple[float, float]]:
    """Every session's |amplitude| and U, as they are drawn."""
    k, factor = element.number, element.measure.factor
    amplitudes = ((session.amplitude[k], session.sigma[k]) for session in finding.sessions)
    return [(abs(value) * factor, COVERAGE * sigma * factor) for value, sigma in amplitudes if sigma is not None]


def _reach(finding: GroupFinding, element: Element) -> float:
    """Up to where amplitudes are drawn: sessions that hardly see the effect would hide the others."""
    every = _spreads(finding, element)
    usual = median(u for _, u in every)
    return max(value + u for value, u in every if u <= UNSURE * usual)


def _forest_panel(finding: GroupFinding, element: Element, span: list[str]) -> Panel:
    k, factor, sigma = element.number, element.measure.factor, finding.sigma[element.number] or 0.0
    value, spread = finding.amplitude[k], COVERAGE * sigma
    since = finding.since if finding.form == "since" and finding.since else None
    start = _iso(moment(since)) if since else span[0]
    reach = _reach(finding, element)
    beyond = sum(value > reach for value, _ in _spreads(finding, element))
    left = say("; {beyond} too uncertain to plot are in the table", beyond=beyond) if beyond else ""
    return Panel(
        title=element.name,
        description=say(
            "{value} together{omitted_rows}", value=measured(value, spread, element.measure), omitted_rows=left
        ),
        datasets={
            DATA_FORM: list(_session_points(finding, element)),
            POOLED: [
                {"t": t, "y": value * factor, "lo": (value - spread) * factor, "hi": (value + spread) * factor}
                for t in (start, span[1])
            ],
        },
    )


def _session_points(finding: GroupFinding, element: Element) -> Iterator[Json]:
    k, factor = element.number, element.measure.factor
    for session in finding.sessions:
        sigma = session.sigma[k]
        if sigma is not None and session.started_at is not None:
            at, value, spread = moment(session.started_at), session.amplitude[k], COVERAGE * sigma
            yield {
                "t": _iso(at),
                "y": _short(value * factor),
                "lo": _short((value - spread) * factor),
                "hi": _short((value + spread) * factor),
                "unit": session.unit,
                "date": day_of(at),
                "value": measured(value, spread, element.measure),
            }


@cache
def _forest_spec() -> Json:
    x = alt.X("t:T", title=None, axis=alt.Axis(tickCount=4), scale=x_scale(type="utc"))
    y = y_axis(y_scale())
    pooled = alt.Chart(alt.NamedData(name=POOLED)).encode(x=x)
    base = alt.Chart(alt.NamedData(name=DATA_FORM)).encode(x=x)
    marks = base.mark_point(
        filled=True, opacity=1, size=40, color="var(--accent)", stroke="var(--card)", clip=True
    ).encode(y=y, tooltip=hints({"date:N": "session", "unit:N": "unit", "value:N": "alone"}))
    return specification(
        [
            pooled.mark_area(color="var(--second)", opacity=0.25).encode(y=alt.Y("lo:Q"), y2="hi:Q"),
            pooled.mark_line(color="var(--second)", strokeWidth=2).encode(y=y),
            zero_line(),
            base.mark_rule(color="var(--accent)", opacity=0.55, clip=True).encode(y=alt.Y("lo:Q"), y2="hi:Q"),
            marks,
        ],
        HEIGHT,
    )


def picture_chart(picture: Picture, kind: str, name: str) -> ChartSet:
    """The pooled residual against its variable, without the effect and with it."""
    measure, at, largest = _measure_of(picture, kind), _places(picture), _largest(picture)
    reach, by_angle, title = largest * measure.factor, picture.variable == BY_ANGLE, _title(picture)
    x = (0.0, 360.0) if by_angle else padded(min(at), max(at))
    texts = {VALUE: say("mean, {label}", label=measure.label)}
    return ChartSet(
        name=f"{name}-picture",
        heading="Residuals common to all sessions",
        spec=filled(_picture_spec(title, by_angle=by_angle), x, padded(-reach, reach), measure.label, texts),
        panels=tuple(_picture_panel(picture, side, at, measure) for side in SIDES),
    )


def picture_table(picture: Picture, kind: str) -> tuple[tuple[str, ...], tuple[tuple[str, ...], ...]]:
    """Head and rows of the same."""
    measure = _measure_of(picture, kind)
    head = (_title(picture), *SIDES)
    rows = zip(_places(picture), picture.before, picture.after, picture.sigma, strict=True)
    return head, tuple(
        (number(x), *(measured(v, COVERAGE * sigma, measure) for v in (before, after)))
        for x, before, after, sigma in rows
    )


def _title(picture: Picture) -> str:
    return TITLES.get(picture.variable, picture.variable)


def _places(picture: Picture) -> list[float]:
    return [x * FACTORS.get(picture.variable, 1.0) for x in picture.at]


def _largest(picture: Picture) -> float:
    """|residual| or U of a bin, SI."""
    values = [abs(v) for v in (*picture.before, *picture.after)]
    return max((*values, *(COVERAGE * sigma for sigma in picture.sigma)), default=0.0)


def _measure_of(picture: Picture, kind: str) -> Measure:
    if picture.of in ANGLES:
        return ARCSEC
    return deviation_measure(kind, "bias", _largest(picture))


def _picture_panel(picture: Picture, side: str, at: Sequence[float], measure: Measure) -> Panel:
    values = picture.before if side == SIDES[0] else picture.after
    outside = sum(abs(v) > COVERAGE * s for v, s in zip(values, picture.sigma, strict=True))
    return Panel(
        title=say("{quantity} {direction}", quantity=WHAT.get(picture.of, picture.of), direction=side),
        description=say("{outside} of {values} outside ±2σ", outside=outside, values=len(values)),
        datasets={
            DATA_FORM: [
                {"x": _short(x), "y": _short(v * measure.factor), "band": _short(COVERAGE * s * measure.factor)}
                for x, v, s in zip(at, values, picture.sigma, strict=True)
            ]
        },
    )


@cache
def _picture_spec(title: str, *, by_angle: bool) -> Json:
    axis = alt.Axis(**ticks(BETA)) if by_angle else alt.Axis(tickCount=5)
    x = alt.X("x:Q", title=title, axis=axis, scale=x_scale(nice=False))
    scale = y_scale()
    base = alt.Chart(alt.NamedData(name=DATA_FORM)).encode(x=x)
    band = base.transform_calculate(low="-datum.band").mark_area(color="var(--accent)", opacity=0.13)
    marks = base.mark_point(filled=True, opacity=1, size=40, color="var(--accent)", stroke="var(--card)").encode(
        y=y_axis(scale), tooltip=hints({"x:Q": title, "y:Q": VALUE})
    )
    return specification([band.encode(y=alt.Y("low:Q", scale=scale), y2="band:Q"), zero_line(), marks], HEIGHT)


def _iso(at: datetime) -> str:
    return f"{at.astimezone(UTC):%Y-%m-%dT%H:%M:%SZ}"


def _short(value: float) -> float:
    return float(f"{value:.5g}") if isfinite(value) else 0.0
