"""Where a search for causes stands: the evidence, every signature that could explain it, and what was found so far.

The family-wise level is held over the whole catalogue: Bonferroni over causes, and over the places and shapes of each.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.causes import CATALOGUE, Cause, Signature
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.between_sessions import between_sessions
from estimator.diagnosis.residuals.whitened import Between, Evidence
from estimator.diagnosis.signatures.autocorrelation import Serial
from estimator.diagnosis.signatures.lasting import traces_of
from estimator.diagnosis.signatures.patterns import STRUCTURES
from estimator.diagnosis.signatures.scores import Scored, Traces, ranked, rescored, score
from estimator.session import Array

LEVEL = 0.003
"""Family-wise level: sessions without an effect that get a name; a third of what is allowed, for safety."""


NEW = 1e-6
"""Share of a trace that must lie outside the others' span to count as a direction of its own."""

PLAIN = 1.0
"""ln evidence from which on a sensor's left-over is plainly a smooth course, beside which no cause can be told."""

Group = tuple[str, tuple[int, ...]]
"""What is named: a cause and the indices of its sensors."""


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
    """Sensors whose left-over is not white, though no pattern fits it; where that is plain, no cause is named there."""
    refuted: frozenset[Group] = frozenset()
    """Causes on sensors that would have to act more often than they can."""

    @property
    def between(self) -> Between | None:
        return self.evidence.between

    @property
    def scatter(self) -> tuple[Excess | Serial, ...]:
        """Sensors whose left-over is larger than stated or not white."""
        return (*self.excess, *self.serial)

    @property
    def spoken_for(self) -> set[int]:
        """Sensors whose scatter is already known to be excess noise or uneven."""
        return {s.sensor for s in self.scatter}

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
        return left[:, size > NEW * size[0]]


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


def family_level(scored: Scored, families: int) -> float:
    """p-value of a signature or anything as strong among so many families, were there no effect."""
    return min(1.0, scored.p_value * scored.places * families)


def strongest(state: Search, traces: Sequence[Traces], without: Found | None = None) -> Found | None:
    """The signature with the strongest evidence given the other findings; None if it is not significant.

    ``without``: one finding is taken back and chosen anew, on its own sensor or common to all.
    """
    families = state.families if traces is state.traces else len(traces)
    if without is not None and without.best.shape.sensors:
        traces = [t.at(without.best.shape.sensors) for t in traces]
    uneven = {s.sensor for s in state.serial if s.evidence > PLAIN}
    scored = score(state.evidence, traces, state.taken(without))
    order = ranked([s for s in scored if uneven.isdisjoint(s.shape.sensors) and s.group not in state.refuted])
    for best, _ in order[:3]:
        p_family = family_level(best, families)
        if p_family < LEVEL:
            return Found(best, p_family, tuple(order))
    return None


def companions(state: Search, best: Found, traces: Sequence[Traces]) -> list[Found]:
    """The same cause on other sensors, where it leads that sensor's own ranking and is significant beside the rest."""
    leads: dict[tuple[int, ...], Scored] = {}
    for scored, _ in best.ranking:
        leads.setdefault(scored.shape.sensors, scored)
    same = [s for sensors, s in leads.items() if sensors and sensors != best.best.shape.sensors]
    families = state.families if traces is state.traces else len(traces)
    others: list[Found] = []
    known = spanned(state.taken(), best.best.columns)
    for scored in same:
        if scored.cause is not best.best.cause or family_level(scored, families) >= LEVEL:
            continue
        level = family_level(rescored(state.evidence, scored, known), families)
        if level < LEVEL:
            others.append(Found(scored, level, best.ranking_of(scored)))
            known = spanned(known, scored.columns)
    return others


def total(state: Search) -> float:
    """ln evidence of everything found together, each weighed on what those before it leave."""
    return beside(state, np.zeros((len(state.evidence.z), 0)), (*state.found, *state.structures))


def beside(state: Search, taken: Array, members: Sequence[Found]) -> float:
    """ln evidence of some findings beside others whose traces are ``taken`` (n, f), each on what those before leave."""
    weight = 0.0
    for member in members:
        weight += rescored(state.evidence, member.best, taken).evidence
        taken = spanned(taken, member.best.columns)
    return weight


def spanned(taken: Array, columns: Array) -> Array:
    """(n, f + …) orthonormal columns ``taken`` (n, f) continued by what is new in others (n, q)."""
    norms = np.linalg.norm(columns, axis=0)
    new = columns[:, norms > 0] / norms[norms > 0]
    for _ in range(2):
        new = new - taken @ (taken.T @ new)
    left, size, _ = np.linalg.svd(new, full_matrices=False)
    return np.concatenate([taken, left[:, size > NEW]], axis=1)
