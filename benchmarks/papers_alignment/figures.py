"""Figures 1 and 2 of the paper: the estimates of φ and ∇ through an alignment with unmodelled mounting errors."""

from pathlib import Path
from typing import Any

import altair as alt
import numpy as np
import vl_convert

from benchmarks.papers_alignment.runs import Errors, G
from estimator.results import ARCSEC
from estimator.session import Array

FOLDER = Path(__file__).parents[2] / "docs" / "pictures"
PUBLISHED, TEN, TURNTABLE = "end value in print", "ten states, as published", "with E_xz, E_yz and the turntable"
COLOURS = ["#888888", "#c0392b", "#2c6fbb"]
MICRO = 1e6


def draw(ten: Errors, turntable: Errors) -> None:
    """Write both figures as PNG."""
    tilt = {"φ_E": 0, "φ_N": 1}
    curves = [
        *_curves(TEN, ten, ten.phi / ARCSEC, tilt),
        *_curves(TURNTABLE, turntable, turntable.phi / ARCSEC, tilt),
        *_ends(ten.time, {"φ_E": -8.0, "φ_N": 4.0}),
    ]
    _write("alignment-figure-1.png", curves, "error of the estimate, ″", (-22.0, 22.0))
    zero = {"∇_x": 0, "∇_y": 1}
    curves = [
        *_curves(TEN, ten, ten.nabla / G * MICRO, zero),
        *_curves(TURNTABLE, turntable, turntable.nabla / G * MICRO, zero),
        *_ends(ten.time, {"∇_x": -20.0, "∇_y": -40.0}),
    ]
    _write("alignment-figure-2.png", curves, "error of the estimate, µg", (-110.0, 110.0))


def _curves(model: str, found: Errors, values: Array, names: dict[str, int]) -> list[dict[str, Any]]:
    """Every third second. While the table turns, E is free until the stop shows it: the curve pauses."""
    picked = np.arange(2, len(values), 3)
    paused = found.turning & (model == TURNTABLE)
    return [
        {"t": float(found.time[k]), "y": None if paused[k] else float(values[k, column]), "of": name, "model": model}
        for name, column in names.items()
        for k in picked
    ]


def _ends(time: Array, values: dict[str, float]) -> list[dict[str, Any]]:
    return [
        {"t": t, "y": y, "of": name, "model": PUBLISHED} for name, y in values.items() for t in (0.0, float(time[-1]))
    ]


def _write(name: str, curves: list[dict[str, Any]], title: str, span: tuple[float, float]) -> None:
    models = [PUBLISHED, TEN, TURNTABLE]
    chart = (
        alt.Chart(alt.InlineData(values=curves))
        .mark_line(clip=True, strokeWidth=1.6)
        .encode(
            x=alt.X("t:Q", title="time, s"),
            y=alt.Y("y:Q", title=title, scale=alt.Scale(domain=list(span))),
            color=alt.Color(
                "model:N",
                title=None,
                scale=alt.Scale(domain=models, range=COLOURS),
                legend=alt.Legend(orient="top", labelLimit=300),
            ),
            strokeDash=alt.StrokeDash(
                "model:N", legend=None, scale=alt.Scale(domain=models, range=[[4, 3], [1, 0], [1, 0]])
            ),
            column=alt.Column("of:N", title=None, header=alt.Header(labelFontSize=13)),
        )
        .properties(width=330, height=220)
    )
    picture = vl_convert.vegalite_to_png(chart.to_dict(), scale=1.4)
    (FOLDER / name).write_bytes(picture)
