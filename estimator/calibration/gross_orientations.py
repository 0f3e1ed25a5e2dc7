"""Predicts each accelerometer where the orientations are unknown: a robust fit of the whole block.

The fit begins from the rows that agree best, loses in every other row the readings that do not fit together, and then
holds every reading against the fit without it, until none changes sides. A reading of a row that has but two others to
compare with cannot be told from these: then all of the row that may be wrong are suspected.
Source: Rousseeuw & Van Driessen 2006, Data Min. Knowl. Disc. 12, 29 (least trimmed squares, concentration); Baarda 1968
(the deletion residual's variance).
"""

from dataclasses import dataclass, replace

import numpy as np

from estimator.applied_vector import gravity
from estimator.arrays import unit
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
    ROUNDS,
    SUSPICIOUS,
    TAKEN,
    Predicted,
    live,
    sticks_out,
)
from estimator.calibration.gross_slips import PLAIN, SIGN, slip_of
from estimator.calibration.noise import ALIKE
from estimator.errors import ScheduleError
from estimator.session import Array, CalibrationSession

CORE = 0.7
"""Part of the rows that the fit is begun from: a tenth of one sensor's readings, or three rows of twelve, stay out."""

FEW = 6
"""Rows that a beginning is made from: they tell a sphere in space, and a handful of them is likely to be sound."""

BEGUN = 12
"""Beginnings; of six rows a third are sound even where a sixth of all are not."""

SPREAD = 2.0
"""Times the noise that the rows that agree best show: of normal numbers, the 70 % nearest zero have half the sigma."""

CONCENTRATED = 3
"""Steps of concentration on the rows that agree best; Rousseeuw and Van Driessen take two."""

LEAST = 1e-9
"""Least one sigma, relative to g: simulated readings may have no noise."""

TRIED = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)]) / np.sqrt(3.0)
"""(8, 3) directions that the orientation of a row is looked for from, one an octant, dimensionless."""

TURNED = 12
"""Steps of that look; Gauss–Newton takes five …"""

STEP = 0.5
"""Longest of those steps, rad."""

SEEN = 0.01
"""Share of a reading that parity must show to be judged by it: a tenth of its size."""

LEFT_OUT = 0.5
"""Part of a channel's readings that may be left out to begin with: beyond it equal ones are coarse steps, no fault."""

SLACK = 1e-3
"""Part of a slip's size that the norm of gravity leaves open in a row of three."""

ODDS = 20.0
"""χ² by which one suspect must be the better one: odds of 20,000, as a record is altered only where it is plain."""


@dataclass(frozen=True, eq=False)
class RobustBlock:
    """Accelerometers that answer, prepared. R rows, k of them."""

    rows: ModelRows
    stated: bool
    unit: Array
    """(k,) reading at y = 1, reading units."""

    @classmethod
    def of(cls, session: CalibrationSession, felt: Array) -> "RobustBlock":
        """Prepares the sensors ``felt`` (m,) bool."""
        g = gravity(session.site)
        rows, stated = accelerometer_rows(session, felt, g)
        scale = np.array([s.nominal_scale for s, is_felt in zip(session.sensors, felt, strict=True) if is_felt])
        return cls(rows, stated, g * scale)


@dataclass(frozen=True, eq=False)
class BlockFit:
    """The end of the robust fit."""

    predicted: Predicted
    unknowns: Unknowns
    agrees: Array
    """(R, k) bool: readings that took part."""
    sigma: Array
    """(R, k) one sigma of a reading as the agreeing ones show it, relative to g."""
    quadratic: bool


def fit_robustly(block: RobustBlock, left_out: Array) -> BlockFit | None:
    """The block's fit to what agrees; readings ``left_out`` (R, k) bool take no part to begin with. None where the rows
    are too few for it."""
    rows, (R, k) = block.rows, block.rows.y.shape
    spare = R * (k - 2) + 2 * int((rows.prior > 0).sum()) - (5 * k - (0 if rows.held else 3))
    if spare < FREEDOM:
        return None
    quadratic = 2 * spare > R * (k - 2)
    core, begin = core_of(rows, np.asarray(left_out.any(axis=1)))
    fit = refitted(block, begin, np.tile(core[:, None], (1, k)), quadratic=False)
    fit = refitted(block, *row_by_row(block, fit, left_out), quadratic)
    seen = set[bytes]()
    for _ in range(ROUNDS):
        seen.add(fit.agrees.tobytes())
        t = fit.predicted.t
        now = np.where(np.isnan(t), fit.agrees, np.abs(t) <= AGREES)
        if now.tobytes() in seen or now.sum() - R * 2 < FREEDOM:
            break
        fit = refitted(block, fit.unknowns, now, quadratic)
    return fit


