"""Sequentially thresholded least squares (Brunton et al. 2016, appendix B) over all signatures at once."""

from collections.abc import Iterator

import numpy as np

from benchmarks.blind.given import Claim, Given
from benchmarks.study.detection import CUTS, RIDGE
from benchmarks.study.signatures import Traces
from estimator.session import Array

FEWER = CUTS[CUTS > 0.3][::-2]
"""Thresholds tried, standard errors, the largest first: below, everything stays."""


def sparse(given: Given) -> list[Claim]:
    """Each cause on its sensor, with the largest threshold at which a term of it stays; the cut is where it is set."""
    state, found = given.state, dict[tuple[str, int], float]()
    terms = [term for traces in given.signatures.each for term in _terms(traces)]
    for cut, kept in kept_terms(given.signatures.library, state.residuals.z):
        for k in kept:
            found.setdefault(terms[k], cut)
    return [
        Claim(cut, {"cause": cause, "sensors": [] if sensor < 0 else [state.names[sensor]]})
        for (cause, sensor), cut in found.items()
    ]


def _terms(traces: Traces) -> Iterator[tuple[str, int]]:
    """The cause and its sensor, −1 for none, of every column, shape by shape."""
    for shape in traces.shapes:
        yield from [(traces.cause.identifier, next(iter(shape.sensors), -1))] * traces.columns.shape[-1]


def kept_terms(library: Array, z: Array) -> Iterator[tuple[float, Array]]:
    """The columns of a library (n, k) that remain at every threshold, the strongest first; standard errors."""
    norms = np.linalg.norm(library, axis=0)
    seen = np.flatnonzero(norms > 0)
    unit = library[:, seen] / norms[seen]
    first = ridge(unit, z)
    for cut in FEWER:
        chosen, value = np.arange(len(seen)), first
        while len(chosen) and not (keep := np.abs(value) >= cut).all():
            chosen = chosen[keep]
            value = ridge(unit[:, chosen], z)
        yield float(cut), seen[chosen[np.argsort(-np.abs(value), kind="stable")]]


def ridge(columns: Array, z: Array) -> Array:
    """(k,) ridge regression of residuals z (n,) on columns (n, k), by the smaller of the two normal matrices."""
    n, k = columns.shape
    if k < n:
        return np.asarray(np.linalg.solve(columns.T @ columns + RIDGE * np.eye(k), columns.T @ z))
    return np.asarray(columns.T @ np.linalg.solve(columns @ columns.T + RIDGE * np.eye(n), z))
