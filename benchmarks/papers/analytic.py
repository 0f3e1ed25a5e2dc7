"""papers.md: every table and figure of the papers and where ours stands, then the analytic alignment paper."""

from benchmarks.papers.formulas import formulas
from benchmarks.papers.markdown import section, table
from benchmarks.papers.planning import planning
from benchmarks.papers.tables import tables

HEAD = """# The papers' tables beside ours

Written, with every figure, by `make papers` (`python -m benchmarks.papers`); errors of the print:
[errata](../../docs/errata.md)."""

PLACES = (
    ("Tyuvin", "table 1", "[accelerometers](#table-1-accelerometers)", "rows 12 and 24 to 15 %; row 36 is one sigma"),
    (
        "Tyuvin",
        "table 2",
        "[gyros](#table-2-gyros)",
        "the drift; scale and axis cannot be reached as stated",
    ),
    (
        "Tyuvin",
        "(28)–(31)",
        "[source by source](#formulas-2830-source-by-source)",
        "misprinted in seven places; the checked forms agree with simulation",
    ),
    (
        "Tyuvin",
        "(6), ρ over α",
        "[elevation](#elevation-of-the-head), [conditioning](#conditioning)",
        "yes; 40° and 39°",
    ),
    ("Tyuvin", "figures 1 and 2", "[the stand, the block](#the-stand-and-the-block)", "drawn from our own geometry"),
    (
        "Liu",
        "figures 1 and 2",
        "[alignment](papers-alignment.md#figures-1-and-2)",
        "end values to the rounding of the print",
    ),
    ("Liu", "(5)", "[equation (5)](papers-alignment.md#equation-5)", "yes, to 0.001″"),
    (
        "Kutovoy",
        "iterations, functional, accuracy",
        "[optimisation](papers-optimisation.md)",
        "inside the range that the orientations span",
    ),
    (
        "Kutovoy",
        "nine orientations, 1° of error",
        "[optimisation](papers-optimisation.md#which-sets-determine-everything)",
        "yes, if they do not stay in two planes",
    ),
)

SOURCE = """## Analytic alignment on a two-axis stand

A. V. Tyuvin, analytic alignment and calibration of the inertial measurement unit of a strapdown inertial navigation
system; six sensors in a cone of 54.7° about the head's axis (e2² = 1/3), α = 40°, δα, δβ = 3″, θ_x, θ_y = 1″ (3σ)."""

FIGURES = """The paper's figure 1: the platform's Y axis is the head's, raised by α above the horizon; the turn β is
about it.

![Level and platform axes](../../docs/pictures/stand-figure-1.png)

Figure 2: (10) takes platform axes to block axes, and the six input axes lie on a cone about Y_П.

![Platform and block axes with the six input axes](../../docs/pictures/stand-figure-2.png)"""


def page() -> str:
    """The whole page."""
    places = table(("paper", "what is printed", "ours", "reproduced"), PLACES)
    drawings = section("The stand and the block", FIGURES)
    return "\n\n".join((HEAD, places, SOURCE, tables(), formulas(), planning(), drawings)) + "\n"
