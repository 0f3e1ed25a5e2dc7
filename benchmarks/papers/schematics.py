"""Figures 1 and 2 of the analytic alignment paper, drawn from our own geometry: the stand, and the block on it."""

from dataclasses import dataclass
from pathlib import Path

import altair as alt
import numpy as np
import vl_convert
from scipy.spatial.transform import Rotation

from benchmarks.papers.published import AXES
from estimator.applied_vector import stand_vector
from estimator.session import Array

FOLDER = Path(__file__).parents[2] / "docs" / "pictures"
ALPHA = np.radians(40.0)
TO_LEVEL = np.asarray(Rotation.from_euler("x", ALPHA).as_matrix())
"""Platform axes, raised by α about X, in level axes."""
PAPER_BLOCK = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], dtype=float)
"""(10): platform axes in block axes."""
EYE = np.array([0.92, 0.22, 0.5])
"""Direction from which the drawing is seen."""
RIGHT = np.array([-EYE[1], EYE[0], 0.0]) / np.hypot(EYE[0], EYE[1])
LOOK = np.stack([RIGHT, np.cross(EYE, RIGHT) / np.linalg.norm(EYE), EYE / np.linalg.norm(EYE)])
"""Level axes → right, up, towards the reader."""
LEVEL, PLATFORM, BLOCK, APPLIED, SENSOR = "level (И)", "platform (П)", "block (О)", "applied", "input axes"
COLOURS = {LEVEL: "#888888", PLATFORM: "#2c6fbb", BLOCK: "#b8860b", APPLIED: "#c0392b", SENSOR: "#3a8f5c"}


@dataclass(frozen=True, eq=False)
class Line:
    """A line of the drawing, with a label at its end."""

    of: str
    points: Array
    """(k, 3) level axes."""
    label: str = ""


def arrow(of: str, tip: Array, label: str, tail: Array | float = 0.0) -> list[Line]:
    """A line from the origin with its head."""
    tail = np.zeros(3) + tail
    flat = LOOK @ (tip - tail)
    along = flat[:2] / max(float(np.hypot(*flat[:2])), 1e-9)
    barbs = [
        LOOK.T @ [*(-0.06 * (Rotation.from_euler("z", s * 0.4).as_matrix()[:2, :2] @ along)), 0.0] for s in (-1, 1)
    ]
    return [Line(of, np.array([tail, tip]), label), Line(of, np.array([tip + barbs[0], tip, tip + barbs[1]]))]


def arc(of: str, first: Array, second: Array, part: float, radius: float, label: str) -> list[Line]:
    """A part of the way from one direction to another, orthogonal one."""
    turn = part * np.linspace(0, 1, 24)
    points = radius * (np.cos(turn)[:, None] * first + np.sin(turn)[:, None] * second)
    return [Line(of, points), Line(of, np.array([1.22 * points[12]] * 2), label)]


def stand() -> list[Line]:
    """Figure 1: the level frame, the platform raised by α, a turn β, and what is applied at rest."""
    x, y, z = np.eye(3)
    px, py, pz = TO_LEVEL.T
    up = TO_LEVEL @ stand_vector(ALPHA, np.zeros(1))[0]
    return [
        *arrow(LEVEL, x, ""), *arrow(LEVEL, y, "Y_И"), *arrow(LEVEL, 1.25 * z, "Z_И"),
        *arrow(PLATFORM, 1.25 * px, "X_И0, X_П0"),
        *arrow(PLATFORM, 1.15 * py, "Y_П"), *arrow(PLATFORM, 1.15 * pz, "Z_П"),
        *arrow(APPLIED, 0.85 * up, "n = −g"),
        *arc(LEVEL, y, z, ALPHA, 0.6, "α"),
        *arc(PLATFORM, pz, px, np.radians(60), 0.45, "β"),
    ]  # fmt: skip


def block() -> list[Line]:
    """Figure 2: the block in its fixture, and the six input axes of the cone."""
    lines = []
    for row, name in zip(PAPER_BLOCK, "XYZ", strict=True):
        lines += arrow(BLOCK, 1.35 * TO_LEVEL @ row, f"{name}_О")
    for tip, name in zip(TO_LEVEL.T, "XYZ", strict=True):
        lines += arrow(PLATFORM, 1.05 * tip, f"{name}_П")
    for i, axis in enumerate(AXES):
        lines += arrow(SENSOR, 0.9 * TO_LEVEL @ axis, f"e{i + 1}")
    return lines


def draw() -> None:
    """Write both drawings."""
    for name, lines in (("stand-figure-1.png", stand()), ("stand-figure-2.png", block())):
        (FOLDER / name).write_bytes(picture(lines))


def picture(lines: list[Line]) -> bytes:
    """The drawing as PNG."""
    points, labels = [], []
    for number, line in enumerate(lines):
        flat = line.points @ LOOK.T
        points += [{"of": line.of, "line": number, "step": k, "x": p[0], "y": p[1]} for k, p in enumerate(flat)]
        if line.label:
            end = flat[-1] * (1 + 0.09 / max(float(np.hypot(*flat[-1][:2])), 0.2))
            labels.append({"of": line.of, "x": end[0], "y": end[1], "label": line.label})
    used = [of for of in COLOURS if any(line.of == of for line in lines)]
    x = alt.X("x:Q", axis=None, scale=alt.Scale(domain=[-1.3, 1.3]))
    y = alt.Y("y:Q", axis=None, scale=alt.Scale(domain=[-0.8, 1.4]))
    colour = alt.Color("of:N", title=None, scale=alt.Scale(domain=used, range=[COLOURS[of] for of in used]))
    drawn = alt.Chart(alt.Data(values=points)).mark_line(strokeWidth=2)
    named = alt.Chart(alt.Data(values=labels)).mark_text(fontSize=14)
    chart = (
        drawn.encode(x=x, y=y, color=colour, detail="line:N", order="step:Q")
        + named.encode(x=x, y=y, color=colour, text="label:N")
    ).properties(width=429, height=363)
    return vl_convert.vegalite_to_png(chart.configure_view(stroke=None).to_dict(), scale=1.4)
