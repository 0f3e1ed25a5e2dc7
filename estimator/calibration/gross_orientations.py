"""What each accelerometer should read where the orientations are unknown: a robust fit of the whole block.

The readings' weights are Cauchy's until the fit has left what does not belong, then one or nought: every reading is
held against the fit without it, until none changes sides. A reading of a row that has but two others to compare with
cannot be told from these: then all of the row that may be wrong are suspected.
Source: Holland & Welsch 1977, Commun. Stat. A6, 813 (Cauchy weights); Baarda 1968 (the deletion residual's variance).
"""

from dataclasses import dataclass, replace

import numpy as np

from estimator.applied_vector import gravity
from estimator.calibration.free import accelerometer_rows
from estimator.calibration.free.model import ModelRows, Unknowns, jacobian, linearise, predicted
from estimator.calibration.free.noise import scaled
from estimator.calibration.free.schedule import classified
from estimator.calibration.free.solve import Solution, search
from estimator.calibration.free.start import start
from estimator.calibration.gross_choice import GROSS
from estimator.calibration.gross_linear import (
    AGREES,
    FREEDOM,
    HALF,
    ROUNDS,
    SUSPICIOUS,
    TAKEN,
    Predicted,
    live,
)
from estimator.calibration.gross_slips import PLAIN, slip_of
from estimator.calibration.noise import ALIKE
from estimator.errors import ScheduleError
from estimator.session import Array, CalibrationSession

CAUCHY = 2.385
"""Standard deviations at which Cauchy's weight is a half: 95 % efficient on normal noise."""

REWEIGHTED = 15
"""Of the fit; ten are usual."""

LEAST = 1e-9
"""Least one sigma, relative to g: simulated readings may have no noise."""

TRIED = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)]) / np.sqrt(3.0)
"""(8, 3) directions that the orientation of a row is looked for from, one an octant, dimensionless."""

TURNED = 25
"""Steps of that look; Gauss–Newton takes five."""

SEEN = 0.01
"""Share of a reading that parity must show to be judged by it: a tenth of its size."""

LEFT_OUT = 0.5
"""Part of a channel's readings that may be left out to begin with: equal ones beyond it are coarse steps, not a fault."""

SLACK = 1e-3
"""Part of a slip's size that the norm of gravity leaves open in a row of three."""

ODDS = 20.0
"""χ² by which one suspect must be the better one: odds of 20,000, as a record is altered only where it is plain."""


@dataclass(frozen=True, eq=False)
class Block:
    """Accelerometers that answer, prepared. R rows, k of them."""

    rows: ModelRows
    stated: bool
    unit: Array
    """(k,) reading at y = 1, reading units."""

    @classmethod
    def of(cls, session: CalibrationSession, felt: Array) -> "Block":
        """Of the sensors ``felt`` (m,) bool."""
        g = gravity(session.site)
        rows, stated = accelerometer_rows(session, felt, g)
        scale = np.array([s.nominal_scale for s, is_felt in zip(session.sensors, felt, strict=True) if is_felt])
        return cls(rows, stated, g * scale)


@dataclass(frozen=True, eq=False)
class BlockFit:
    """Where the robust fit ended."""

    predicted: Predicted
    unknowns: Unknowns
    agrees: Array
    """(R, k) bool: readings that took part."""
    sigma: Array
    """(R, k) one sigma of a reading as the agreeing ones show it, relative to g."""
    quadratic: bool


def fit_robustly(block: Block, left_out: Array) -> BlockFit | None:
    """The block's fit to what agrees; readings ``left_out`` (R, k) bool take no part to begin with. None where the rows
    are too few for it."""
    rows, (R, k) = block.rows, block.rows.y.shape
    spare = R * (k - 2) + 2 * int((rows.prior > 0).sum()) - (5 * k - (0 if rows.held else 3))
    if spare < FREEDOM:
        return None
    quadratic = 2 * spare > R * (k - 2)
    taken = 1.0 - spare / (R * k)
    agrees, unknowns = begun(rows, ~left_out, quadratic, taken)
    seen, fit = set[bytes](), refitted(block, unknowns, agrees, quadratic)
    for _ in range(ROUNDS):
        seen.add(fit.agrees.tobytes())
        t = fit.predicted.t
        now = np.where(np.isnan(t), fit.agrees, np.abs(t) <= AGREES)
        if now.tobytes() in seen or now.sum() - R * 2 < FREEDOM:
            break
        fit = refitted(block, fit.unknowns, now, quadratic)
    return fit


def refitted(block: Block, unknowns: Unknowns, agrees: Array, quadratic: bool) -> BlockFit:
    """The fit to the readings that ``agrees`` (R, k) bool says, from ``unknowns``."""
    rows = block.rows
    floor = np.where(block.stated, 1.0, LEAST / rows.sigma)
    solution = search(rows.weighted(np.where(agrees, rows.sigma, np.inf)), unknowns, quadratic)
    value, sigma, scale = held_against(rows, solution, agrees, floor)
    with np.errstate(invalid="ignore"):
        t = (rows.y - value) / sigma * np.sign(block.unit)
    there = Predicted(value * block.unit, sigma * np.abs(block.unit), t)
    return BlockFit(there, solution.unknowns, agrees, scale * rows.sigma, quadratic)


