"""A session as the search for its curves takes it up: dimensionless rows, and a start without temperature."""

from dataclasses import dataclass, replace

import numpy as np

from estimator.applied_vector import gravity
from estimator.arrays import unit
from estimator.calibration.free import UNSTATED_NOISE, accelerometer_rows
from estimator.calibration.free.schedule import GENERIC, classified
from estimator.calibration.free.solve import search
from estimator.calibration.free.start import start
from estimator.errors import Problem, ScheduleError
from estimator.forward import measured
from estimator.message import say
from estimator.session import Array, CalibrationSession
from estimator.thermal.course import TemperatureCourse, course_of
from estimator.thermal.model import State, ThermalRows
from estimator.thermal.solve import is_determined

WITHOUT_WEIGHT = 1e6
"""One sigma, relative to g (1 rad/s), of readings that take no part: as if they were not there, and still finite."""

FORMS = 2
"""Columns of the bias' basis beside the polynomials: a loop, a lag."""


@dataclass(frozen=True, eq=False)
class Begun:
    """A session as the search takes it up. k sensors that answer, among the session's m."""

    session: CalibrationSession
    course: TemperatureCourse
    at: Array
    """(k,) places of the sensors."""
    unit: Array
    """(k,) input at y = 1: m/s²; of gyros 1 rad/s."""
    stated: bool
    """Whether the noise is."""
    rows: ThermalRows
    state: State
    order: int
    """Highest that the rows support."""

    def free(self, *, quadratic: bool) -> Array:
        """(k, p) bool, what is estimated to begin with: polynomials of highest order, no forms."""
        free = np.zeros((len(self.at), self.rows.elements), dtype=bool)
        q, live = self.order + 1, ~self.rows.gyro
        free[:, q : 2 * q] = True
        free[np.ix_(live, np.array([*range(q), -2, -1]))] = True
        free[live, -3] = quadratic
        return free


def begin(session: CalibrationSession) -> Begun:
    """Rows, a start and the highest order that they support; ScheduleError where they support none."""
    course = course_of(session)
    live, dead, gyro = classified(session)
    at = np.flatnonzero(~dead)
    size = np.where(gyro, 1.0, gravity(session.site) if live.any() else 1.0)
    rows, state, stated = without_temperature(session, live, gyro, size)
    rows = replace(rows, y=rows.y[:, at], sigma=rows.sigma[:, at], nominal_axes=rows.nominal_axes[at], gyro=gyro[at])
    state = replace(
        state, scale=state.scale[at], bias=state.bias[at], quadratic=state.quadratic[at], axes=state.axes[at]
    )
    for order in range(course.order, 0, -1):
        basis = course.basis(order)
        begun = Begun(
            session=session,
            course=course,
            at=at,
            unit=size[at],
            stated=stated,
            rows=replace(rows, scale_basis=basis, bias_basis=np.pad(basis, ((0, 0), (0, FORMS)))),
            state=replace(
                state,
                scale=np.pad(state.scale, ((0, 0), (0, order))),
                bias=np.pad(state.bias, ((0, 0), (0, order + FORMS))),
            ),
            order=order,
        )
        if is_determined(begun.rows, begun.state, begun.free(quadratic=False)):
            return begun
    problem = say(
        "the orientations do not determine bias and scale factor over temperature; repeat {number} or more, spread "
        "over the whole sphere, at every temperature, or six with their directions",
        number=GENERIC,
    )
    raise ScheduleError([Problem("table", problem)])


def without_temperature(
    session: CalibrationSession, live: Array, gyro: Array, size: Array
) -> tuple[ThermalRows, State, bool]:
    """All sensors' rows without a basis, a state with constants alone, and whether the noise is stated.

    Parameters
    ----------
    live, gyro : (m,) bool, accelerometers that answer, and gyros.
    size : (m,) input at y = 1, m/s² (rad/s).
    """
    y, sigma = dimensionless(session, size)
    setting, axes = settings_of(session), np.stack([s.nominal_axis for s in session.sensors])
    first_row, R = np.unique(setting, return_index=True)[1], len(y)
    gain, offset, now = np.ones(len(size)), y.mean(axis=0), axes.copy()
    towards, directions, prior = np.tile([0.0, 0.0, 1.0], (R, 1)), np.zeros((R, 3)), np.zeros(R)
    if live.any():
        model, known = accelerometer_rows(session, live, float(size[live][0]))
        first = search(model, start(model), quadratic=False).unknowns
        gain[live], now[live] = np.exp(first.log_scale), first.axes
        offset[live] = first.offset / gain[live]
        towards, directions, prior = first.directions, model.directions, model.prior
        sigma[:, live] = model.sigma if known else np.nan
    out = np.isinf(session.standard_errors)
    sigma[out] = WITHOUT_WEIGHT
    stated = bool((np.isfinite(sigma) & (sigma > 0))[:, live | gyro].all())
    if not stated:
        usual = np.where(gyro, y.std(axis=0) + np.finfo(float).eps, UNSTATED_NOISE) * np.ones_like(y)
        sigma = np.where(out, WITHOUT_WEIGHT, usual)
    middle = np.zeros((len(first_row), 3))
    np.add.at(middle, setting, towards)
    none = np.zeros((R, 0))
    rows = ThermalRows(y, sigma, setting, directions[first_row], prior[first_row], axes, gyro, none, none)
    zero = np.zeros(len(size))
    return rows, State(gain[:, None], offset[:, None], zero, now, unit(middle), np.zeros_like(middle)), stated


def dimensionless(session: CalibrationSession, size: Array) -> tuple[Array, Array]:
    """Readings over nominal scale and ``size`` (m,), m/s² (rad/s), and one sigma of them with the bias' repeatability,
    NaN where none is stated: (R, m) each."""
    readings, errors = measured(session)
    scale = np.array([s.nominal_scale for s in session.sensors])
    repeatability = np.array([s.bias_repeatability for s in session.sensors])
    return readings / scale / size, np.hypot(errors / scale, repeatability) / size


def settings_of(session: CalibrationSession) -> Array:
    """(R,) number of the setting of a row: neighbours of one label of ``position`` share it."""
    label = session.position
    if label is None:
        return np.arange(len(session.readings))
    anew = np.r_[True, (np.diff(label) != 0) | (label[1:] < 0)]
    return np.cumsum(anew) - 1