def core_of(rows: ModelRows, doubtful: Array) -> tuple[Array, Unknowns]:
    """(R,) bool: the rows that agree best, and a linear fit of them: least trimmed squares over whole rows, begun from
    the nominal values and from a few rows at a time; ``doubtful`` (R,) bool rows are in none of them."""
    R, k = rows.y.shape
    free = np.flatnonzero(~doubtful)
    h = min(int(np.ceil(CORE * R)), len(free))
    rng = np.random.default_rng(0)
    nominal = Unknowns(np.zeros(k), np.zeros(k), np.zeros(k), rows.nominal_axes, rows.directions)
    begins = [nominal] + [linear_fit(rows, rng.choice(free, min(FEW, h), replace=False)) for _ in range(BEGUN)]
    best, least = (free[:h], nominal), np.inf
    for unknowns in begins:
        for _ in range(CONCENTRATED):
            core = free[np.argsort(row_squares(rows, unknowns)[free])[:h]]
            unknowns = linear_fit(rows, core)
        total = float(np.sort(row_squares(rows, unknowns)[free])[:h].sum())
        if total < least:
            best, least = (core, unknowns), total
    core, unknowns = best
    directions = unit((rows.y - unknowns.offset) @ np.linalg.pinv(sensitivity(unknowns)).T)
    return np.isin(np.arange(R), core), replace(unknowns, directions=directions)


def linear_fit(rows: ModelRows, some: Array) -> Unknowns:
    """Parameters by some rows (n,) alone."""
    return start(ModelRows(rows.y[some], rows.sigma[some], rows.directions[some], rows.prior[some], rows.nominal_axes))


def sensitivity(unknowns: Unknowns) -> Array:
    """(k, 3) change of the readings with the specific force, relative."""
    return np.exp(unknowns.log_scale)[:, None] * unknowns.axes


def row_squares(rows: ModelRows, unknowns: Unknowns) -> Array:
    """(R,) squared residuals of every row, in g², its orientation found linearly."""
    sensitive = sensitivity(unknowns)
    directions = unit((rows.y - unknowns.offset) @ np.linalg.pinv(sensitive).T)
    return np.asarray(((rows.y - unknowns.offset - directions @ sensitive.T) ** 2).sum(axis=1))


def row_by_row(block: RobustBlock, fit: BlockFit, left_out: Array) -> tuple[Unknowns, Array]:
    """The fit's unknowns with every row's own orientation, and (R, k) bool the readings that agree in it: a row that
    does not fit together loses one reading after the other, as long as two are left."""
    k = block.rows.y.shape[1]
    agrees, noise = ~left_out, np.where(left_out, np.inf, SPREAD * fit.sigma)
    placed = turned(block.rows.weighted(noise), fit.unknowns)
    square = (((block.rows.y - predicted(placed)) / noise) ** 2).sum(axis=1)
    directions = placed.directions.copy()
    for j in np.flatnonzero(square > k + AGREES**2):
        off = ~agrees[j]
        while k - off.sum() > 2:
            tried = without_each(block, fit, int(j), off, SPREAD)
            directions[j] = tried.direction[-1]
            if tried.whole <= k + AGREES**2:
                break
            i = int(np.argmin(np.where(off, np.inf, tried.square)))
            directions[j], off[i] = tried.direction[i], True
        agrees[j] = ~off
    return replace(fit.unknowns, directions=directions), agrees


