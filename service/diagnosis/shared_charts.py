"""The course that several sensors share, with what all of them together read."""

import numpy as np

from estimator.diagnosis.results import Shared
from estimator.json_object import Json
from estimator.message import say
from estimator.results import Residuals
from service.kit.libraries import alt
from service.kit.measures import COVERAGE, THIN, decimals, deviation_measure, number
from service.sessions.charts import (
    DATA_FORM,
    HEIGHT,
    Across,
    ChartSet,
    Panel,
    hints,
    in_order,
    padded,
    specification,
    ticks,
)


def shared_chart(shared: Shared, kind: str, residuals: Residuals, name: str) -> ChartSet:
    """One panel: the course as the sensor that shows it most has it, of a ``kind``, and the others scaled onto it."""
    time = residuals.time
    across = in_order(residuals) if time is None else Across("time", "By time", "h", np.asarray(time) / 3600)
    course, measured, band = (np.array(x) for x in (shared.course, shared.measured, shared.band))
    reach = float(np.max(np.abs(np.concatenate([course, measured])) + COVERAGE * np.concatenate([band, band])))
    measure = deviation_measure(kind, "bias", reach)
    swing = float(np.ptp(course)) * measure.factor
    points = [
        {
            "x": float(f"{across.values[row]:.6g}"),
            "y": float(f"{measured[row] * measure.factor:.5g}"),
            "course": float(f"{course[row] * measure.factor:.5g}"),
            "low": float(f"{(measured[row] - COVERAGE * band[row]) * measure.factor:.5g}"),
            "high": float(f"{(measured[row] + COVERAGE * band[row]) * measure.factor:.5g}"),
            "row": row + 1,
        }
        for row in range(min(len(course), len(across.values)))
    ]
    return ChartSet(
        name=name,
        heading=across.heading,
        spec=_spec(across, measure.label, reach * measure.factor),
        panels=(
            Panel(
                title=shared.drawn_for,
                description=say(
                    "moves by {swing} in the session",
                    swing=f"{number(swing, decimals(swing / 10))}{THIN}{measure.label}",
                ),
                datasets={DATA_FORM: points},
            ),
        ),
    )


def _spec(across: Across, unit: str, reach: float) -> Json:
    domain = padded(float(np.min(across.values)), float(np.max(across.values)))
    scale = alt.Scale(domain=domain, nice=False, zero=False)
    x = alt.X("x:Q", title=across.title, axis=alt.Axis(**ticks(across.name)), scale=scale)
    y_scale = alt.Scale(domain=padded(-reach, reach))
    base = alt.Chart(alt.NamedData(name=DATA_FORM)).encode(x=x)
    band = base.mark_area(color="var(--muted)", opacity=0.2).encode(y=alt.Y("low:Q", scale=y_scale), y2="high:Q")
    line = base.mark_line(color="var(--accent)").encode(y=alt.Y("course:Q", scale=y_scale))
    marks = base.mark_point(color="var(--second)", filled=True, opacity=1, size=30).encode(
        y=alt.Y("y:Q", title=unit, axis=alt.Axis(tickCount=5), scale=y_scale),
        tooltip=hints({"row:Q": "row", "y:Q": say("all sensors together, {unit}", unit=unit)}),
    )
    return specification([band, line, marks], HEIGHT)
