"""What a set of still orientations identifies, before it is flown, and which orientations to add.

An orientation's share of the information is the Schur complement of its own two unknown turns; shares add up. The
sum's rank over what the parameters may do (no net turn of the axes, which nothing but stated directions can tell) is
what the set identifies. Orientations are proposed one by one from a fine grid of directions, each the one that raises
ln|information + plausible range| most: a direction nothing tells of yet counts for most.

Nine generic orientations are needed whatever the number of sensors: the readings lie on an ellipsoid, which has nine
parameters, and an orientation gives it one point. Turns that stay in the XZ and YZ planes leave one direction open for
ever: they never show x and y together.
Source: multi-parameter optimisation paper, 13 parameters of four accelerometers.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from estimator.arrays import unit
from estimator.calibration.free.information import information, movable, unseen_below
from estimator.calibration.free.knowledge import observed
from estimator.calibration.free.model import Rows, State, linearise
from estimator.errors import Problem, ScheduleError
from estimator.parameters import PLAUSIBLE, names
from estimator.results import json_numbers
from estimator.session import ACCELEROMETER, Array, Sensor

GRID = 120
"""Directions to choose from."""

LEADS = 0.35
"""Share of an open direction that an element must have to be named as part of it."""

LEAST = 9
"""Generic orientations that identify everything but the quadratic terms."""


@dataclass(frozen=True, eq=False)
class OrientationRank:
    """What R orientations tell of m accelerometers."""

    directions: Array
    """(R, 3)"""
    rank: int
    parameters: int
    weakest: tuple[str, float]
    """The element that leads the least known direction, and its one sigma (dimensionless: relative, g, 1/g, rad)."""
    unseen: tuple[str, ...]
    """Every open direction in words: the elements that move together in it."""
    names: tuple[str, ...]
    """(5 m,)"""
    sigma: Array
    """(5 m,) expected one sigma, dimensionless; NaN where not observed or not in the model."""
    add: Array
    """(k, 3) directions that complete the set; none when it is complete."""

    @property
    def full(self) -> bool:
        """Whether the set identifies every parameter."""
        return self.rank == self.parameters

    def to_dict(self) -> dict[str, Any]:
        """``imu-orientation-plan/1``."""
        return {
            "format": "imu-orientation-plan/1",
            "orientations": len(self.directions),
            "directions": self.directions.tolist(),
            "rank": self.rank,
            "parameters": self.parameters,
            "full": self.full,
            "weakest": {"parameter": self.weakest[0], "sigma": self.weakest[1]},
            "unseen": list(self.unseen),
            "sigma": dict(zip(self.names, json_numbers(self.sigma), strict=True)),
            "add": self.add.tolist(),
        }


def rank_of_orientations(
    sensors: tuple[Sensor, ...],
    directions: Array,
    *,
    noise: float = 1e-5,
    quadratic: bool = False,
    direction_sigma: float | None = None,
) -> OrientationRank:
    """Rank, weakest direction, expected sigmas and what to add.

    Parameters
    ----------
    sensors : accelerometers at their nominal axes; gyros are left out.
    directions : (R, 3) of the specific force in block axes; a degree of error does not matter.
    noise : one sigma of a reading, g.
    quadratic : whether the second-order terms are estimated too.
    direction_sigma : one sigma of the directions, rad, where they will be stated; None: they are not used.

    Raises
    ------
    ScheduleError : fewer than three accelerometers, or no orientation.
    """
    felt, directions = usable(sensors, directions)
    rows, state = planned_rows(felt, directions, noise, direction_sigma)
    told = information(rows, state, quadratic)
    free = np.linalg.norm(told.basis, axis=1) > 0
    seen = observed(told.covariance, told.unseen, free)
    labels = names(felt)
    return OrientationRank(
        directions=directions,
        rank=told.rank,
        parameters=told.parameters,
        weakest=(labels[told.weakest[0]], told.weakest[1]),
        unseen=tuple(in_words(vector, labels) for vector in told.unseen.T),
        names=labels,
        sigma=np.where(seen, np.sqrt(np.diagonal(told.covariance)), np.nan),
        add=completion(felt, directions, noise, quadratic, direction_sigma),
    )


def usable(sensors: tuple[Sensor, ...], directions: Array) -> tuple[tuple[Sensor, ...], Array]:
    """The accelerometers, and the directions as (R, 3) unit vectors; ScheduleError where there is nothing to plan."""
    felt = tuple(s for s in sensors if s.kind == ACCELEROMETER)
    if len(felt) < 3:
        raise ScheduleError([Problem("sensors", "orientations are planned for three or more accelerometers")])
    directions = np.asarray(directions, dtype=float).reshape(-1, 3)
    size = np.linalg.norm(directions, axis=1)
    if len(directions) == 0 or not np.isfinite(directions).all() or (size == 0).any():
        raise ScheduleError([Problem("directions", "give one or more finite directions that are not zero")])
    return felt, unit(directions)


def planned_rows(
    sensors: tuple[Sensor, ...], directions: Array, noise: float, direction_sigma: float | None
) -> tuple[Rows, State]:
    """Orientations still to be measured, at the nominal parameters."""
    axes, R = np.stack([s.nominal_axis for s in sensors]), len(directions)
    prior = np.full(R, 0.0 if direction_sigma is None else direction_sigma**-2.0)
    stated = directions if direction_sigma is not None else np.zeros((R, 3))
    zero = np.zeros(len(sensors))
    rows = Rows(directions @ axes.T, np.full((R, len(sensors)), noise), stated, prior, axes)
    return rows, State(zero, zero, zero, axes, directions)


def shares(rows: Rows, state: State) -> Array:
    """(R, 5 m, 5 m) what each orientation adds to the information."""
    linear = linearise(rows, state)
    R, m = rows.y.shape
    full = np.zeros((R, m, 5, m, 5))
    each = np.arange(m)
    full[:, each, :, each] = np.einsum("rmi,rmj->mrij", linear.own, linear.own)
    return full.reshape(R, 5 * m, 5 * m) - linear.coupling @ linear.inverse @ np.swapaxes(linear.coupling, 1, 2)


def grid(count: int = GRID) -> Array:
    """(count, 3) directions evenly spread over the sphere (golden spiral)."""
    k = np.arange(count) + 0.5
    height, turn = 1 - 2 * k / count, np.pi * (1 + 5**0.5) * k
    side = np.sqrt(1 - height**2)
    return np.stack([side * np.cos(turn), side * np.sin(turn), height], axis=-1)


def completion(
    sensors: tuple[Sensor, ...], directions: Array, noise: float, quadratic: bool, direction_sigma: float | None
) -> Array:
    """(k, 3) directions that bring a set to full rank, fewest first; none where it has it, or cannot get it."""
    return _greedy(sensors, directions, noise, quadratic, direction_sigma, 0)


def proposed_orientations(
    sensors: tuple[Sensor, ...], count: int = LEAST, *, noise: float = 1e-5, quadratic: bool = False
) -> Array:
    """(count or more, 3) directions chosen from scratch: the first is up, the rest tell most; of full rank."""
    felt, first = usable(sensors, np.array([[0.0, 0.0, 1.0]]))
    return np.concatenate([first, _greedy(felt, first, noise, quadratic, None, count - 1)])


def _greedy(
    sensors: tuple[Sensor, ...],
    directions: Array,
    noise: float,
    quadratic: bool,
    direction_sigma: float | None,
    at_least: int,
) -> Array:
    rows, state = planned_rows(sensors, directions, noise, direction_sigma)
    candidates = grid()
    basis = movable(rows.nominal_axes, state.axes, rows.held, quadratic)
    own = basis.T @ shares(rows, state).sum(axis=0) @ basis
    offered = basis.T @ shares(*planned_rows(sensors, candidates, noise, direction_sigma)) @ basis
    ridge = PLAUSIBLE**-2 * np.eye(basis.shape[1])
    chosen: list[int] = []
    for _ in range(max(at_least, 4 * LEAST)):
        values = np.linalg.eigvalsh(own)
        if len(chosen) >= at_least and values[0] > unseen_below(values):
            break
        best = int(np.argmax(np.linalg.slogdet(own + offered + ridge)[1]))
        chosen.append(best)
        own = own + offered[best]
    return candidates[chosen].reshape(-1, 3)


def in_words(vector: Array, labels: tuple[str, ...]) -> str:
    """``A1.scale + A2.scale − A3.axis_1``: the elements that lead an open direction."""
    size = vector / np.abs(vector).max()
    parts = [(size[k], labels[k]) for k in np.argsort(-np.abs(size)) if abs(size[k]) >= LEADS]
    sign = np.sign(parts[0][0])
    text = "".join(f" {'+' if share * sign > 0 else '−'} {label}" for share, label in parts)
    return text.removeprefix(" + ")
