"""Names of a group against what no catalogue has: the library of empirical terms.

Theory
------
A name claims that the cause fits, not that it is the nearest of the catalogue. So at its place the causes C are weighed
against the terms t of the library that no cause spans, all of them against the same sessions:

    ln odds = ln π + ln mean_t B_t − ln mean_c B_c,

with B the Bayes factors of `estimator.groups.evidence` in all three forms and π how often an effect is in no catalogue.
Sets count as their chain B(1)·B(2|1)·…, each member with its share of the prior; every name beyond the first is an
independent misfortune and pays ln 100 more. Where the odds are decisive the names are taken back, two of them only if
they are so without that cost; where they are within 200 to 1 the doubt stands beside the name. Lack of fit is the
evidence of the library given the names, which are left free in every session: from 1/α on a name stays only if it holds
beside the best chain of terms.

Names are only ever taken back here, so that a group without an effect is no likelier to get one.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.groups.evidence import SAME, VARYING, log_sum
from estimator.groups.layout import GroupHypothesis
from estimator.groups.place import Key, PlaceMoments, key_of
from estimator.groups.scores import batch
from estimator.groups.selection import ENOUGH, Found

OUTSIDE = 0.2
"""π over 1 − π: one effect in six is in no catalogue."""

FURTHER = float(np.log(100))
"""Cost of every name beyond the first at one place, as within one session."""

DISTINCT = float(np.log(200))
"""ln odds by which the names must beat the library for it to be no alternative."""

DECISIVE = float(np.log(20))
"""ln odds from which on the library takes the names' place."""

MISFIT = 0.05
"""Share of what one name explains that something may be left beside it, as within one session: a cause that is
described nearly is still that cause."""

BELIEVED = 2
"""Names at one place that the library must beat without that cost to take their place; against more it counts."""

LONGEST = 4
"""Terms of a chain; what needs more is no simple law."""

SPANNED = 1e-3
"""Share of a term's information that no single cause may reach, for the term to be beyond the catalogue."""


@dataclass(frozen=True)
class BeyondJudgement:
    """The library's verdict on the names at a place."""

    odds: float
    """ln odds of the library against the catalogue."""
    words: Key
    """The terms that explain most without a name."""
    statistic: float
    """χ² that they explain."""
    named: tuple[Found, ...]
    kept: tuple[Found, ...]
    """Names that hold beside those terms."""
    fits: bool
    """Whether the names describe the structure there."""

    @property
    def taken_back(self) -> tuple[GroupHypothesis, ...]:
        """Names that do not hold."""
        return tuple(f.hypothesis for f in self.named if f not in self.kept)

    @property
    def doubtful(self) -> bool:
        """Whether the library is within `DISTINCT` of the catalogue, or better."""
        return self.odds > -DISTINCT


def judged(moments: PlaceMoments, names: Sequence[Found]) -> BeyondJudgement:
    """The names of a place held against the library."""
    beyond = beyond_the_catalogue(moments)
    prior = -float(np.log(max(len(moments.terms), 1)))
    chains = [chain_of(moments, beyond, (), prior)]
    if len(names) > 1:
        chains.append(chain_of(moments, beyond, strongest_of(moments), prior))
    chain, explained = max(chains, key=lambda c: c.log_evidence).keys, max(c.statistic for c in chains)
    library = float(log_sum(np.array([c.log_evidence for c in chains]))) + float(np.log(OUTSIDE))
    odds = library - catalogue(moments, names, FURTHER)
    surely = library - catalogue(moments, names, FURTHER if len(names) > BELIEVED else 0.0)
    left = moments.given(free=[k for f in names for k in shapes_of(moments, f)]).evidence(beyond)
    misfit = total(values for values, _ in left.values()) + prior
    nearly = MISFIT * explained_by(moments, names) if len(names) == 1 else 0.0
    small = max((statistic for _, statistic in left.values()), default=0.0) < nearly
    fits = (misfit < ENOUGH or small) and surely < DECISIVE + 0.5 * nearly
    kept = () if fits else held(moments, names, chain)
    return BeyondJudgement(odds, tuple(w for k in chain for w in k), explained, tuple(names), kept, fits)


def total(values: Iterable[np.ndarray]) -> float:
    """ln of the sum of Bayes factors over candidates and forms."""
    sums = [float(log_sum(v)) for v in values]
    return float(log_sum(np.array(sums))) if sums else -np.inf


def share(moments: PlaceMoments, key: Key) -> float:
    """ln prior share of a cause at its place, of its shape included."""
    shapes: dict[str, int] = {}
    for cause, _ in moments.causes:
        shapes[cause] = shapes.get(cause, 0) + 1
    return -float(np.log(len(shapes)) + np.log(shapes[key[0]]))


