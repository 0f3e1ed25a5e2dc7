"""Mounting errors of a block's gyros on a single-axis rate table: whole turns both ways.

Over a whole turn about the block's Z axis the Earth's horizontal rotation averages out of every gyro; what is left of a
turn at table rate w is, for the axes x, y, z of the reduced block,

    x: ε_x + E_xz·w        y: ε_y + E_yz·w        z: ε_z + Ω sin L + (1 + κ)·w

E and κ follow from turns of different rates, at best of both directions; their difference is free of every bias. Each
whole turn is one row of the regression. Its covariance is that of the stated standard errors, else the turns' scatter
gives it, widened by ν/(ν − 2) as Student's t is. The table's own rate is taken for exact: κ is the scale error against
the table. ε_z needs the latitude and an upright axis. Gross readings are set aside first.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from estimator.alignment.axes import TINY, Triad, triad
from estimator.alignment.positions import interval
from estimator.alignment.results import RateTableResult
from estimator.applied_vector import EARTH_RATE
from estimator.calibration.gross import on_table
from estimator.errors import Problem, ScheduleError, problem_at
from estimator.least_squares import least_squares
from estimator.message import say
from estimator.results import Fit
from estimator.session import GYROSCOPE, RATE_TABLE, Array, CalibrationSession
from estimator.significance import p_value
from estimator.wording import counted

NAMES = ("E_xz", "E_yz", "kappa_z", "eps_x", "eps_y", "eps_z")
UNITS = ("rad", "rad", "1", "rad/s", "rad/s", "rad/s")
"""Units of the quantities that a rate table determines, in the order of its covariance."""
FEWEST_TURNS = 6
"""Whole turns in all; fewer leave no scatter to take the uncertainty from."""
WHOLE = 1e-6
"""Rows by which a whole turn may end early: the rounding of stated rates, not a missing part of a turn."""
MOST = 0.5
"""Part of a turn's rows that must have been measured: a turn mostly of what was expected measures nothing."""
TURN = 2 * np.pi
"""rad."""
DISAGREEMENT = 0.05
"""Part of the table's rate by which the azimuth gyro may differ from it: beyond any scale error; a wrong sign or unit
is far more."""
UNLIKELY = 1e-3
"""Probability of a larger χ² below which the covariance is enlarged: true noise is mistrusted once in a thousand."""


@dataclass(frozen=True, eq=False)
class WholeTurns:
    """Whole turns of the table. T turns."""

    rates: Array
    """(T,) rad/s, of the table."""
    means: Array
    """(T, 3) mean rates of the gyros, block axes, rad/s."""
    times: Array
    """(T,) middle, s."""
    rows: Array
    """(T,) number of rows that were measured, fractions of the last one included."""


def rate_table(session: CalibrationSession) -> RateTableResult:
    """E_xz, E_yz, the azimuth gyro's scale error and the gyros' biases.

    Parameters
    ----------
    session : of programme rate-table.

    Raises
    ------
    ScheduleError : no whole turns, turns in one direction only, too few turns, or gyros that do not follow the table.
    """
    if session.programme != RATE_TABLE:
        raise ScheduleError(
            [
                problem_at(
                    "programme",
                    "is {programme}; a rate table is {rate_table}",
                    programme=session.programme,
                    rate_table=RATE_TABLE,
                )
            ]
        )
    row = interval(session)
    session, measured = without_gross_rows(session, row)
    gyros = triad(session, GYROSCOPE, row, measured)
    turns = whole_turns(session, gyros.values, row, measured)
    _require_both_directions(turns)
    _require_following(turns)
    return _result(session, turns, gyros)


def without_gross_rows(session: CalibrationSession, row: float) -> tuple[CalibrationSession, Array]:
    """The session, rows of ``row`` s, with predictions in place of gross readings, which `set_aside` names; and
    (R,) bool whether every reading of a row was measured."""
    assert session.turn_rate is not None
    azimuth = row * (np.cumsum(session.turn_rate) - session.turn_rate / 2)
    found = on_table(session, azimuth)
    measured = np.asarray(~np.isinf(found.standard_errors).any(axis=1))
    return replace(found, standard_errors=session.standard_errors), measured


def whole_turns(session: CalibrationSession, rates: Array, row: float, measured: Array) -> WholeTurns:
    """Every whole turn of every stretch of one table rate that was ``measured`` (R,) bool in most of its rows; rates
    (R, 3) rad/s, ``row`` s."""
    assert session.turn_rate is not None
    change = np.flatnonzero(np.diff(session.turn_rate)) + 1
    edges = np.concatenate([[0], change, [len(rates)]]).tolist()
    complete, short = [], []
    for first, last in pairwise(edges):
        speed = float(session.turn_rate[first])
        if speed == 0:
            continue
        length = TURN / abs(speed) / row
        count = int((last - first + WHOLE) / length)
        if count == 0:
            part = say(
                "rows {first} to {last} at {speed} °/s cover {length} of a turn",
                first=first + 1,
                last=last,
                speed=f"{np.degrees(speed):g}",
                length=f"{(last - first) / length:.2f}",
            )
            short.append(problem_at("turn_rate_deg_s", "{part}; turn through whole turns", first + 1, part=part))
        complete += [(speed, first + k * length, first + (k + 1) * length) for k in range(count)]
    if not complete:
        raise ScheduleError(short or [Problem("turn_rate_deg_s", "the table never turns; give its rate in every row")])
    speeds, start, stop = np.array(complete).T
    total = np.vstack([np.zeros(4), np.cumsum(np.column_stack([rates, measured]), axis=0)])
    summed, length = _at(total, stop) - _at(total, start), stop - start
    mostly = summed[:, 3] > MOST * length
    return WholeTurns(
        rates=speeds[mostly],
        means=summed[mostly, :3] / length[mostly, None],
        times=row * (start + stop)[mostly] / 2,
        rows=summed[mostly, 3],
    )


