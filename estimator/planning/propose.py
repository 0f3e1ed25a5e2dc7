"""Propose or judge a session on a two-axis stand: elevation → positions → what it would tell → what it cannot see.

The elevation is the one that leaves the tolerances most room (the largest U/T of all parameters of all sensors is
least); without tolerances, the one with the least mean square of relative scale and axis error, which is what the
paper's (6) minimises for the stand alone. The number of positions is the fewest that reach the tolerances' share.
"""

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize_scalar

from estimator.calibration.stand import calibrate_stand
from estimator.causes import CATALOGUE
from estimator.diagnosis.explanation.detection_limits import limits
from estimator.diagnosis.posterior.explained import begin
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.results import Limit
from estimator.errors import ScheduleError, problem_at
from estimator.planning.elevation import conditioning, gyro_errors, optimal_elevation
from estimator.planning.expected import expected_sigmas, head_kind, input_noise, over_elevation, over_positions, planned
from estimator.planning.positions import optimal_positions
from estimator.planning.results import JudgedParameter, Plan, Request
from estimator.results import PARAMETERS
from estimator.session import ACCELEROMETER, TWO_AXIS_STAND, Array, CalibrationSession

ELEVATIONS = np.radians(np.arange(15.0, 75.1, 2.5))
"""Elevations that the search and the chart cover, rad. Beyond, one of the two parts of the vector hardly changes."""

FEWEST = 6
"""Below five equal steps the second harmonic has no trace; one more leaves something to judge the fit by."""

CUSTOMARY = 24
"""N where no tolerance asks for a number: the middle one of the paper's tables (12, 24, 36)."""

MOST_READINGS = 1728
"""Readings (12 sensors, 72 positions, both runs) beyond which the signatures of all causes at all places, which grow as
their square, would fill the memory; up to here they take less than 400 MB."""

NEARLY = 1.1
"""Largest ratio to the result with the most positions, where no number reaches the tolerances: the fewest positions
within it are taken, since a tenth of uncertainty is not worth twice the time on the stand.
"""


def plan(like: CalibrationSession, request: Request | None = None, *, sigma: Array | None = None) -> Plan:
    """A session on the stand, proposed where the request leaves it open, with what it would tell.

    Parameters
    ----------
    like : a measured session or a schedule: sensors, stand, site, mounting, noise.
    request : see `Request`.
    sigma : (m,) one sigma of a reading at the input, m/s² (rad/s), bias repeatability included; None: as ``like``
        states or shows.

    Raises
    ------
    ScheduleError : ``like`` is not on a two-axis stand.
    """
    if like.programme != TWO_AXIS_STAND:
        raise ScheduleError(
            [problem_at("programme", "{programme} has no stand; plan it by its orientations", programme=like.programme)]
        )
    request = request or Request()
    sigma = input_noise(like) if sigma is None else sigma
    angle = best_elevation(like, request, sigma) if request.elevation is None else request.elevation
    N = request.positions or fewest_positions(like, angle, request, sigma)
    session = planned(like, angle, N, request, sigma)
    numbers = np.unique(np.concatenate([np.arange(6, 37, 3), [N, 48, request.most_positions]]))
    return Plan(
        schedule=session,
        request=request,
        elevation=angle,
        formula_elevation=by_formula(session, N),
        positions=N,
        seconds=request.time_per_position * len(session.readings),
        conditioning=conditioning(session),
        expected=calibrate_stand([session])[0],
        judged=judged(session, request),
        limits=detectable(session),
        optimal=optimal_positions(session, sigma),
        over_positions=over_positions(like, angle, numbers, request, sigma),
        over_elevation=over_elevation(like, ELEVATIONS, N, request, sigma),
    )


def tolerances(session: CalibrationSession, request: Request) -> Array:
    """(m, 4) SI, relative for scale; infinite where not judged."""
    gyro = request.gyro_wanted or request.wanted
    mixed = len({s.kind for s in session.sensors}) > 1
    return np.stack([(gyro if mixed and s.kind != ACCELEROMETER else request.wanted).row() for s in session.sensors])


