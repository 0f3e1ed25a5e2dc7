"""The papers' tables are reproduced, and the page of them is what the command prints."""

import re

import numpy as np
import pytest

from benchmarks.details import RESULTS
from benchmarks.papers.__main__ import PAGES
from benchmarks.papers.analytic import PLACES
from benchmarks.papers.formulas import instrument_only
from benchmarks.papers.markdown import table
from benchmarks.papers.planning import conditionings, orientation_sets
from benchmarks.papers.printed import checked
from benchmarks.papers.published import ACCELEROMETERS, AXES, GYROS, Published
from benchmarks.papers.schematics import stand
from benchmarks.papers.tables import by_half_sums, fitted_noise, sessions, two_sigma
from estimator.planning import optimal_elevation

PAGE = (RESULTS / "papers.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("paper", "row", "ratios"),
    [
        (ACCELEROMETERS, 0, (1.15, 0.87, 1.0)),
        (ACCELEROMETERS, 1, (1.10, 0.86, 1.0)),
        (ACCELEROMETERS, 2, (2.35, 1.76, 1.98)),
        (GYROS, 0, (0.97, 1.76, 5.1)),
        (GYROS, 2, (1.96, 3.65, 10.6)),
    ],
)
def test_simulated_over_printed(paper: Published, row: int, ratios: tuple[float, float, float]) -> None:
    N, *stated = paper.rows[row]
    found = two_sigma(by_half_sums(sessions(paper, N, fitted_noise(paper, checked), 100), paper), paper)
    assert found / stated == pytest.approx(ratios, rel=0.08)


def test_the_simulation_with_pulses_and_stand_agrees_with_the_propagation() -> None:
    drawn = by_half_sums(sessions(GYROS, 24, 0.0, 200), GYROS)
    expected = checked(AXES, GYROS.at(24, 0.0))
    for name in ("scale", "bias", "axis"):
        assert getattr(drawn, name).mean() == pytest.approx(getattr(expected, name).mean(), rel=0.1)


def test_the_gyros_elevation_follows_from_31() -> None:
    assert np.degrees(optimal_elevation(GYROS.conditions.stand, 24)) == pytest.approx(39.0, abs=0.1)


@pytest.mark.parametrize(
    "printed",
    [
        conditionings,
        orientation_sets,
        lambda: table(("3σ, N = 12", "stated", "(28)–(30) as printed", "checked"), instrument_only()),
    ],
    ids=["conditioning", "orientations", "instrument"],
)
def test_the_page_holds_what_the_command_prints(printed: object) -> None:
    assert printed() in PAGE  # type: ignore[operator]


@pytest.mark.parametrize("name", PAGES)
def test_every_page_says_by_which_one_command_it_is_written(name: str) -> None:
    text = (RESULTS / name).read_text(encoding="utf-8")
    assert "`make papers` (`python -m benchmarks.papers`)" in " ".join(text.split())


def test_the_overview_leads_to_every_table_and_figure() -> None:
    for _, _, where, _ in PLACES:
        assert where in PAGE
    for name, anchor in re.findall(r"\((papers[\w-]*\.md)?#([\w-]+)\)", PAGE):
        headings = re.findall(r"^## (.+)$", (RESULTS / (name or "papers.md")).read_text(encoding="utf-8"), re.M)
        assert anchor in {re.sub(r"[^\w -]", "", h.lower()).replace(" ", "-") for h in headings}


def test_the_stand_is_drawn_as_it_is_computed() -> None:
    lines = {line.label: line.points for line in stand() if line.label}
    assert lines["n = −g"][1] == pytest.approx([0, 0, 0.85], abs=1e-12)
    up = lines["Y_П"][1] / np.linalg.norm(lines["Y_П"][1])
    assert np.degrees(np.arcsin(up[2])) == pytest.approx(40.0)