def catalogue(moments: PlaceMoments, names: Sequence[Found], further: float) -> float:
    """ln evidence of the catalogue at a place: of the names together, the last of them or whatever else it might be.

    ``further``: what every name beyond the first costs.
    """
    chain = 0.0
    shared: list[Key] = []
    free: list[Key] = []
    for number, f in enumerate(names):
        key, chosen = key_of(f.hypothesis), free if f.form == VARYING else shared
        last = number == len(names) - 1
        asked = [k for k in moments.causes if k not in (*shared, *free)] if last else [key]
        evidence = moments.given(shared, free).evidence(asked)
        chain += float(log_sum(np.array([log_sum(v) + share(moments, k) for k, (v, _) in evidence.items()])))
        chosen.append(key)
        chain += between_shapes(moments, f, shared, free)
    return chain - further * (len(names) - 1)


def between_shapes(moments: PlaceMoments, name: Found, shared: Sequence[Key], free: Sequence[Key]) -> float:
    """ln evidence that a second shape of a name gains: its time constant lies between two of the grid."""
    rest = [k for k in shapes_of(moments, name) if k not in (*shared, *free)]
    if not rest:
        return 0.0
    gained = total(v for v, _ in moments.given(shared, free).evidence(rest).values()) - float(np.log(len(rest)))
    return max(gained, 0.0)


def shapes_of(moments: PlaceMoments, name: Found) -> list[Key]:
    """A name in every shape."""
    return [k for k in moments.causes if k[0] == name.hypothesis.cause]


def explained_by(moments: PlaceMoments, names: Sequence[Found]) -> float:
    """χ² beyond its degrees of freedom that names explain together, each session by itself."""
    slots = np.concatenate([moments.slots[key_of(f.hypothesis)] for f in names])
    U, F = moments.U[:, slots], moments.F[:, slots[:, None], slots]
    statistic, freedom = batch(U, F)
    return float((statistic - freedom).sum())


@dataclass(frozen=True)
class Chain:
    """Terms that explain most together."""

    keys: tuple[Key, ...]
    log_evidence: float
    """ln of the library's, of all that the last terms might be."""
    statistic: float
    """χ² that the terms explain."""


def chain_of(moments: PlaceMoments, beyond: Sequence[Key], start: tuple[Key, ...], prior: float) -> Chain:
    """The terms beyond the catalogue that explain most together, after those of a ``start`` that it has."""
    chain: tuple[Key, ...] = ()
    value, explained, whole = 0.0, 0.0, -np.inf
    while len(chain) < LONGEST:
        asked = start if len(chain) < len(start) else beyond
        evidence = moments.given(shared=chain).evidence([k for k in asked if k not in chain])
        if not evidence:
            break
        best = max(evidence, key=lambda k: evidence[k][0][SAME])
        gained = float(evidence[best][0][SAME]) + prior
        if len(chain) > len(start) and gained < ENOUGH:
            break
        if asked is beyond:
            whole = float(np.logaddexp(whole, value + total(v for v, _ in evidence.values()) + prior))
        chain, value, explained = (*chain, best), value + gained, explained + evidence[best][1]
    return Chain(chain, whole, explained)


def strongest_of(moments: PlaceMoments) -> tuple[Key, ...]:
    """The term of the whole library that explains most alone: a law may have a part that the catalogue has too."""
    evidence = moments.given().evidence(moments.terms)
    return (max(evidence, key=lambda k: evidence[k][0][SAME]),) if evidence else ()


def held(moments: PlaceMoments, names: Sequence[Found], chain: Sequence[Key]) -> tuple[Found, ...]:
    """Names that are sure beside the terms, and no smaller a part of what is there than the terms are beside them."""
    kept = []
    for f in names:
        key = key_of(f.hypothesis)
        log_odds = float(log_sum(moments.given(shared=chain).evidence([key])[key][0])) + share(moments, key)
        terms, done = 0.0, list[Key]()
        for term in chain:
            terms += float(moments.given(shared=done, free=[key]).evidence([term])[term][0][SAME])
            done.append(term)
        if log_odds > ENOUGH + FURTHER and log_odds > terms:
            kept.append(f)
    return tuple(kept)


def beyond_the_catalogue(moments: PlaceMoments) -> list[Key]:
    """The terms that no single cause of the catalogue describes as well."""
    size = np.diagonal(moments.F.sum(axis=0))
    left = [size, *(np.diagonal(moments.given(shared=[cause]).whole) for cause in moments.causes)]
    clear = np.array(left) > SPANNED * size
    return [k for k in moments.terms if clear[:, moments.slots[k]].any(axis=1).all()]
