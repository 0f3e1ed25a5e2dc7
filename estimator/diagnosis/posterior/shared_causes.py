"""A cause that several sensors have at once: one shape, a size of each, and a choice of the sensors."""

from functools import partial

import numpy as np
from scipy.special import logsumexp

from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.members import CourseMembers, each_alone, likeliest_few, members_of
from estimator.diagnosis.posterior.priors import SHARED, SIZES
from estimator.diagnosis.posterior.sensor_causes import SensorCauses, SensorShapes
from estimator.diagnosis.posterior.term import CauseEffect, Kind, PlaceCandidate, Since, Term
from estimator.session import Array

CLOSEST = 3
"""Shapes of a cause that are weighed exactly: next to the best one others may explain almost as much."""

HOPELESS = -10.0
"""ln posterior odds, as if sensors did not overlap, below which a shape is not weighed exactly."""

PREFIX = "several-"
"""Prefix of the name of a cause of several sensors."""


class SharedCauses(Kind):
    """Causes of the catalogue that sensors may have in common."""

    def __init__(self, single: SensorCauses) -> None:
        self.single = single
        families: dict[tuple[str, Since, int], list[SensorShapes]] = {}
        for block in single.blocks:
            for part in block.parts:
                if part.cause.shared_sentence and part.since is not Since.OPEN and part.rows.shape[2] == 1:
                    families.setdefault((part.cause.identifier, part.since, len(part.nonlinear)), []).append(part)
        self.families = [parts for parts in families.values() if len(parts) > 1]
        kinds = {(parts[0].cause.identifier, parts[0].since) for parts in self.families}
        self.log_prior = float(np.log(SHARED / max(len(kinds), 1)))

    def candidates(self, info: InputInformation) -> list[PlaceCandidate]:
        best: dict[str, PlaceCandidate] = {}
        for parts in self.families:
            for candidate in self.of_family(info, parts):
                name = candidate.place[0]
                if name not in best or candidate.value > best[name].value:
                    best[name] = candidate
        return list(best.values())

    def of_family(self, info: InputInformation, parts: list[SensorShapes]) -> list[PlaceCandidate]:
        """The cause at its closest shapes, each with its likeliest sensors."""
        along, square = self.alone(info, parts)
        prior = self.log_prior - float(np.log(len(along)))
        screened = likeliest_few(each_alone(along, square), 2).max(axis=0) - np.log(len(SIZES)) + prior
        found = []
        for s in np.argsort(-screened)[:CLOSEST].tolist():
            if screened[s] < HOPELESS:
                break
            W = np.stack([self.columns(part, s) for part in parts], axis=1)
            members = members_of(info, W.T @ info.A @ W, W.T @ info.a)
            value = members.value + prior
            place = (PREFIX + parts[0].cause.identifier, tuple(parts[k].sensor for k in members.numbers))
            found.append(PlaceCandidate(place, value, value, True, partial(self.term, parts, s, members)))
        return found

    def alone(self, info: InputInformation, parts: list[SensorShapes]) -> tuple[Array, Array]:
        """(S, m) W'a and (S, m) W'AW of every shape on every sensor, per unit of size."""
        along, square = [], []
        for part in parts:
            at = self.single.layout.of_sensor(part.sensor)
            X = part.rows[:, :, 0] * self.single.layout.unit[part.sensor]
            along.append(X @ info.a[at])
            square.append(((X @ info.A[np.ix_(at, at)]) * X).sum(axis=1))
        return np.stack(along, axis=1), np.stack(square, axis=1)

    def columns(self, part: SensorShapes, s: int) -> Array:
        """(D,) the s-th shape of one sensor, per unit of size."""
        columns = np.zeros(self.single.layout.D)
        columns[self.single.layout.of_sensor(part.sensor)] = part.rows[s, :, 0] * self.single.layout.unit[part.sensor]
        return columns

    def term(self, parts: list[SensorShapes], s: int, members: CourseMembers) -> Term:
        """One shape on some of its sensors."""
        chosen = [parts[k] for k in members.numbers]
        scale = np.array([part.scale[s, 0] * self.single.layout.unit[part.sensor] for part in chosen])
        effect = CauseEffect(chosen[0].cause, chosen[0].nonlinear[s], chosen[0].since, scale)
        place = (PREFIX + chosen[0].cause.identifier, tuple(part.sensor for part in chosen))
        W = np.stack([self.columns(part, s) for part in chosen], axis=1)
        prior = self.log_prior - float(np.log(len(chosen[0].nonlinear))) + members.log_share
        return Term(place, W, np.full(len(chosen), SIZES[members.level] ** 2), prior, named=True, effect=effect)

    def log_own_shapes(self, info: InputInformation, term: Term) -> float:
        """ln odds of a shape of each sensor's own over the one that all have; −∞ where there is but one to choose.

        Each may have any shape of the grid, or that of all, as may all together; the sizes are those of the term.
        """
        effect = term.effect
        assert effect is not None
        every = [part for family in self.families for part in family]
        parts = [p for p in every if (p.cause, p.since) == (effect.cause, effect.since) and p.sensor in term.sensors]
        if len(parts) < 2 or len(parts[0].nonlinear) < 2:
            return -np.inf
        at = [term.sensors.index(part.sensor) for part in parts]
        shapes = [np.stack([self.columns(p, s) for p in parts], axis=1) for s in range(len(parts[0].nonlinear))]
        shapes.append(term.columns[:, at])
        size = np.sqrt(term.variance[:1])
        apart = -_over_last(info, shapes, size)
        for k, own in enumerate(at):
            others = [j for j in range(len(term.sensors)) if j != own]
            left, _ = info.given(term.columns[:, others], term.variance[others])
            apart += _over_last(left, [W[:, [k]] for W in shapes], size)
        return apart


def _over_last(info: InputInformation, shapes: list[Array], size: Array) -> float:
    """ln of the mean B of shapes (D, k), over that of the last."""
    gram, along = np.stack([W.T @ info.A @ W for W in shapes]), np.stack([W.T @ info.a for W in shapes])
    value = info.log_evidence_of(gram, along, size)[:, 0]
    return float(logsumexp(value) - np.log(len(shapes)) - value[-1])
