"""Chooses the gross readings: far outside the noise and everything smooth, and alone in their row and sensor."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from estimator.applied_vector import stand_geometry
from estimator.calibration.gross_linear import Predicted
from estimator.calibration.gross_slips import BEFORE, PLAIN, STUCK, same, slip_of, stuck
from estimator.forward import response
from estimator.parameters import nominal
from estimator.session import ACCELEROMETER, RATE_TABLE, TWO_AXIS_STAND, Array, CalibrationSession

GROSS = 12.0
"""Standard errors beyond which a reading is gross: twice what chance does to the largest of a million readings; what is
smaller is weighed against other causes."""

APART = 3.0
"""Factor by which it must lie beyond the largest deviation that is left: tails and smooth effects leave no gap."""

BESIDE = 5.0
"""Standard errors by which another sensor shows a row too: chance does it once in a million readings."""

MOST, SOME = 0.1, 3
"""Part and number of a sensor's readings that may be gross without a plain slip: beyond both the sensor or the model is
at fault."""

HALF_DEAD = 0.5
"""Part of the rows that one reading fills from which what is left may not say what should have been read."""

LEAST_CHANGE = 0.05
"""Part of gravity (of the Earth's rate) by which the input along the nominal axis must change over the rows for a
constant reading to tell of a dead channel: 3°, more than axes are mounted off."""

LEAST_COUNTS = 2.0
"""Counts by which a reading in whole counts must be expected to change: fewer may round to the same."""

CUT_OFF = 0.2
"""Part of the rows at one extreme, in several places, from which a channel is cut off: too many to predict."""

CUT = 0.05
"""Part of a row's samples at an end of the channel's range from which its mean is a clipped one."""


@dataclass(frozen=True, eq=False)
class GrossChoice:
    """The readings of a session to set aside. R rows, m sensors."""

    at: Array
    """(R, m) bool: readings set aside; all readings of a channel that is dead."""
    predicted: Predicted
    slips: Mapping[tuple[int, int], str]
    """The kind of slip, by row and sensor."""
    suspects: Mapping[int, tuple[int, ...]] = field(default_factory=dict)
    """The suspects of each row that cannot tell which of its readings is wrong: sensors, the likeliest first. All of
    such a row is set aside.
    """

    def slip(self, row: int, sensor: int) -> str:
        """The likely one of a reading."""
        return self.slips[row, sensor]


def chosen(
    session: CalibrationSession, predicted: Predicted, suspects: Mapping[int, tuple[int, ...]] | None = None
) -> GrossChoice:
    """The readings to set aside, by what was ``predicted``; ``suspects`` by row as in `Choice`."""
    held, cut = standing_still(session, predicted), clipped(session, predicted)
    for j, who in (suspects or {}).items():
        cut[j] |= cut[j, list(who)].any()
    shown = shown_by_rows(session, predicted)
    far = (apart(np.abs(np.where(held, 0.0, predicted.t))) | held) & ~cut
    if session.programme == RATE_TABLE:
        far &= held | ~(shown | reaching(session, far, predicted))
    slips = {(int(j), int(i)): slip_of(session, predicted, int(j), int(i)) for j, i in np.argwhere(far)}
    plain = np.zeros(far.shape, dtype=bool)
    for place, slip in slips.items():
        plain[place] = slip in PLAIN
    far &= plain | ~(shown | lasting(session, far, predicted))
    few = (far & ~plain).sum(axis=0) <= np.maximum(SOME, MOST * len(far))
    at = far & (plain | few)
    twice = repeated(session, far)
    at[twice] = True
    slips.update(((int(j), i), BEFORE) for j in np.flatnonzero(twice) for i in range(at.shape[1]))
    if session.programme == TWO_AXIS_STAND:
        silent = dead(session) & np.isnan(predicted.value)
        at |= silent.any(axis=0)
        slips.update(((int(j), int(i)), STUCK) for j, i in np.argwhere(silent))
    doubtful = {j: who for j, who in (suspects or {}).items() if at[j, list(who)].any()}
    felt = np.array([s.kind == ACCELEROMETER for s in session.sensors])
    for j, who in doubtful.items():
        at[j] |= felt
        slips[j, who[0]] = slips.get((j, who[0]), "unknown")
    return GrossChoice(at, predicted, slips, doubtful)


def apart(size: Array) -> Array:
    """(R, m) bool: deviations (R, m), standard errors, of each sensor beyond a gap that nothing fills."""
    size = np.nan_to_num(size)
    ordered = np.sort(size, axis=0)
    below = np.vstack([np.zeros(ordered.shape[1]), ordered[:-1]])
    opens = (ordered >= GROSS) & (ordered >= APART * below)
    least = np.where(opens, ordered, np.inf).min(axis=0)
    return np.asarray(size >= least)


def dead(session: CalibrationSession) -> Array:
    """(R, m) bool: stretches of one reading over at least half of the rows of a stand, where by the nominal axis the
    input changes: what is left does not say what the channel should have read.

    Along the axis that a stand turns about, in one run, a sensor that is alive reads the same too.
    """
    found = np.zeros(session.readings.shape, dtype=bool)
    equal = stuck(session.readings)
    for i in np.flatnonzero(equal.mean(axis=0) >= HALF_DEAD).tolist():
        geometry, like = stand_geometry(session), nominal(session.sensors)
        expected, least = response(like, geometry.n)[:, i], LEAST_CHANGE * abs(like.scale[i]) * geometry.norm[i]
        u, time = session.readings[:, i], session.count_time or 1.0
        if np.all(u == np.round(u)):
            least = max(least, LEAST_COUNTS / time)
        for first, stop in stretches(session.readings, equal, i):
            if stop - first >= HALF_DEAD * len(u):
                found[first:stop, i] = np.ptp(expected[first:stop]) > least
    return found


def stretches(readings: Array, equal: Array, i: int) -> list[tuple[int, int]]:
    """First row and one past the last of every stretch of sensor i that one reading fills; ``equal`` (R, m) bool as of
    `stuck` readings (R, m)."""
    changes = (equal[1:, i] != equal[:-1, i]) | ~same(readings)[:, i]
    edges = np.flatnonzero(np.r_[True, changes, True]).tolist()
    return [(a, b) for a, b in pairwise(edges) if equal[a, i]]


def stuck_across(readings: Array, rate: Array) -> Array:
    """(R, m) bool: stretches of one reading, of readings (R, m), over which the ``rate`` (R,) changes: at one rate
    whole counts may be equal from the first row to the last."""
    equal, found = stuck(readings), np.zeros(readings.shape, dtype=bool)
    for i in np.flatnonzero(equal.any(axis=0)).tolist():
        for first, stop in stretches(readings, equal, i):
            found[first:stop, i] = np.ptp(rate[first:stop]) > 0
    return found


def repeated(session: CalibrationSession, far: Array) -> Array:
    """(R,) bool: rows that repeat the row before in every channel, although some of them are ``far`` (R, m) bool from
    what they should be: the block was not turned, or the row was written twice."""
    if session.programme != TWO_AXIS_STAND:
        return np.zeros(len(far), dtype=bool)
    return np.r_[False, same(session.readings).all(axis=1)] & far.any(axis=1)


def standing_still(session: CalibrationSession, predicted: Predicted) -> Array:
    """(R, m) bool: stretches of one reading in which it should have changed, without the row that it stayed at."""
    u, equal = session.readings, stuck(session.readings)
    found = np.zeros(u.shape, dtype=bool)
    for i in np.flatnonzero(equal.any(axis=0)).tolist():
        t, value, sigma = predicted.t[:, i], predicted.value[:, i], predicted.sigma[:, i]
        for first, stop in stretches(u, equal, i):
            moves = np.ptp(value[first:stop]) > GROSS * np.max(sigma[first:stop])
            if moves and np.max(np.abs(t[first:stop])) > GROSS:
                found[first + int(abs(t[first]) <= BESIDE) : stop, i] = True
    return found


def clipped(session: CalibrationSession, predicted: Predicted) -> Array:
    """(R, m) bool: readings at an end of their channel's range, expected beyond it in most: on a stand several at one
    of its ends, in unknown orientations single ones too, which are as likely cut off as wrong."""
    u, beyond = session.readings, np.nan_to_num(predicted.value - session.readings)
    found, ends = np.zeros(u.shape, dtype=bool), (u == u.max(axis=0), u == u.min(axis=0))
    enough = 2 if session.programme == TWO_AXIS_STAND else 1
    often = np.maximum(*(stands.sum(axis=0) for stands in ends)) >= enough
    for k, (stands, outward) in enumerate(zip(ends, (beyond > 0, beyond < 0), strict=True)):
        at_end = stands & often
        if session.at_ends is not None:
            at_end |= session.at_ends[..., k] >= CUT
        alone = (stands[1:] & ~stands[:-1]).sum(axis=0) + stands[0]
        found[:, (stands.mean(axis=0) >= CUT_OFF) & (alone > 1)] = True
        found |= at_end & (2 * (at_end & outward).sum(axis=0) > at_end.sum(axis=0))
    return found


def shown_by_rows(session: CalibrationSession, predicted: Predicted) -> Array:
    """(R, m) bool: rows on a stand or table that at least half of a kind's sensors show, two or more: the stand's, or
    the record's. In unknown orientations a row of its own direction takes up what all sensors show."""
    shows, kinds = np.nan_to_num(np.abs(predicted.t)) > BESIDE, np.array([s.kind for s in session.sensors])
    rows = np.zeros(shows.shape, dtype=bool)
    for kind in np.unique(kinds) if session.programme in (TWO_AXIS_STAND, RATE_TABLE) else ():
        alike = kinds == kind
        count = shows[:, alike].sum(axis=1)
        rows[:, alike] = (count >= max(2.0, alike.sum() / 2))[:, None]
    return rows


def lasting(session: CalibrationSession, far: Array, predicted: Predicted) -> Array:
    """(R, m) bool: readings off alike, to one side, in neighbouring rows up to an end of a run: as after a jump, or in
    warm-up."""
    R, m = far.shape
    ends = np.zeros(R + 1, dtype=bool)
    ends[[0, R]] = True
    if session.flipped is not None:
        ends[1:-1] = np.diff(session.flipped)
    side, found = np.where(far, np.sign(predicted.t), 0.0), np.zeros(far.shape, dtype=bool)
    for i in range(m):
        steps = np.abs(np.diff(np.log(np.abs(np.where(far[:, i], predicted.t[:, i], 1.0)))))
        edges = np.flatnonzero(ends | np.r_[True, (np.diff(side[:, i]) != 0) | (steps > np.log(APART)), True])
        for first, stop in pairwise(edges.tolist()):
            found[first:stop, i] = side[first, i] != 0 and stop - first > 1 and bool(ends[first] or ends[stop])
    return found


def reaching(session: CalibrationSession, far: Array, predicted: Predicted) -> Array:
    """(R, m) bool: readings off from a change of the table's rate on, or up to one, between what both rates give: the
    table takes time to reach its rate, and is taken to stand before the first row and after the last."""
    assert session.turn_rate is not None
    u, found, R = session.readings, np.zeros(far.shape, dtype=bool), len(far)
    standing = np.array([s.nominal_offset or 0.0 for s in session.sensors])
    level, spread = np.vstack([standing, predicted.value, standing]), BESIDE * predicted.sigma
    for change in np.flatnonzero(np.r_[True, np.diff(session.turn_rate) != 0, True]).tolist():
        low, high = np.minimum(level[change], level[change + 1]), np.maximum(level[change], level[change + 1])
        for rows in (range(change, R), range(change - 1, -1, -1)):
            goes_on = np.ones(far.shape[1], dtype=bool)
            for j in rows:
                goes_on &= far[j] & (u[j] >= low - spread[j]) & (u[j] <= high + spread[j])
                if not goes_on.any():
                    break
                found[j] |= goes_on
    return found
