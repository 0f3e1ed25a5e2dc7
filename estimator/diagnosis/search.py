"""The search for causes: one after another, each weighed against all others, confirmed together.

Rules: the family-wise level is held over the whole catalogue (Bonferroni over causes and over the places and shapes
of each); a cause found later may change what was named earlier, so every finding is chosen anew given the others
until nothing changes; what causes leave is searched for structure, and a name that structure explains better is
withdrawn.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from scipy.special import chdtrc

from estimator.causes import CATALOGUE, Cause, Signature
from estimator.diagnosis.baseline import Baseline
from estimator.diagnosis.between import between_sessions
from estimator.diagnosis.candidates import Scored, Traces, ranked, rescored, score, traces_of
from estimator.diagnosis.evidence import Between, Evidence
from estimator.diagnosis.serial import Serial, serial_structure
from estimator.diagnosis.structures import STRUCTURES
from estimator.session import Array

LEVEL = 0.005
"""Family-wise level: sessions without an effect that get a name; half of what is allowed, for safety."""

DECISIVE = 4.0
"""ln evidence by which a signature must beat mere excess noise to be believed without a look at the scatter."""

NAMELESS = 1.5
"""ln evidence by which structure without a name must beat the named causes."""

DOUBT = 0.05
"""Level at which a scatter that seems too large is taken for uneven rather than for mere noise."""

AGAIN = frozenset({"reading-outlier", "bias-jump"})
"""Causes that may happen to one sensor more than once."""

DRIFT = "sensor-drift"

MOST = 8
"""Different causes (and, apart from them, patterns) looked for in one session, each on as many sensors as show it."""


@dataclass(frozen=True, eq=False)
class Found:
    """One selected signature with its rivals."""

    best: Scored
    p_family: float
    ranking: tuple[tuple[Scored, float], ...]
    """Every (cause, sensors) with its ln evidence, strongest first, given the other findings."""

    def ranking_of(self, scored: Scored) -> tuple[tuple[Scored, float], ...]:
        """The ranking as another sensor sees it: its own causes and those of no sensor."""
        return tuple(pair for pair in self.ranking if pair[0].shape.sensors in ((), scored.shape.sensors))


@dataclass(frozen=True)
class Excess:
    """A sensor noisier than stated."""

    sensor: int
    ratio: float
    """Variance over the stated one."""
    freedom: float
    evidence: float
    p_family: float


@dataclass(frozen=True, eq=False)
class Search:
    """Where the search stands, and at its end what was found."""

    baseline: Baseline
    history: tuple[Baseline, ...]
    catalogue: tuple[Cause, ...]
    evidence: Evidence
    traces: tuple[Traces, ...]
    patterns: tuple[Traces, ...]
    found: tuple[Found, ...] = ()
    structures: tuple[Found, ...] = ()
    excess: tuple[Excess, ...] = ()
    serial: tuple[Serial, ...] = ()
    """Sensors whose left-over is not white, though no pattern fits it."""

    @property
    def between(self) -> Between | None:
        return self.evidence.between

    @property
    def spoken_for(self) -> set[int]:
        """Sensors whose scatter is already known to be excess noise or uneven."""
        return {e.sensor for e in self.excess} | {s.sensor for s in self.serial}

    @property
    def left(self) -> Array:
        """(n,) what findings and structures leave."""
        taken = self.taken()
        return np.asarray(self.evidence.z - taken @ (taken.T @ self.evidence.z))

    @property
    def families(self) -> int:
        """Number of causes that this session puts to the test."""
        return len(self.traces) + 1

    def taken(self, without: Found | None = None) -> Array:
        """(n, f) orthonormal traces of the findings and structures, one left out."""
        parts = [f.best.columns for f in (*self.found, *self.structures) if f is not without]
        if not parts:
            return np.zeros((len(self.evidence.z), 0))
        columns = np.concatenate(parts, axis=1)
        norms = np.linalg.norm(columns, axis=0)
        left, size, _ = np.linalg.svd(columns[:, norms > 0] / norms[norms > 0], full_matrices=False)
        return left[:, size > 1e-6 * size[0]]


def begin(baseline: Baseline, history: Sequence[Baseline], catalogue: Sequence[Cause] = CATALOGUE) -> Search:
    """A search with nothing found yet."""
    evidence = Evidence.of(baseline, between_sessions(baseline, history))
    signatures = [c for c in catalogue if isinstance(c, Signature)]
    return Search(
        baseline,
        tuple(history),
        tuple(catalogue),
        evidence,
        tuple(traces_of(evidence, signatures)),
        tuple(traces_of(evidence, STRUCTURES)),
    )


def search(start: Search) -> Search:
    """Causes, then what they leave."""
    state = best_pair(without_needless_drift(settle(causes(start))))
    return unevenness(judge_structures(structures(state)))


def causes(state: Search) -> Search:
    """Add causes until none is significant."""
    while len({f.best.cause.identifier for f in state.found}) < MOST:
        noisy = noisiest(state)
        best = strongest(state, state.traces)
        if noisy is not None and (best is None or noisy.evidence > best.ranking[0][1] - DECISIVE):
            wary = with_unknown_noise(state, noisy.sensor)
            best = strongest(wary, wary.traces)
            if best is None and strongest(wary, wary.patterns) is None:
                uneven = serial_of(state, noisy.sensor)
                known = with_excess(state, noisy) if uneven is None else replace(state, serial=(*state.serial, uneven))
                state = known
                continue
        if best is None:
            break
        found = (*state.found, best, *companions(state, best, state.traces))
        if repeated(found):
            break
        state = replace(state, found=found)
    return state


def repeated(found: Sequence[Found]) -> bool:
    """Whether a cause that can act on a sensor only once was named on it twice: then it is not that cause."""
    once = [f.best.group for f in found if f.best.cause.identifier not in AGAIN]
    return len(once) != len(set(once))


def with_unknown_noise(state: Search, sensor: int) -> Search:
    """The search that does not believe one sensor's stated noise: its signatures must stand out of its own scatter."""
    unstated = state.baseline.unstated.copy()
    unstated[sensor] = True
    baseline = replace(state.baseline, unstated=unstated)
    return replace(state, baseline=baseline, evidence=replace(state.evidence, baseline=baseline))


