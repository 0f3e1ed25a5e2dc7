"""Grossly wrong readings, found before anything is fitted finely, and set aside.

A zero, a lost sign, a decimal point, a neighbour's column or an unplugged connector spoils a least-squares fit, and
with it everything that is judged by the fit. So every reading is first held against what the rest of the session
predicts for it, in a robust fit of its own: `gross_linear` where the readings are linear in known functions (on a
stand, on a rate table), `gross_orientations` where every orientation is unknown. What stands far outside both the noise
and everything smooth, alone in its row and its sensor (`gross_choice`), takes no part: its variance is infinite, and in
its place stands what was expected. The robust fit is made only where a plain one leaves something that stands out.
Source: Rousseeuw & Leroy 1987, Robust Regression and Outlier Detection; Hadi & Simonoff 1993, JASA 88, 1264.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from estimator.applied_vector import EARTH_RATE, STANDARD_GRAVITY
from estimator.calibration.gross_choice import GrossChoice, chosen, stuck_across
from estimator.calibration.gross_linear import harmonics, live, nothing_predicted, regression, sticks_out
from estimator.calibration.gross_slips import stuck
from estimator.on_demand import function_on_demand
from estimator.session import ACCELEROMETER, RATE_TABLE, TWO_AXIS_STAND, Array, CalibrationSession, SetAside

if TYPE_CHECKING:
    from estimator.calibration.gross_orientations import accelerometers_predicted
else:
    accelerometers_predicted = function_on_demand(
        "estimator.calibration.gross_orientations", "accelerometers_predicted"
    )


def without_gross(sessions: Sequence[CalibrationSession]) -> list[CalibrationSession]:
    """Averaged sessions of one programme and schedule, each with its gross readings set aside."""
    first = sessions[0]
    if all(session.set_aside for session in sessions):
        return list(sessions)
    if first.programme != TWO_AXIS_STAND:
        return [session if session.set_aside else in_orientations(session) for session in sessions]
    basis = harmonics(first)
    readings = np.stack([session.readings for session in sessions])
    errors = np.stack([stated(session) for session in sessions])
    suspicious = np.asarray((sticks_out(basis, readings, errors) | stuck(readings).any(axis=-2)).any(axis=-1))
    return [
        on_stand(session, basis) if doubt and not session.set_aside else session
        for session, doubt in zip(sessions, suspicious, strict=True)
    ]


def on_stand(session: CalibrationSession, basis: Array) -> CalibrationSession:
    """A session on a stand without its gross readings; ``basis`` (R, p) as of `harmonics`."""
    predicted = regression(basis, session.readings, stated(session), stuck(session.readings))
    return with_set_aside(session, chosen(session, predicted))


def on_table(session: CalibrationSession, azimuth: Array) -> CalibrationSession:
    """A session on a rate table, at ``azimuth`` (R,) rad, without its gross readings: each gyro reads its bias, a part
    of the table's rate and of the Earth's level rotation."""
    assert session.turn_rate is not None
    u, errors = session.readings, stated(session)
    still = stuck_across(u, session.turn_rate)
    basis = live(np.column_stack([np.ones(len(u)), session.turn_rate, np.sin(azimuth), np.cos(azimuth)]))
    if not (sticks_out(basis, u, errors) | still.any(axis=0)).any():
        return session
    return with_set_aside(session, chosen(session, regression(basis, u, errors, still)))


def in_orientations(session: CalibrationSession) -> CalibrationSession:
    """The session in unknown orientations, without its gross readings: accelerometers are judged by each other and
    gravity, gyros by their own rest.
    """
    u, gyro = session.readings, np.array([s.kind != ACCELEROMETER for s in session.sensors])
    predicted = nothing_predicted(u)
    row_suspects: dict[int, tuple[int, ...]] = {}
    if gyro.any():
        courses = [np.ones(len(u))]
        if session.temperature is not None:
            warmth = session.temperature - session.temperature.mean()
            courses += [warmth, warmth**2]
        basis, errors = live(np.column_stack(courses)), stated(session)
        if sticks_out(basis, u[None], errors[None])[0, gyro].any():
            of_gyros = regression(basis, u[:, gyro], errors[:, gyro], stuck(u)[:, gyro])
            predicted = predicted.with_sensors(gyro, of_gyros)
    if not gyro.all():
        found = accelerometers_predicted(session, stuck(u))
        predicted, row_suspects = found.merged_into(predicted) if found else (predicted, {})
    return with_set_aside(session, chosen(session, predicted, row_suspects))


def stated(session: CalibrationSession) -> Array:
    """(R, m) one sigma of every reading by the file, reading units; NaN where it states none."""
    unit = per_input(session)
    gyro = np.array([s.kind != ACCELEROMETER for s in session.sensors])
    more = (unit * [s.bias_repeatability for s in session.sensors]) ** 2
    if session.count_time is not None:
        more = more + np.where(gyro, session.quantisation, 0.0)
    if session.programme not in (TWO_AXIS_STAND, RATE_TABLE):
        more = more + np.where(gyro, (unit * EARTH_RATE) ** 2 / 3, 0.0)
    elif session.tilt_error is not None:
        more = more + np.where(gyro, 0.0, (unit * STANDARD_GRAVITY * session.tilt_error[:, None]) ** 2)
    return np.asarray(np.sqrt(session.standard_errors**2 + more))


def per_input(session: CalibrationSession) -> Array:
    """(m,) reading units per m/s² (rad/s), by the nominal scales."""
    time = session.count_time or 1.0
    return np.array([s.nominal_scale * (1.0 if s.kind == ACCELEROMETER else time) for s in session.sensors])


def with_set_aside(session: CalibrationSession, choice: GrossChoice) -> CalibrationSession:
    """The session with what was chosen set aside."""
    if not choice.at.any():
        return session
    readings, errors = session.readings.copy(), session.standard_errors.copy()
    known = choice.at & np.isfinite(choice.predicted.value)
    readings[known] = choice.predicted.value[known]
    errors[choice.at] = np.inf
    return replace(session, readings=readings, standard_errors=errors, set_aside=named(session, choice))


def named(session: CalibrationSession, choice: GrossChoice) -> tuple[SetAside, ...]:
    """The readings set aside, by row; a stretch of one reading is one thing."""
    u, unit, predicted = session.readings, per_input(session), choice.predicted
    found, done = list[SetAside](), np.zeros(u.shape, dtype=bool)
    for j, i in np.argwhere(choice.at):
        suspects = choice.suspects.get(int(j), ())
        if (int(j), int(i)) not in choice.slips or done[j, i] or (suspects and int(i) != suspects[0]):
            continue
        last = int(j)
        while last + 1 < len(u) and choice.at[last + 1, i] and u[last + 1, i] == u[j, i] and not suspects:
            last += 1
        done[j : last + 1, i] = True
        found.append(
            SetAside(
                sensor=session.sensors[i].name,
                row=int(j) + 1,
                last_row=last + 1,
                reading=float(u[j, i]),
                expected=float(predicted.value[j, i]),
                size=float((u[j, i] - predicted.value[j, i]) / unit[i]),
                sigma=float(predicted.sigma[j, i] / abs(unit[i])),
                slip=choice.slip(int(j), int(i)),
                suspects=tuple(session.sensors[k].name for k in suspects),
            )
        )
    return tuple(found)
