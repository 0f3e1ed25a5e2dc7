"""The library of empirical terms: products of up to two of what a session knows of each reading.

Of one sensor: a, |a|, sign a, p·n, o·n (as part of the applied vector), T − T̄, dT/dt, T late by some time, t − t̄, the
run (±1), the input of the row before, waves of β, and the squares of a, T − T̄ and t − t̄; and a⁵ and its like of even
order, which only strong effects distinguish from a³. Of the applied vector: δα and
δβ as waves of β, as courses of temperature and time, alike and opposite in the two runs. A wave has two amplitudes, and
so have its products. The catalogue's causes lie in the span, so that what is learned beside them is what the catalogue
lacks.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from estimator.causes.contract import Setting
from estimator.causes.lag import lagging
from estimator.causes.sensor import across
from estimator.causes.stand import harmonic
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.message import say
from estimator.session import Array

WAVES = 5
"""Highest harmonic of β in the library: what is kept with every session for the look at structure ends there too.

A session of few positions takes the fifth for the third. It is in the library all the same: other sessions tell."""


LAGS = (540.0, 1620.0)
"""s, of the grid of lags that the cause is pooled on: between them and the rate lies what follows within an hour."""


@dataclass(frozen=True, eq=False)
class Factor:
    """A factor of terms. R rows, w columns: 1, or 2 for a wave."""

    words: tuple[str, ...]
    """Name of every column, as in an equation."""
    unit: str
    """Empty where it has none."""
    values: Array
    """(R, w)"""


@dataclass(frozen=True, eq=False)
class LibraryTerm:
    """A candidate of the library in one session. R rows, m sensors, w amplitudes."""

    words: tuple[str, ...]
    """The factor of every column that its amplitude multiplies."""
    unit: str
    """Unit of the amplitudes."""
    variable: str
    """Variable over which it is drawn."""
    columns: Array
    """(R, m, w) m/s² (rad/s) per unit amplitude."""


def factors_of_sensor(setting: Setting, i: int, nominal: Array) -> Iterator[Factor]:
    """Every factor of sensor i; ``nominal`` (3,) its nominal axis, whose tangents p and o are."""
    g = setting.norm[i]
    a = setting.a[:, i] / g
    before = np.where(setting.first_of_run, 0.0, np.roll(a, 1))
    axes = setting.parameters.axis.copy()
    axes[i] = nominal
    p, o = across(replace(setting, parameters=replace(setting.parameters, axis=axes)), i)
    plain = {
        "a": a,
        "|a|": np.abs(a),
        "sign a": np.sign(a),
        "(p·n)": p / g,
        "(o·n)": o / g,
        "a before": before,
        "a²": a**2,
    }
    for words, values in plain.items():
        yield Factor((words,), "", values[:, None])
    yield from factors_of_session(setting)


def factors_of_session(setting: Setting) -> Iterator[Factor]:
    """Factors that are the same for all sensors."""
    if setting.has("temperature") and setting.temperature is not None:
        warm = (setting.temperature - setting.temperature.mean())[:, None]
        yield Factor(("(T − T̄)",), "K", warm)
        yield Factor(("(T − T̄)²",), "(K)²", warm**2)
        if setting.time is not None and bool(np.all(np.diff(setting.time) > 0)):
            yield Factor(("dT/dt",), "K/s", np.gradient(setting.temperature, setting.time)[:, None])
            for tau in LAGS:
                behind = lagging(setting.temperature, setting.time, tau)
                yield Factor((f"(T, τ = {tau:.0f} s)",), "K", (behind - behind.mean())[:, None])
    if setting.time is not None and float(np.ptp(setting.time)) > 0:
        late = (setting.time - setting.time.mean())[:, None]
        yield Factor(("(t − t̄)",), "s", late)
        yield Factor(("(t − t̄)²",), "(s)²", late**2)
    if setting.flipped is not None and setting.has("both runs"):
        yield Factor(("run",), "", np.where(setting.flipped, -1.0, 1.0)[:, None])
    if setting.beta is not None:
        for k in range(1, WAVES + 1):
            turns = "β" if k == 1 else f"{k}β"
            yield Factor((f"sin {turns}", f"cos {turns}"), "", harmonic(setting, k))


def products(factors: list[Factor]) -> Iterator[Factor]:
    """The factors, their squares where those are something else, and products of two; of waves only with others."""
    yield from factors
    known = {f.words[0] for f in factors}
    for f in factors:
        square = f.words[0].replace("²", "⁴") if "²" in f.words[0] else f"{f.words[0]}²"
        if len(f.words) == 1 and f.words[0] not in ("|a|", "sign a", "run") and square not in known:
            yield Factor((square,), f"({f.unit})²" if f.unit else "", f.values**2)
    for f, g in combinations(factors, 2):
        if len(f.words) == 2 and len(g.words) == 2:
            continue
        words = tuple(f"{x}·{y}" for x in f.words for y in g.words)
        unit = "·".join(u for u in (f.unit, g.unit) if u)
        yield Factor(words, unit, (f.values[:, :, None] * g.values[:, None, :]).reshape(len(f.values), -1))


def high_powers(a: Array) -> Iterator[Factor]:
    """Odd powers of the input ``a`` (R,), as part of the applied vector, beyond those of two factors."""
    yield Factor(("a⁵",), "", a[:, None] ** 5)
    yield Factor(("sign a·a⁴",), "", (np.sign(a) * a**4)[:, None])


def library(baseline: Baseline, sensor: str) -> list[LibraryTerm]:
    """Every term of a sensor by its name, or with an empty name of the applied vector, in one session."""
    setting, names = baseline.setting, [s.name for s in baseline.session.sensors]
    if not sensor:
        return list(_of_vector(setting))
    i = names.index(sensor)
    unit = "m/s²" if setting.kinds[i] == "accelerometer" else "rad/s"
    terms = []
    factors = list(factors_of_sensor(setting, i, baseline.session.sensors[i].nominal_axis))
    for f in (*products(factors), *high_powers(setting.a[:, i] / setting.norm[i])):
        columns = np.zeros((setting.rows, len(names), len(f.words)))
        columns[:, i, :] = f.values
        terms.append(LibraryTerm(f.words, f"{unit}/({f.unit})" if f.unit else unit, variable_of(f), columns))
    return terms


def _of_vector(setting: Setting) -> Iterator[LibraryTerm]:
    """Courses of the head's angles."""
    if setting.d_alpha is None or setting.d_beta is None:
        return
    for name, turn in (("δα", setting.d_alpha), ("δβ", setting.d_beta)):
        for f in products(list(factors_of_session(setting))):
            change = turn[..., None] * f.values[:, None, None, :]
            unit = f"rad/({f.unit})" if f.unit else "rad"
            yield LibraryTerm(
                tuple(say("{name}: {term}", name=name, term=w) for w in f.words),
                unit,
                variable_of(f),
                setting.through(change),
            )


def variable_of(factor: Factor) -> str:
    """The variable over which a term is drawn: β where it holds a wave, else its first factor."""
    return "β" if "β" in factor.words[0] else factor.words[0].split("·")[0].strip("²⁴⁵")