def begun(rows: ModelRows, free: Array, quadratic: bool, taken: float) -> tuple[Array, Unknowns]:
    """(R, k) bool: readings that agree after Cauchy's weights, and the fit there. ``taken``: part of the readings'
    freedom that the fit takes."""
    weight = np.where(free, 1.0, 0.0)
    unknowns = start(rows.weighted(with_weight(rows, weight)))
    for _ in range(REWEIGHTED):
        unknowns = search(rows.weighted(with_weight(rows, weight)), unknowns, quadratic).unknowns
        size = np.abs(rows.y - predicted(unknowns)) / rows.sigma
        middle = max(float(np.quantile(size[free], 0.5 + taken / 2)) / HALF, LEAST)
        weight = np.where(free, 1.0 / (1.0 + (size / (CAUCHY * middle)) ** 2), 0.0)
    return free & (size <= AGREES * middle), unknowns


def with_weight(rows: ModelRows, weight: Array) -> Array:
    """(R, k) sigma, relative to g, of readings with weights (R, k) of one to nought."""
    return np.where(weight > 0, rows.sigma / np.sqrt(np.where(weight > 0, weight, 1.0)), np.inf)


def held_against(rows: ModelRows, solution: Solution, agrees: Array, floor: Array) -> tuple[Array, Array, Array]:
    """(R, k) prediction of each reading by the agreeing ones without it and one sigma of the difference, relative to g;
    (k,) noise as they show it, in sigmas of ``rows``, at least ``floor`` (R, k)."""
    linear, root = linearise(solution.rows, solution.unknowns), scaled(solution.knowledge)
    local, shared = (part / rows.sigma[..., None] for part in jacobian(solution.unknowns))
    through = shared @ linear.inverse
    lean = np.einsum("rmi,mif->rmf", local, root.reshape(rows.y.shape[1], 5, -1))
    lean = lean - np.einsum("rma,rpa,pf->rmf", through, linear.coupling, root)
    leverage = (through * shared).sum(axis=-1) + (lean**2).sum(axis=-1)
    rest = (rows.y - predicted(solution.unknowns)) / rows.sigma
    left = np.where(agrees, 1.0 - leverage, 1.0)
    judged = left > TAKEN
    left = np.where(judged, left, 1.0)
    used = agrees & judged
    energy = np.where(used, rest**2 / left, 0.0) * left
    freedom = np.where(used, left, 0.0)
    common = energy.sum() / max(float(freedom.sum()), 1.0)
    own = (energy.sum(axis=0) + ALIKE * common - np.where(used, energy / left, 0.0)) / (
        freedom.sum(axis=0) + ALIKE - np.where(used, left, 0.0)
    )
    noise = np.maximum(np.sqrt(np.maximum(own, 0.0)), floor)
    value = np.where(agrees, rows.y - rest / left * rows.sigma, predicted(solution.unknowns))
    sigma = noise * np.sqrt(np.where(agrees, 1.0 / left, 1.0 + leverage)) * rows.sigma
    scale = np.maximum(np.sqrt((energy.sum(axis=0) + ALIKE * common) / (freedom.sum(axis=0) + ALIKE)), floor.min())
    return np.where(judged, value, np.nan), np.where(judged, sigma, np.nan), scale


@dataclass(frozen=True, eq=False)
class Rivals:
    """A row without each of its k readings in turn."""

    square: Array
    """(k,) χ² of the others."""
    value: Array
    """(k,) the reading by the others, in nominal scale times g."""
    direction: Array
    """(k, 3) the orientation by the others, unit vectors."""


def rivals(block: Block, fit: BlockFit, row: int, off: Array) -> Rivals:
    """Of a row; ``off`` (k,) bool: readings that take no part anyway."""
    k = block.rows.y.shape[1]
    square, value, direction = np.empty(k), np.empty(k), np.empty((k, 3))
    for i in range(k):
        out = off.copy()
        out[i] = True
        directions = np.vstack([TRIED, fit.unknowns.directions[row]])
        tried = len(directions)
        sigma = np.tile(np.where(out, np.inf, fit.sigma[row]), (tried, 1))
        rows = ModelRows(
            np.tile(block.rows.y[row], (tried, 1)),
            sigma,
            np.tile(block.rows.directions[row], (tried, 1)),
            np.full(tried, block.rows.prior[row]),
            block.rows.nominal_axes,
        )
        unknowns = replace(fit.unknowns, directions=directions)
        for _ in range(TURNED):
            turns = linearise(rows, unknowns).alone
            length = np.abs(turns).max(axis=1, keepdims=True)
            unknowns = unknowns.stepped(np.zeros(5 * k), turns * np.minimum(1.0, 0.5 / np.maximum(length, 0.5)))
        squares = (((rows.y - predicted(unknowns)) / sigma) ** 2).sum(axis=1)
        best = int(np.argmin(squares))
        square[i], value[i], direction[i] = squares[best], predicted(unknowns)[best, i], unknowns.directions[best]
    return Rivals(square, value, direction)


