"""Time base and stops of a turntable session: where the table stood, and whether the block did what the table says."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from estimator.errors import Problem, ScheduleError, problem_at
from estimator.message import joined, say
from estimator.session import Array, CalibrationSession
from estimator.wording import counted

UNEVEN = 0.01
"""Part of the interval by which the rows' times may stray from equal steps: clocks stray less, a lost row more."""
STILL = np.radians(0.01)
"""rad that the table may move within twice `HALF` and still stand: above an encoder's last digit, slower than any table
is turned."""
HALF = 0.5
"""s; half the time over which that is judged."""
SHORTEST = 10.0
"""s that make a stop: ten steps of the filter, which noise and the coarse alignment need."""
FEWEST_ROWS = 10
"""Rows that make a stop: fewer have no scatter to take the noise from."""
LEAST_SEPARATION = np.radians(20.0)
"""rad between stops that count as different positions: closer ones hardly tell biases from the level and north."""
DISAGREEMENT = (np.radians(1.0), 0.02)
"""Largest disagreement between gyros and table over a turn, rad, and as a part of the turn: beyond bias and scale of
any gyro that can align; a wrong sign or unit is far more.
"""
MOVING = np.radians(0.1)
"""rad/s of the block, averaged over a second, from which it does not stand still: 24 times the Earth's rate."""
STEEPEST = np.radians(3.0)
"""rad of the turn axis from the vertical; beyond, ∇_z leaks into what is taken for ∇_x and ∇_y."""
GRAVITY_MISMATCH = 0.05
"""Part of gravity by which the specific force at rest may differ from it: beyond scale and bias of any accelerometer
that can align; a wrong nominal scale is more."""


@dataclass(frozen=True)
class Stop:
    """Rows in which the table stands."""

    first: int
    """First row, counted from 0."""
    last: int
    """One past the last row."""
    angle: float
    """rad, of the table."""

    @property
    def rows(self) -> str:
        """The rows as people count."""
        return say("rows {first} to {last}", first=self.first + 1, last=self.last)


def interval(session: CalibrationSession) -> float:
    """Time of a row, s; ScheduleError where rows are not evenly spaced."""
    if session.time is None:
        assert session.sample_rate is not None
        return 1.0 / session.sample_rate
    steps = np.diff(session.time)
    if len(steps) < 2:
        raise ScheduleError(
            [problem_at("time_s", "has {time}; a time series is needed", time=counted(len(session.time), "row"))]
        )
    usual = float(np.median(steps))
    uneven = np.flatnonzero(np.abs(steps - usual) > UNEVEN * usual)
    if usual <= 0 or len(uneven):
        row = int(uneven[0]) + 2 if len(uneven) else 2
        parts = {"steps": f"{steps[row - 2]:.6g}", "interval": f"{usual:.6g}"}
        message = say("is {steps} s after the row before, where rows are {interval} s apart", **parts)
        raise ScheduleError(
            [
                problem_at(
                    "time_s",
                    "{message}; give evenly spaced rows without gaps ({uneven} uneven)",
                    row,
                    message=message,
                    uneven=len(uneven),
                )
            ]
        )
    return float(session.time[-1] - session.time[0]) / len(steps)


def stops(angle: Array, row: float) -> list[Stop]:
    """Stretches in which the table stands for `SHORTEST` or longer.

    Parameters
    ----------
    angle : (R,) rad, at the end of each row.
    row : time of a row, s.
    """
    reach = max(round(HALF / row), 1)
    padded = np.pad(angle, reach, mode="edge")
    still = np.abs(padded[2 * reach :] - padded[: -2 * reach]) < STILL
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(np.int8)))
    bounds = zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
    return [Stop(a, b, float(np.median(angle[a:b]))) for a, b in bounds if b - a >= max(SHORTEST / row, FEWEST_ROWS)]


