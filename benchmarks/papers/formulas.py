"""The printed accuracy formulas (28)–(30) and the checked ones, both against Monte Carlo, source by source."""

from dataclasses import replace

import numpy as np

from benchmarks.papers.half_sums import simulated
from benchmarks.papers.markdown import section, table
from benchmarks.papers.printed import Accuracy, Conditions, checked, printed
from benchmarks.papers.published import ACCELEROMETERS, AXES, STAND
from estimator.results import ARCSEC
from estimator.session import StandErrors

TRIALS = 20_000
G = ACCELEROMETERS.conditions.magnitude
PERFECT = Conditions(np.radians(40.0), 12, G, 0.0, 0.0, StandErrors())
SOURCES = (
    ("reading noise 3e-5 g", replace(PERFECT, noise=3e-5 * G)),
    ("variation of the zero 3e-5 g", replace(PERFECT, bias_variation=3e-5 * G)),
    ("δβ 20″", replace(PERFECT, stand=StandErrors(beta=20 * ARCSEC))),
    ("θ_x + δα 20″", replace(PERFECT, stand=StandErrors(alpha=20 * ARCSEC))),
    ("θ_y 20″", replace(PERFECT, stand=StandErrors(theta_y=20 * ARCSEC))),
)
FACTORS = (("scale", 1e6, "ppm"), ("bias", 1e6 / G, "µg"), ("axis", 1 / ARCSEC, "″"))


def sigma(a: Accuracy, parameter: str, factor: float) -> float:
    """Root mean square over the cone's sensors, people's units."""
    return float(np.sqrt(getattr(a, parameter).mean())) * factor


def compared(trials: int = TRIALS) -> list[tuple[object, ...]]:
    """One row a source and parameter: simulated, checked, printed, and their ratios."""
    rows: list[tuple[object, ...]] = []
    for name, conditions in SOURCES:
        happened, true, theirs = (
            simulated(AXES, conditions, trials, 0),
            checked(AXES, conditions),
            printed(AXES, conditions),
        )
        for parameter, factor, unit in FACTORS:
            mc, ours, print_ = (sigma(a, parameter, factor) for a in (happened, true, theirs))
            if max(mc, ours, print_) < 0.01:
                continue
            ratio = f"{print_ / mc:.2f}" if mc > 0.01 * max(ours, print_) else "∞"
            agreed = f"{ours / mc:.2f}" if ours > 0 else "–"
            rows.append((name, f"{parameter}, {unit}", f"{mc:.3g}", f"{ours:.3g}", agreed, f"{print_:.3g}", ratio))
    return rows


def instrument_only() -> list[tuple[object, ...]]:
    """The paper's 3σ from the instrument alone at N = 12, as stated, by the printed formulas, by the checked ones."""
    c = replace(PERFECT, stand=STAND)
    rows: list[tuple[object, ...]] = []
    stated = {"scale": "3e-4 %", "bias": "1.5e-5 g", "axis": "4″"}
    for parameter, factor, unit in (("bias", 1 / G, "g"), ("scale", 100.0, "%"), ("axis", 1 / ARCSEC, "″")):
        figures = (3 * sigma(f(AXES, c), parameter, factor) for f in (printed, checked))
        rows.append((parameter, stated[parameter], *(f"{x:.2g} {unit}" for x in figures)))
    return rows


WORDS = """One sigma, root mean square over the six sensors of the cone, N = 12, α = 40°; the estimator is that of
(22)–(24) with c = 0. *Checked* is the propagation at the head of `benchmarks/papers/printed.py`."""

AGREED = """The checked formulas agree with simulation to 1 %; those in print are 0.93 to 2.65 times as large, leave
out the variation of the zero in scale and axis, and give 21″ of axis error for a θ_y of 20″ where there is none."""

INSTRUMENT = """The text's bias is ten times what (28) gives. Its scale is that of the checked formula, so the paper
did not compute with what it printed."""


def formulas(trials: int = TRIALS) -> str:
    """Both sections on the formulas, as markdown."""
    columns = ("source", "", f"{trials} simulated", "checked", "checked / simulated", "printed", "printed / simulated")
    details = f"{WORDS}\n\n{table(columns, compared(trials))}"
    first = section("Formulas (28)–(30), source by source", details, AGREED)
    stated = ("3σ, N = 12", "stated", "(28)–(30) as printed", "checked")
    return "\n\n".join((first, section("The instrument alone", table(stated, instrument_only()), INSTRUMENT)))