def _at(total: Array, place: Array) -> Array:
    """The running sums (R + 1, 4) at fractions of rows (T,)."""
    order = np.arange(len(total))
    return np.stack([np.interp(place, order, column) for column in total.T], axis=1)


def _require_both_directions(turns: WholeTurns) -> None:
    for sign, word in ((1, "positive"), (-1, "negative")):
        if not (sign * turns.rates > 0).any():
            message = say(
                "no whole turn at a {word} rate; turn in both directions, so that biases and the Earth's rotation "
                "cancel",
                word=word,
            )
            raise ScheduleError([Problem("turn_rate_deg_s", message)])
    if len(turns.rates) < FEWEST_TURNS:
        held = counted(len(turns.rates), "whole turn")
        parts = {"held": held, "fewest_turns": FEWEST_TURNS}
        message = say("contains {held}; at least {fewest_turns} are needed to know their scatter", **parts)
        raise ScheduleError([Problem("turn_rate_deg_s", message)])


def _require_following(turns: WholeTurns) -> None:
    disagrees = np.abs(turns.means[:, 2] - turns.rates) > DISAGREEMENT * np.abs(turns.rates) + EARTH_RATE
    if disagrees.any():
        worst = int(np.argmax(disagrees))
        problem = say("the table turns at {rate} °/s", rate=f"{np.degrees(turns.rates[worst]):+g}")
        parts = {"problem": problem, "rate": f"{np.degrees(turns.means[worst, 2]):+.4g}"}
        message = say("{problem}, the gyros at {rate} °/s about the block's Z axis", **parts)
        advice = "check the sign and unit of turn_rate_deg_s, the gyros' scale and range, and Z, the table's axis"
        raise ScheduleError([problem_at("turn_rate_deg_s", "{message}; {advice}", message=message, advice=advice)])


def _result(session: CalibrationSession, turns: WholeTurns, gyros: Triad) -> RateTableResult:
    weight = np.sqrt(turns.rows)
    design = np.column_stack([turns.rates, np.ones(len(turns.rates))])
    beyond = turns.means - turns.rates[:, None] * [0.0, 0.0, 1.0]
    solved = least_squares(weight[:, None] * design, weight[:, None] * beyond)
    residuals, inverse = beyond - design @ solved.value, solved.covariance
    weighted = weight[:, None] * residuals
    dof = len(turns.rates) - 2
    scatter = weighted.T @ weighted / dof
    rms = float(np.sqrt(np.mean(residuals**2)))
    row_covariance, fit = _noise(gyros, scatter, dof, rms, float(np.sqrt(inverse[0, 0])))
    estimate = solved.value.ravel()
    covariance = np.kron(inverse, row_covariance * fit.covariance_factor)
    if session.site.latitude is None:
        estimate[5], covariance[5], covariance[:, 5] = np.nan, np.nan, np.nan
    else:
        estimate[5] -= EARTH_RATE * np.sin(session.site.latitude)
    return RateTableResult(
        unit=session.unit,
        names=NAMES,
        units=UNITS,
        estimate=estimate,
        covariance=covariance,
        turn_rates=turns.rates,
        turn_times=turns.times,
        residuals=residuals,
        residual_sigma=np.sqrt(np.diag(row_covariance)) / weight[:, None],
        fit=fit,
        set_aside=session.set_aside,
    )


def _noise(gyros: Triad, scatter: Array, dof: int, rms: float, leverage: float) -> tuple[Array, Fit]:
    """Covariance (3, 3) of a row, (rad/s)², and how the turns scatter about the model.

    scatter : (3, 3) of the turns' residuals over one row, (rad/s)²; rms : of the residuals, rad/s; leverage : sigma of
    E_xz for a row of sigma 1.
    """
    stated = gyros.row_covariance
    covariance = (scatter if stated is None else stated) + TINY**2 * np.eye(3)
    axes = 3 if stated is not None else 1
    chi2 = axes * dof * float(np.trace(np.linalg.solve(covariance, scatter))) / 3
    chance = None if stated is None else float(p_value(chi2, axes * dof))
    unlikely = chance is not None and chance < UNLIKELY
    student = dof / (dof - 2) if stated is None else 1.0
    fit = Fit(
        chi2=chi2,
        dof=axes * dof,
        p_value=chance,
        residual_rms=rms,
        noise="estimated" if stated is None else "stated",
        covariance_factor=max(chi2 / (axes * dof), 1.0) if unlikely else student,
        rank=6,
        parameters=6,
        weakest=("E_xz", leverage * float(np.sqrt(covariance[0, 0]))),
        iterations=1,
        converged=True,
    )
    return covariance, fit
