"""Measured minus simulated before and after, as a small PNG."""

from pathlib import Path
from typing import Any

import altair as alt
import numpy as np

from estimator.diagnosis.results import Diagnosis
from estimator.results import Residuals
from estimator.session import ACCELEROMETER, CalibrationSession

MOST = 6
"""Panels."""
WIDTH, HEIGHT = 210, 110
COLOURS = {"before": "#9aa3ad", "after": "#0b63b6"}
UNITS = {True: ("mg", 1e3 / 9.80665), False: ("°/h", np.degrees(3600.0))}


def chosen(session: CalibrationSession, diagnosis: Diagnosis) -> list[int]:
    """The sensors drawn: those named first, then those that miss most."""
    names = [s.name for s in session.sensors]
    spoken = [n for named in (diagnosis.findings, diagnosis.structures) for part in named for n in part.sensors]
    ratio = np.nan_to_num(diagnosis.baseline.residuals.value / diagnosis.baseline.residuals.sigma)
    worst = [names[i] for i in np.argsort(-(ratio**2).sum(axis=0))]
    return [names.index(n) for n in dict.fromkeys([*spoken, *worst])][:MOST]


def points(session: CalibrationSession, diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """A line a sensor, row and model."""
    sides: dict[str, Residuals] = {"before": diagnosis.baseline.residuals, "after": diagnosis.calibration.residuals}
    time = session.time
    across = np.arange(1.0, len(session.readings) + 1) if time is None else time / 60
    found = []
    for i in chosen(session, diagnosis):
        sensor = session.sensors[i]
        label, factor = UNITS[sensor.kind == ACCELEROMETER]
        found += [
            {"sensor": f"{sensor.name}, {label}", "x": float(x), "y": float(y * factor), "model": model}
            for model, side in sides.items()
            for x, y in zip(across, side.value[:, i], strict=True)
        ]
    return found


def draw(session: CalibrationSession, diagnosis: Diagnosis, path: Path) -> None:
    """Write the picture."""
    order = [
        f"{session.sensors[i].name}, {UNITS[session.sensors[i].kind == ACCELEROMETER][0]}"
        for i in chosen(session, diagnosis)
    ]
    base = alt.Chart(alt.InlineData(values=points(session, diagnosis)))
    marks = base.mark_point(filled=True, size=16, opacity=0.9).encode(
        x=alt.X("x:Q", title="position" if session.time is None else "minutes", scale=alt.Scale(zero=False)),
        y=alt.Y("y:Q", title=None, axis=alt.Axis(tickCount=4)),
        color=alt.Color(
            "model:N", title="measured − simulated", scale=alt.Scale(domain=list(COLOURS), range=list(COLOURS.values()))
        ),
    )
    chart = marks.properties(width=WIDTH, height=HEIGHT).facet(
        facet=alt.Facet("sensor:N", title=None, sort=order), columns=3
    )
    chart = chart.resolve_scale(y="independent").configure_legend(orient="bottom")
    path.parent.mkdir(parents=True, exist_ok=True)
    chart.save(str(path), format="png", scale_factor=1.0)