def tightness(session: CalibrationSession, request: Request) -> float:
    """Largest U/T; without tolerances the mean square of relative scale and axis error. Infinite where not observed."""
    total = expected_sigmas(session)[0]
    T = tolerances(session, request)
    requested = np.isfinite(T)
    used = (
        request.coverage * total[requested] / T[requested] if requested.any() else (total[:, [0, 3]] ** 2).sum(axis=1)
    )
    figure = used.max() if requested.any() else used.mean()
    return float(figure) if np.isfinite(figure) else float("inf")


def best_elevation(like: CalibrationSession, request: Request, sigma: Array) -> float:
    """The elevation of least `tightness`, to about 0.1°, rad; sigma (m,) as in `plan`, m/s² (rad/s)."""
    N = request.positions or CUSTOMARY

    def figure(angle: float) -> float:
        return tightness(planned(like, angle, N, request, sigma), request)

    return least(figure, ELEVATIONS)


def least(figure: Callable[[float], float], grid: Array) -> float:
    """Minimises a figure: the place of the minimum in the grid's unit, the best of ``grid`` (k,), then between its
    neighbours.

    The middle where all is infinite.
    """
    values = np.array([figure(float(a)) for a in grid])
    if not np.isfinite(values).any():
        return float(np.median(grid))
    k = int(np.argmin(values))
    low, high = grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]
    minimum = minimize_scalar(figure, bounds=(low, high), method="bounded", options={"xatol": np.radians(0.05)})
    return float(minimum.x) if minimum.fun <= values[k] else float(grid[k])


def fewest_positions(like: CalibrationSession, angle: float, request: Request, sigma: Array) -> int:
    """The least N that reaches the share of every tolerance; see `NEARLY` where none does.

    angle : rad; sigma : (m,) as in `plan`, m/s² (rad/s).
    """
    if not np.isfinite(tolerances(like, request)).any():
        return CUSTOMARY

    def figure(N: int) -> float:
        return tightness(planned(like, angle, N, request, sigma), request)

    limit = max(request.share, NEARLY * figure(request.most_positions))
    low, high = FEWEST, request.most_positions
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if figure(middle) <= limit else (middle + 1, high)
    return low


def by_formula(session: CalibrationSession, N: int) -> float:
    """(6), for gyros with (31), rad."""
    assert session.stand is not None
    errors = session.stand.sigma
    if head_kind(session) != ACCELEROMETER:
        errors = gyro_errors(errors, session.site.latitude or 0.0)
    return optimal_elevation(errors, N)


def judged(session: CalibrationSession, request: Request) -> tuple[JudgedParameter, ...]:
    """Every parameter of every sensor against its tolerance."""
    total, steady = expected_sigmas(session)
    T = tolerances(session, request)
    return tuple(
        JudgedParameter(
            sensor.name,
            sensor.kind,
            parameter,
            float(total[i, k]) if np.isfinite(total[i, k]) else None,
            float(steady[i, k]) if np.isfinite(steady[i, k]) else None,
            float(T[i, k]) if np.isfinite(T[i, k]) else None,
            verdict(float(total[i, k]), float(T[i, k]), request),
        )
        for i, sensor in enumerate(session.sensors)
        for k, parameter in enumerate(PARAMETERS)
    )


def verdict(sigma: float, tolerance: float, request: Request) -> str:
    """The verdict on an expected sigma for a tolerance."""
    if np.isinf(tolerance):
        return "not judged"
    used = request.coverage * sigma / tolerance
    if used <= request.share * (1 + 1e-9):
        return "enough"
    return "usable" if used <= 1 else "undecidable"


def detectable(session: CalibrationSession) -> tuple[Limit, ...]:
    """Detection limits of the whole catalogue for a planned session; none beyond `MOST_READINGS`."""
    if session.readings.size > MOST_READINGS:
        return ()
    return limits(begin(baseline_of(session), (), CATALOGUE))