def refitted(block: RobustBlock, unknowns: Unknowns, agrees: Array, quadratic: bool) -> BlockFit:
    """The fit to the readings that ``agrees`` (R, k) bool says, from ``unknowns``."""
    rows = block.rows
    floor = np.where(block.stated, 1.0, LEAST / rows.sigma)
    solution = search(rows.weighted(np.where(agrees, rows.sigma, np.inf)), unknowns, quadratic)
    value, sigma, scale = held_against(rows, solution, agrees, floor)
    with np.errstate(invalid="ignore"):
        t = (rows.y - value) / sigma * np.sign(block.unit)
    there = Predicted(value * block.unit, sigma * np.abs(block.unit), t)
    return BlockFit(there, solution.unknowns, agrees, scale * rows.sigma, quadratic)


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


def turned(rows: ModelRows, unknowns: Unknowns) -> Unknowns:
    """Every row's orientation at its best, the parameters as they are."""
    still = np.zeros(5 * rows.y.shape[1])
    for _ in range(TURNED):
        turns = linearise(rows, unknowns).alone
        length = np.abs(turns).max(axis=1, keepdims=True)
        unknowns = unknowns.stepped(still, turns * np.minimum(1.0, STEP / np.maximum(length, STEP)))
    return unknowns


@dataclass(frozen=True, eq=False)
class WithoutEach:
    """A row of k readings without each of them in turn, and last without none."""

    square: Array
    """(k,) χ² of the others."""
    whole: float
    """χ² of all."""
    value: Array
    """(k,) the reading by the others, in nominal scale times g."""
    direction: Array
    """(k + 1, 3) the orientation, unit vectors."""


def without_each(block: RobustBlock, fit: BlockFit, row: int, off: Array, spread: float = 1.0) -> WithoutEach:
    """The row without each of its readings. Its orientation is searched from many starts; of two fits as good (of three
    readings, mirrored ones), the one nearer the readings is taken. ``off`` (k,) bool: readings that take no part
    anyway; ``spread``: factor on their sigma.
    """
    k, tried = block.rows.y.shape[1], len(TRIED) + 1
    out = np.repeat(np.vstack([np.eye(k, dtype=bool), np.zeros(k, dtype=bool)]) | off, tried, axis=0)
    n = len(out)
    rows = ModelRows(
        np.broadcast_to(block.rows.y[row], (n, k)),
        np.where(out, np.inf, spread * fit.sigma[row]),
        np.broadcast_to(block.rows.directions[row], (n, 3)),
        np.full(n, block.rows.prior[row]),
        block.rows.nominal_axes,
    )
    unknowns = replace(fit.unknowns, directions=np.tile(np.vstack([TRIED, fit.unknowns.directions[row]]), (k + 1, 1)))
    unknowns = turned(rows, unknowns)
    there = predicted(unknowns)
    square = (((rows.y - there) / rows.sigma) ** 2).sum(axis=1).reshape(k + 1, tried)
    least = square.min(axis=1)
    away = np.abs(there - block.rows.y[row]).reshape(k + 1, tried, k).max(axis=2)
    as_good = square <= least[:, None] + ODDS
    best = np.argmin(np.where(as_good, away, np.inf), axis=1) + tried * np.arange(k + 1)
    return WithoutEach(least[:k], float(least[k]), there[best[:k], np.arange(k)], unknowns.directions[best])


@dataclass(frozen=True, eq=False)
class GrossFound:
    """The predictions and suspects of the accelerometers ``felt`` (m,) bool."""

    felt: Array
    predicted: Predicted
    suspects: dict[int, tuple[int, ...]]
    """The suspects of each row that cannot tell which reading is wrong: sensors, the likeliest first."""

    def merged_into(self, whole: Predicted) -> tuple[Predicted, dict[int, tuple[int, ...]]]:
        """The predictions and suspects put into ``whole``, the prediction of all sensors."""
        return whole.with_sensors(self.felt, self.predicted), self.suspects


def accelerometers_predicted(session: CalibrationSession, left_out: Array) -> GrossFound | None:
    """Predicts the accelerometers of a session; None where nothing stands out, or nothing tells it.

    ``left_out`` (R, m) bool: readings that take no part to begin with.
    """
    try:
        felt, _, _ = classified(session)
    except ScheduleError:
        return None
    block = RobustBlock.of(session, felt)
    out = left_out[:, felt] & (left_out[:, felt].mean(axis=0) <= LEFT_OUT)
    if not out.any() and not stands_out_of(block):
        return None
    fit = fit_robustly(block, out)
    return None if fit is None else identified(session, block, fit, felt)