def require_positions(stationary: list[Stop]) -> None:
    """ScheduleError unless the table stands at two positions that differ."""
    turns = {round(float(np.degrees(stop.angle)), 1) for stop in stationary}
    separations = [abs(np.exp(1j * stop.angle) - np.exp(1j * stationary[0].angle)) for stop in stationary]
    if not stationary or max(separations) < 2 * np.sin(LEAST_SEPARATION / 2):
        where = (
            say("only at {turn}", turn=joined(", ", (f"{turn:g}°" for turn in sorted(turns)))) if turns else "nowhere"
        )
        advice = say(
            "stop for at least {shortest} s and {fewest_rows} rows at two or more angles, preferably 180° apart",
            shortest=f"{SHORTEST:g}",
            fewest_rows=FEWEST_ROWS,
        )
        raise ScheduleError(
            [problem_at("turn_angle_deg", "the table rests {where}; {advice}", where=where, advice=advice)]
        )


def require_rest(stationary: list[Stop], rates: Array, row: float) -> None:
    """ScheduleError where the gyros turn although the table stands; rates (R, 3) rad/s, ``row`` s."""
    block = max(round(1.0 / row), 1)
    problems = []
    for stop in stationary:
        samples = rates[stop.first : stop.last]
        whole = samples[: len(samples) // block * block].reshape(-1, block, 3).mean(axis=1)
        fastest = float(np.linalg.norm(whole, axis=1).max())
        if fastest > MOVING:
            parts = {"rows": stop.rows, "fastest": f"{np.degrees(fastest):.3g}"}
            problem = say("the table is at rest in {rows}, but the gyros read {fastest} °/s", **parts)
            problems.append(
                problem_at(
                    "turn_angle_deg",
                    "{problem}: the block was moved, or the columns are from different records",
                    problem=problem,
                )
            )
    if problems:
        raise ScheduleError(problems)


def require_turns(stationary: list[Stop], angle: Array, rate_z: Array, row: float) -> None:
    """ScheduleError where the azimuth gyro did not turn as the table did; angle (R,) rad, rate_z (R,) rad/s, row s."""
    problems = []
    for before, after in pairwise(stationary):
        first, last = (before.first + before.last) // 2, (after.first + after.last) // 2
        table = float(angle[last] - angle[first])
        gyro = float(rate_z[first + 1 : last + 1].sum() * row)
        if abs(gyro - table) > DISAGREEMENT[0] + DISAGREEMENT[1] * abs(table):
            parts = {"table": f"{np.degrees(table):+.1f}", "rows_before": before.rows, "rows_after": after.rows}
            problem = say("the table turned {table}° between {rows_before} and {rows_after}", **parts)
            message = say(
                "{problem}, the gyros {gyro}° about the block's Z axis",
                problem=problem,
                gyro=f"{np.degrees(gyro):+.1f}",
            )
            advice = (
                "check the sign and unit of turn_angle_deg, the gyros' scale and range, and that Z is the turn axis"
            )
            problems.append(
                problem_at("turn_angle_deg", "{message}; {advice}", after.first + 1, message=message, advice=advice)
            )
    if problems:
        raise ScheduleError(problems)


def require_level(force: Array, g: float) -> None:
    """ScheduleError unless the mean specific force (3,) at rest, m/s², is gravity, along the turn axis."""
    size = float(np.linalg.norm(force))
    if abs(size - g) > GRAVITY_MISMATCH * g:
        parts = {"size": f"{size:.4g}", "gravity": f"{g:.4g}"}
        message = say("at rest the accelerometers read {size} m/s² where gravity is {gravity}", **parts)
        raise ScheduleError([Problem("sensors", f"{message}; check nominal_scale and nominal_offset")])
    tilt = float(np.arccos(np.clip(force[2] / size, -1, 1)))
    if tilt > STEEPEST:
        message = say(
            "the turn axis (the block's Z) is {tilt}° off the upward vertical", tilt=f"{np.degrees(tilt):.1f}"
        )
        raise ScheduleError(
            [
                problem_at(
                    "table",
                    "{message}; alignment needs it within {steepest}°",
                    message=message,
                    steepest=f"{np.degrees(STEEPEST):g}",
                )
            ]
        )
