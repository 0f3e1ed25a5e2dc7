"""Parameters that a set of still orientations identifies, before it is flown, and the orientations to add.

The information's rank over what the parameters may do (no net turn of the axes, which nothing but stated directions
can tell) is what the set identifies.

Nine generic orientations are needed whatever the number of sensors: the readings lie on an ellipsoid, which has nine
parameters, and an orientation gives it one point. Turns that stay in the XZ and YZ planes leave one direction open for
ever: they never show x and y together.
Source: multi-parameter optimisation paper, 13 parameters of four accelerometers.
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import unit
from estimator.calibration.free.completion import LEAST, completion, planned_rows
from estimator.calibration.free.information import information
from estimator.calibration.free.knowledge import observed
from estimator.codec import Document, named
from estimator.errors import Problem, ScheduleError
from estimator.parameters import names
from estimator.session import ACCELEROMETER, Array, Sensor

NOISE = 1e-5
"""g, one sigma of a reading that orientations are weighed by, unless another is stated."""
LEADS = 0.35
"""Part of the leading element's share of an open direction that another must have to be named beside it: a third, so
that two or three are named and not a dozen."""


@dataclass(frozen=True, eq=False)
class OrientationRank(
    Document,
    format="imu-orientation-plan/1",
    order=(
        "orientations", "directions", "rank", "parameters", "full", "weakest", "unseen", "sigma_by_name", "add",
    ),
    keys={"sigma_by_name": "sigma"},
    forms={"weakest": named("parameter", "sigma")},
):  # fmt: skip
    """Information of R orientations on m accelerometers."""

    directions: Array
    """(R, 3) directions of the specific force, unit vectors, block axes."""
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
    """(k, 3) unit vectors that complete the set; none when it is complete."""

    @property
    def orientations(self) -> int:
        """Number of directions."""
        return len(self.directions)

    @property
    def sigma_by_name(self) -> dict[str, float]:
        """``sigma`` by the elements' names."""
        return dict(zip(self.names, self.sigma.tolist(), strict=True))

    @property
    def full(self) -> bool:
        """Whether the set identifies every parameter."""
        return self.rank == self.parameters


def rank_of_orientations(
    sensors: tuple[Sensor, ...],
    directions: Array,
    *,
    noise: float = NOISE,
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
    rows, unknowns = planned_rows(axes_of(felt), directions, noise, direction_sigma)
    known = information(rows, unknowns, quadratic)
    free = np.linalg.norm(known.basis, axis=1) > 0
    seen = observed(known.covariance, known.unseen, free)
    labels = names(felt)
    return OrientationRank(
        directions=directions,
        rank=known.rank,
        parameters=known.parameters,
        weakest=(labels[known.weakest[0]], known.weakest[1]),
        unseen=tuple(in_words(vector, labels) for vector in known.unseen.T),
        names=labels,
        sigma=np.where(seen, np.sqrt(np.diagonal(known.covariance)), np.nan),
        add=completion(axes_of(felt), directions, noise=noise, quadratic=quadratic, direction_sigma=direction_sigma),
    )


def usable(sensors: tuple[Sensor, ...], directions: Array) -> tuple[tuple[Sensor, ...], Array]:
    """The accelerometers, and directions (R, 3) scaled to one, dimensionless; ScheduleError if none can be planned."""
    felt = tuple(s for s in sensors if s.kind == ACCELEROMETER)
    if len(felt) < 3:
        raise ScheduleError([Problem("sensors", "orientations are planned for three or more accelerometers")])
    directions = np.asarray(directions, dtype=float).reshape(-1, 3)
    size = np.linalg.norm(directions, axis=1)
    if len(directions) == 0 or not np.isfinite(directions).all() or (size == 0).any():
        raise ScheduleError([Problem("directions", "give one or more finite directions that are not zero")])
    return felt, unit(directions)


def axes_of(sensors: tuple[Sensor, ...]) -> Array:
    """(m, 3) nominal axes, unit vectors, block axes."""
    return np.stack([s.nominal_axis for s in sensors])


def proposed_orientations(sensors: tuple[Sensor, ...], count: int = LEAST, *, quadratic: bool = False) -> Array:
    """(count, 3) unit vectors or more, chosen from scratch: the first is up, the rest tell most; of full rank.

    ScheduleError for fewer than three accelerometers.
    """
    felt, first = usable(sensors, np.array([[0.0, 0.0, 1.0]]))
    return np.concatenate(
        [first, completion(axes_of(felt), first, noise=NOISE, quadratic=quadratic, at_least=count - 1)]
    )


def in_words(vector: Array, labels: tuple[str, ...]) -> str:
    """``A1.scale + A2.scale − A3.axis_1``: the elements that lead an open direction (P,), dimensionless."""
    size = vector / np.abs(vector).max()
    parts = [(size[k], labels[k]) for k in np.argsort(-np.abs(size)) if abs(size[k]) >= LEADS]
    sign = np.sign(parts[0][0])
    text = "".join(f" {'+' if share * sign > 0 else '−'} {label}" for share, label in parts)
    return text.removeprefix(" + ")