def stands_out_of(block: RobustBlock) -> bool:
    """Whether a reading stands out, by linear fits alone, from what the sensors must have in common: the readings in
    the null space of the nominal axes follow the vector that they measure, and that lies on an ellipsoid.
    """
    rows, (R, k) = block.rows, block.rows.y.shape
    inward = np.linalg.pinv(rows.nominal_axes)
    points = (rows.y - np.median(rows.y, axis=0)) @ inward.T
    x, y, z = points.T
    along = np.column_stack([np.ones(R), points])
    square = (points**2).sum(axis=1)
    quadric = live(np.column_stack([along, x * x - y * y, y * y - z * z, x * y, x * z, y * z]))
    noise = np.median(rows.sigma) if block.stated else np.nan
    of_square = np.full((R, 1), 2 * noise * np.linalg.norm(inward) / np.sqrt(3))
    if np.sqrt(square.max()) > SUSPICIOUS * np.sqrt(np.median(square)):
        return True
    if sticks_out(quadric, square[:, None], of_square).any():
        return True
    parity = np.eye(k) - rows.nominal_axes @ inward
    seen = np.diagonal(parity) > SEEN
    of_parity = np.broadcast_to(noise * np.sqrt(np.diagonal(parity)[seen]), (R, int(seen.sum())))
    return k > 3 and bool(sticks_out(live(along), rows.y @ parity[:, seen], of_parity).any())


def identified(session: CalibrationSession, block: RobustBlock, fit: BlockFit, felt: Array) -> GrossFound:
    """The fit with every gross reading given to the sensor of its row that is wrong, where the row can tell."""
    chosen, suspects, place = fit.agrees.copy(), dict[int, tuple[int, ...]](), np.flatnonzero(felt)
    directions = fit.unknowns.directions.copy()
    far = np.nan_to_num(np.abs(fit.predicted.t)) > GROSS
    for j in np.flatnonzero(far.sum(axis=1) == 1).tolist():
        tried = without_each(block, fit, j, ~fit.agrees[j] & ~far[j])
        likely = np.flatnonzero(tried.square <= tried.square.min() + ODDS)
        likely = likely[np.argsort(tried.square[likely])]
        if len(likely) > 1:
            likely = self_evident(session, place, j, likely, tried.value * block.unit + offsets(session, place))
        u, value = block.rows.y, tried.value
        ends = ((u[j] == u.max(axis=0)) & (value > u[j])) | ((u[j] == u.min(axis=0)) & (value < u[j]))
        if len(likely) > 1 and ends[likely].any():
            fit.predicted.t[j] = np.nan
            continue
        chosen[j] = fit.agrees[j] | far[j]
        chosen[j, likely[0]] = False
        directions[j] = tried.direction[likely[0]]
        if len(likely) > 1:
            suspects[j] = tuple(int(place[i]) for i in likely)
    if (chosen != fit.agrees).any():
        fit = refitted(block, replace(fit.unknowns, directions=directions), chosen, fit.quadratic)
    return GrossFound(felt, fit.predicted.shifted(offsets(session, place)), suspects)


def self_evident(session: CalibrationSession, place: Array, j: int, likely: Array, value: Array) -> Array:
    """The suspect, out of ``likely`` (n,) in row j, whose reading is a plain slip of its prediction ``value`` (k,),
    reading units; all of them where none or several are.
    """
    u = session.readings
    predicted = Predicted(*(np.full(u.shape, np.nan) for _ in range(3)))
    predicted.value[j, place] = value
    predicted.sigma[j, place] = SLACK * np.abs(u[j, place] - value)
    plain = [i for i in likely if slip_of(session, predicted, j, int(place[i])) in PLAIN - {SIGN}]
    return np.array(plain) if len(plain) == 1 else likely


def offsets(session: CalibrationSession, place: Array) -> Array:
    """(k,) stated nominal offsets of the sensors ``place`` (k,), reading units."""
    return np.array([session.sensors[i].nominal_offset or 0.0 for i in place])