def companions(state: Search, best: Found, traces: Sequence[Traces]) -> list[Found]:
    """The same cause on other sensors, where it is significant and leads that sensor's own ranking."""
    leads: dict[tuple[int, ...], Scored] = {}
    for scored, _ in best.ranking:
        leads.setdefault(scored.shape.sensors, scored)
    same = [s for sensors, s in leads.items() if sensors and sensors != best.best.shape.sensors]
    same = [s for s in same if s.cause is best.best.cause]
    families = state.families if traces is state.traces else len(traces)
    levels = [(s, min(1.0, s.p_value * s.places * families)) for s in same]
    return [Found(s, level, best.ranking_of(s)) for s, level in levels if level < LEVEL]


def strongest(state: Search, traces: Sequence[Traces], without: Found | None = None) -> Found | None:
    """The signature with the strongest evidence given the other findings; None if it is not significant."""
    order = ranked(score(state.evidence, traces, state.taken(without)))
    families = state.families if traces is state.traces else len(traces)
    for best, _ in order[:3]:
        p_family = min(1.0, best.p_value * best.places * max(families, 1))
        if p_family < LEVEL:
            return Found(best, p_family, tuple(order))
    return None


def serial_of(state: Search, sensor: int) -> Serial | None:
    """Whether one sensor's left-over runs smoothly along some order of its rows."""
    return serial_structure(state.evidence, state.left, sensor, DOUBT)


def unevenness(state: Search) -> Search:
    """Sensors whose left-over is not white after everything found."""
    m = len(state.baseline.unstated)
    open_sensors = [i for i in range(m) if i not in state.spoken_for]
    uneven = [serial_structure(state.evidence, state.left, i, LEVEL / m) for i in open_sensors]
    return replace(state, serial=(*state.serial, *(u for u in uneven if u is not None)))


def noisiest(state: Search) -> Excess | None:
    """The sensor whose left-over most exceeds its stated noise; None if none does significantly."""
    evidence = state.evidence
    z, taken = state.left, state.taken()
    owner, m = evidence.owner(), len(evidence.baseline.unstated)
    used = np.zeros(len(z))
    used[: evidence.readings] = (evidence.basis**2).sum(axis=1)
    used += (taken**2).sum(axis=1)
    best = None
    for i in range(m):
        if evidence.baseline.unstated[i] or i in state.spoken_for:
            continue
        rows = (owner == i) & (np.arange(len(z)) < evidence.readings)
        freedom = float((1 - used[rows]).sum()) * whiteness(evidence)
        energy = float((z[rows] ** 2).sum())
        if freedom < 2 or energy <= freedom:
            continue
        p_family = min(1.0, float(chdtrc(freedom, energy)) * m * state.families)
        weight = 0.5 * (energy - freedom - freedom * np.log(energy / freedom))
        value = float(weight - 0.5 * np.log(freedom / 2) - np.log(m))
        if p_family < LEVEL and (best is None or value > best.evidence):
            best = Excess(i, energy / freedom, freedom, value, p_family)
    return best