@dataclass(frozen=True, eq=False)
class Found:
    """Of the accelerometers ``felt`` (m,) bool."""

    felt: Array
    predicted: Predicted
    suspects: dict[int, tuple[int, ...]]
    """By row that cannot tell which reading is wrong: sensors, the likeliest first."""

    def merged_into(self, whole: Predicted) -> tuple[Predicted, dict[int, tuple[int, ...]]]:
        """Beside what was predicted of other sensors."""
        return whole.with_sensors(self.felt, self.predicted), self.suspects


def accelerometers_predicted(session: CalibrationSession, left_out: Array) -> Found | None:
    """What the accelerometers of a session should read; None where nothing stands out, or nothing tells it.

    ``left_out`` (R, m) bool: readings that take no part to begin with.
    """
    try:
        felt, _, _ = classified(session)
    except ScheduleError:
        return None
    block = Block.of(session, felt)
    out = left_out[:, felt] & (left_out[:, felt].mean(axis=0) <= LEFT_OUT)
    if not out.any() and not stands_out_of(block.rows):
        return None
    fit = fit_robustly(block, out)
    return None if fit is None else identified(session, block, fit, felt)


def stands_out_of(rows: ModelRows) -> bool:
    """Whether a reading stands out of what the sensors must have in common, by linear fits alone: their parity, by the
    nominal axes and by the readings' own subspace, and the ellipsoid they lie on."""
    R, k = rows.y.shape
    centred = rows.y - np.median(rows.y, axis=0)
    inward = np.linalg.pinv(rows.nominal_axes)
    points = centred @ inward.T
    x, y, z = points.T
    quadric = live(np.column_stack([x * x - y * y, y * y - z * z, x * y, x * z, y * z, points, np.ones(R)]))
    checks = list[Array]()
    if R - quadric.shape[1] >= FREEDOM:
        leverage = (quadric**2).sum(axis=1, keepdims=True)
        square = (points**2).sum(axis=1, keepdims=True)
        checks.append((square - quadric @ (quadric.T @ square)) / np.sqrt(np.maximum(1.0 - leverage, TAKEN)))
    if k > 3:
        own = np.linalg.svd(centred - centred.mean(axis=0), full_matrices=False)[2][:3].T
        for within in (rows.nominal_axes @ inward, own @ own.T):
            parity = np.eye(k) - within
            seen = np.diagonal(parity) > SEEN
            checks.append((centred @ parity)[:, seen] / np.sqrt(np.diagonal(parity)[seen]))
    return any(bool((np.abs(c).max(axis=0) > SUSPICIOUS * np.median(np.abs(c), axis=0) / HALF).any()) for c in checks)


def identified(session: CalibrationSession, block: Block, fit: BlockFit, felt: Array) -> Found:
    """The fit with every gross reading given to the sensor of its row that is wrong, where the row can tell."""
    chosen, suspects, place = fit.agrees.copy(), dict[int, tuple[int, ...]](), np.flatnonzero(felt)
    directions = fit.unknowns.directions.copy()
    far = np.nan_to_num(np.abs(fit.predicted.t)) > GROSS
    for j in np.flatnonzero(far.sum(axis=1) == 1).tolist():
        tried = rivals(block, fit, j, ~fit.agrees[j] & ~far[j])
        likely = np.flatnonzero(tried.square <= tried.square.min() + ODDS)
        likely = likely[np.argsort(tried.square[likely])]
        if len(likely) > 1:
            likely = self_evident(session, place, j, likely, tried.value * block.unit + offsets(session, place))
        chosen[j] = fit.agrees[j] | far[j]
        chosen[j, likely[0]] = False
        directions[j] = tried.direction[likely[0]]
        if len(likely) > 1:
            suspects[j] = tuple(int(place[i]) for i in likely)
    if (chosen != fit.agrees).any():
        fit = refitted(block, replace(fit.unknowns, directions=directions), chosen, fit.quadratic)
    return Found(felt, fit.predicted.shifted(offsets(session, place)), suspects)


def self_evident(session: CalibrationSession, place: Array, j: int, likely: Array, value: Array) -> Array:
    """Of suspects ``likely`` (n,) in row j, the one whose reading is a plain slip of what it should be, ``value`` (k,)
    in reading units; all where none or several are."""
    u = session.readings
    predicted = Predicted(*(np.full(u.shape, np.nan) for _ in range(3)))
    predicted.value[j, place] = value
    predicted.sigma[j, place] = SLACK * np.abs(u[j, place] - value)
    plain = [i for i in likely if slip_of(session, predicted, j, int(place[i])) in PLAIN]
    return np.array(plain) if len(plain) == 1 else likely


def offsets(session: CalibrationSession, place: Array) -> Array:
    """(k,) stated nominal offsets of the sensors ``place`` (k,), reading units."""
    return np.array([session.sensors[i].nominal_offset or 0.0 for i in place])
