"""The course of parity through a recording in service: a panel a sensor, with the moment from which one fails."""

from collections.abc import Iterator
from functools import cache

import numpy as np

from estimator.json_object import Json
from estimator.message import joined, say
from estimator.parity import CourseFault, ParityResult
from estimator.parity.results import COURSE_KINDS
from estimator.results import Calibration
from estimator.session import Array
from service.kit.libraries import alt
from service.kit.measures import THIN, Measure, deviation_measure
from service.sessions.charts import (
    BAND,
    DATA_FORM,
    HEIGHT,
    RESIDUAL,
    ChartSet,
    Panel,
    filled,
    hints,
    largest_edge,
    padded,
    residual_charts,
    scatter_in_words,
    specification,
    x_scale,
    y_axis,
    y_scale,
    zero_line,
)

FAULTS, ACROSS = "faults", "{across}"
"""The data set of the moments, and the blank for the title of x."""
ROOM = 0.15
"""Share of the height that the label of a mark takes, above all lines."""
LABELS = dict(
    zip(
        COURSE_KINDS,
        (
            *("{who} has jumped", "{who} drifts", "{who} stands still", "{who} reads zero"),
            *("{who} at the end of its range", "{who} has another scale factor", "{who} is noisy", "{who} comes late"),
            *("{who} exchanged", "{who} off now and then"),
        ),
        strict=True,
    )
)


def charts_of_fit(calibration: Calibration) -> tuple[ChartSet, ...]:
    """Charts of the agreement of model and readings; for a recording in service, of the sensors with one another."""
    if calibration.parity is None:
        return residual_charts(calibration)
    return course_charts(ParityResult.from_dict(calibration.parity))


def course_charts(result: ParityResult) -> tuple[ChartSet, ...]:
    """One set; the panels of sensors that fail come first. What an earlier release stored has fewer points."""
    course, time, sigma = result.course_fine, result.course_fine_time, result.course_fine_sigma
    if course is None or time is None or sigma is None:
        course, time, sigma = result.course, result.course_time, result.course_sigma
    at_fault = {name for fault in result.faults for name in fault.suspects}
    largest = largest_edge(course, np.broadcast_to(sigma, course.shape))
    unit = deviation_measure(result.kind, "bias", largest)
    across = "s into the recording" if result.block_seconds is not None else "rows into the recording"
    end = float(time[-1] + time[0])
    texts = {
        RESIDUAL: say("parity residual, {label}", label=unit.label),
        BAND: say("2σ, {label}", label=unit.label),
        ACROSS: say(across),
    }
    low, high = padded(-largest * unit.factor, largest * unit.factor)
    high += ROOM * (high - low) if result.faults else 0.0
    panels = [
        (sensor.name not in at_fault, _panel(result, sensor.name, (course[:, i], time, float(sigma[i])), unit, end))
        for i, sensor in enumerate(result.sensors)
    ]
    return (
        ChartSet(
            name=f"residuals-{result.kind}-course",
            heading=say("Through the recording"),
            spec=filled(_spec(), (0.0, end), (low, high), unit.label, texts),
            panels=tuple(panel for _, panel in sorted(panels, key=lambda pair: pair[0])),
        ),
    )


def _panel(result: ParityResult, name: str, drawn: tuple[Array, Array, float], unit: Measure, end: float) -> Panel:
    """``drawn``: the sensor's course, the times and one sigma."""
    course, time, sigma = drawn
    before = time <= min((fault.since for fault in result.faults), default=end)
    rms = scatter_in_words(float(np.sqrt(np.nanmean(course[before] ** 2))) if before.any() else 0.0, unit)
    points: list[Json] = [
        {"x": float(f"{x:.6g}"), "y": float(f"{y * unit.factor:.5g}"), "band": float(f"{2 * sigma * unit.factor:.5g}")}
        for x, y in zip(time, course, strict=True)
        if np.isfinite(y)
    ]
    marks = list(_marks(result.faults, name, end))
    said = [mark["text"] for mark in marks if mark["text"]]
    plain = say("rms {rms}{thin_space}{label}", rms=rms, thin_space=THIN, label=unit.label)
    return Panel(name, joined("; ", said) if said else plain, {DATA_FORM: points, FAULTS: marks})


def _marks(faults: tuple[CourseFault, ...], name: str, end: float) -> Iterator[Json]:
    """Beginning and end of each fault; its kind is written in the panel of the sensor."""
    for fault in faults:
        who = joined(", ", fault.suspects)
        label = say(LABELS[fault.kind], who=who) if name in fault.suspects else ""
        until = end if fault.until is None else fault.until
        yield {"since": fault.since, "until": until, "text": label, "late": fault.since > end / 2}


@cache
def _spec() -> Json:
    """The specification, with blanks for the unit, the texts and the ranges."""
    x, scale = alt.X("x:Q", title=ACROSS, axis=alt.Axis(tickCount=5), scale=x_scale(nice=False)), y_scale()
    base = alt.Chart(alt.NamedData(name=DATA_FORM)).encode(x=x)
    faults = alt.Chart(alt.NamedData(name=FAULTS)).encode(x=alt.X("since:Q", title=ACROSS, scale=x_scale(nice=False)))
    band = base.transform_calculate(low="-datum.band").mark_area(color="var(--accent)", opacity=0.13)
    return specification(
        [
            band.encode(y=alt.Y("low:Q", scale=scale), y2="band:Q"),
            faults.mark_rect(color="var(--fail)", opacity=0.12).encode(x2="until:Q"),
            faults.mark_rule(color="var(--fail)", strokeWidth=2),
            zero_line(),
            *_labels(faults),
            base.mark_line(color="var(--accent)", strokeWidth=1.5).encode(
                y=y_axis(scale), tooltip=hints({"x:Q": ACROSS, "y:Q": RESIDUAL, "band:Q": BAND})
            ),
        ],
        HEIGHT,
    )


def _labels(faults: "alt.Chart") -> "list[alt.Chart]":
    """Labels beside the moment, where there is more room."""
    look: Json = {"color": "var(--fail)", "fontWeight": "bold", "baseline": "top"}
    early = faults.transform_filter("!datum.late").mark_text(align="left", dx=4, **look)
    late = faults.transform_filter("datum.late").mark_text(align="right", dx=-4, **look)
    return [label.encode(text="text:N", y=alt.value(4)) for label in (early, late)]