def whiteness(evidence: Evidence) -> float:
    """Share of the rows' energy that unknown directions leave to the noise."""
    removed = (1 - (1 - evidence.whiten.removed) ** 2).sum()
    return float(1 - removed / evidence.baseline.residual.size)


def with_excess(state: Search, noisy: Excess) -> Search:
    """The search begun anew with the noisy sensor's variance as it is, known from its own residuals alone."""
    variance, unstated = state.baseline.variance.copy(), state.baseline.unstated.copy()
    variance[:, noisy.sensor] *= noisy.ratio
    unstated[noisy.sensor] = True
    baseline = replace(state.baseline, variance=variance, unstated=unstated)
    again = begin(baseline, state.history, state.catalogue)
    return causes(replace(again, excess=(*state.excess, noisy), serial=state.serial))


def settle(state: Search) -> Search:
    """Choose every finding anew given the others, until nothing changes; drop what loses its significance."""
    for _ in range(4 if state.found else 0):
        groups = [f.best.group for f in state.found]
        for old in state.found:
            new = strongest(state, state.traces, without=old)
            kept = tuple(new if f is old else f for f in state.found)
            state = replace(state, found=tuple(f for f in kept if f is not None))
        state = causes(state)
        if [f.best.group for f in state.found] == groups:
            break
    return state


def without_needless_drift(state: Search) -> Search:
    """Take back a sensor's drift where another effect on that sensor, part of the history too, explains its move."""
    for drift in [f for f in state.found if f.best.cause.identifier == DRIFT]:
        sensors = drift.best.shape.sensors
        others = [f for f in state.found if f is not drift and f.best.shape.sensors == sensors]
        for other in others:
            rest = replace(state, found=tuple(f for f in state.found if f is not drift))
            again = strongest(rest, rest.traces, without=other)
            if again is None or again.best.cause.identifier == DRIFT:
                continue
            rival = replace(rest, found=tuple(again if f is other else f for f in rest.found))
            if total(rival) > total(state) - DECISIVE:
                state = rival
                break
    return state


def best_pair(state: Search) -> Search:
    """Two causes of stand or fixture chosen together: one after another, the first may patch up both."""
    common = [f for f in state.found if not f.best.shape.sensors]
    if len(common) != 2:
        return state
    others = replace(state, found=tuple(f for f in state.found if f not in common))
    scored = score(state.evidence, state.traces, others.taken())
    known = {f.best.group for f in common}
    best, weight = state, total(state)
    for first, second in combinations([s for s in scored if not s.shape.sensors], 2):
        if {first.group, second.group} == known or first.group == second.group:
            continue
        pair = tuple(Found(s, 0.0, ((s, s.evidence),)) for s in (first, second))
        rival = replace(others, found=(*others.found, *pair))
        if (value := total(rival)) > weight:
            best, weight = rival, value
    return best if best is state else settle(best)


def structures(state: Search) -> Search:
    """Patterns without a name in what the causes leave."""
    for _ in range(MOST):
        pattern = strongest(state, state.patterns)
        if pattern is None:
            break
        state = replace(state, structures=(*state.structures, pattern, *companions(state, pattern, state.patterns)))
    return state


def judge_structures(state: Search) -> Search:
    """Withdraw names when structure without them explains the session better.

    Tried for every name alone, for all names of one sensor together, for those of no sensor, and for all names.
    """
    for group in groups(state):
        if not all(f in state.found for f in group):
            continue
        kept = tuple(f for f in state.found if f not in group)
        rival = structures(replace(state, found=kept, structures=()))
        if rival.structures and total(rival) > total(state) + NAMELESS:
            state = rival
    return state


def groups(state: Search) -> list[tuple[Found, ...]]:
    """The sets of findings that structure may replace, the largest first."""
    by_sensor: dict[tuple[int, ...], list[Found]] = {}
    for f in state.found:
        by_sensor.setdefault(f.best.shape.sensors, []).append(f)
    sets = [state.found, *map(tuple, by_sensor.values()), *((f,) for f in state.found)]
    return list(dict.fromkeys(s for s in sets if s))


def total(state: Search) -> float:
    """ln evidence of everything found together, each weighed on what those before it leave."""
    weight, before = 0.0, replace(state, found=(), structures=())
    for member in (*state.found, *state.structures):
        weight += rescored(state.evidence, member.best, before.taken()).evidence
        before = replace(before, found=(*before.found, member))
    return weight
