"""From the solution of sessions on a two-axis stand to one `Calibration` a session.

What can be done for all sessions at once is done on arrays; what is left builds the result of one session.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.applied_vector import Geometry
from estimator.arrays import tangents
from estimator.calibration.observability import Spectrum, known_bias_quadratic, known_linear
from estimator.calibration.refine import Fitted
from estimator.coverage import finite, positions_to_add
from estimator.forward import projected, slope
from estimator.parameters import ELEMENTS, names, units
from estimator.results import PARAMETERS, Calibration, Estimate, Fit, KnownCombination, Residuals, SensorCalibration
from estimator.session import Array, CalibrationSession

METHOD = "two-axis-stand/maximum-likelihood"
"""As results name it."""


@dataclass(frozen=True, eq=False)
class Solved:
    """S sessions of one schedule, solved and judged. R rows, m sensors."""

    y: Array
    """(S, R, m) readings, offset taken off, reading units."""
    geometry: Geometry
    fitted: Fitted
    spectrum: Spectrum
    stated: Array
    """(S,) whether all noise was stated."""
    p_value: Array
    """(S,)"""
    factor: Array
    """(S,) by which the stated row noise was enlarged."""
    freedom: Array
    """(S, P) degrees of freedom of the variances: infinite where the noise is known, NaN where nothing tells it."""


@dataclass(frozen=True, eq=False)
class Tables:
    """The numbers of all results in SI, over the sessions; NaN where not observable. P = 5 m."""

    covariance: Array
    """(S, P, P) total."""
    repeatability: Array
    """(S, P, P)"""
    sigma: Array
    """(S, m, 5) total."""
    steady: Array
    """(S, m, 5) repeatability."""
    tangents: Array
    """(S, m, 3, 2) along which the axes turn, dimensionless."""
    residual_sigma: Array
    """(S, R, m) m/s² (rad/s)."""
    seen: Array
    """(S, m, 5) bool."""


def tables(solved: Solved) -> Tables:
    """Covariances enlarged where the stated noise was not believed, in SI, blanked where nothing is observed."""
    fitted, geometry, grown = solved.fitted, solved.geometry, solved.factor[:, None, None]
    p, seen = fitted.parameters, solved.spectrum.observed
    S, m, _ = seen.shape
    given = seen.reshape(S, -1) & ~np.isnan(solved.freedom)
    factors = np.where(given, p.si_factors(geometry.norm), np.nan)
    to_si = factors[:, :, None] * factors[:, None, :]
    total = (fitted.covariance + (grown - 1.0) * fitted.repeatability) * to_si
    steady = grown * fitted.repeatability * to_si
    swing = slope(p, geometry.n) * projected(p.axis, geometry.beta) * geometry.beta_sigma
    return Tables(
        covariance=total,
        repeatability=steady,
        sigma=np.sqrt(np.diagonal(total, axis1=1, axis2=2)).reshape(S, m, 5),
        steady=np.sqrt(np.diagonal(steady, axis1=1, axis2=2)).reshape(S, m, 5),
        tangents=tangents(p.axis),
        residual_sigma=np.where(
            np.isnan(solved.freedom[:, None, ::5]), np.nan, np.sqrt(grown * (fitted.variance + swing * swing))
        ),
        seen=seen,
    )


def reports(sessions: Sequence[CalibrationSession], solved: Solved) -> list[Calibration]:
    """One `Calibration` a session, in order."""
    table = tables(solved)
    fits = qualities(sessions, solved)
    return [
        Calibration(
            unit=session.unit,
            method=METHOD,
            sensors=sensor_results(k, session, solved, table),
            names=names(session.sensors),
            units=units(session.sensors),
            covariance=table.covariance[k],
            repeatability=table.repeatability[k],
            fit=fits[k],
            residuals=Residuals(
                value=solved.fitted.residual[k],
                sigma=table.residual_sigma[k],
                beta=session.beta,
                flipped=session.flipped,
                time=session.time,
                temperature=session.temperature,
                enlarged_by=float(np.sqrt(solved.factor[k])),
            ),
            gauge="stand",
        )
        for k, session in enumerate(sessions)
    ]


def more_rows(k: int, solved: Solved) -> int:
    """Positions to add to session k so that each sensor whose noise nothing tells knows it to `WANTED` freedom."""
    untold = np.isnan(solved.freedom[k]).reshape(-1, 5).any(axis=1)
    missing = 5 * int(untold.sum()) - int(solved.spectrum.observed[k][untold].sum())
    return positions_to_add(-missing, int(untold.sum()))


def sensor_results(k: int, session: CalibrationSession, solved: Solved, table: Tables) -> tuple[SensorCalibration, ...]:
    """The sensors of session k."""
    p = solved.fitted.parameters
    values = zip(p.scale[k].tolist(), p.bias[k].tolist(), p.quadratic[k].tolist(), strict=True)
    seen, sigma, steady = table.seen[k].tolist(), table.sigma[k].tolist(), table.steady[k].tolist()
    dofs = solved.freedom[k].reshape(-1, 5)
    found = []
    for i, (sensor, own) in enumerate(zip(session.sensors, values, strict=True)):
        angles = slice(5 * i + 3, 5 * i + 5)
        scale, bias, quadratic = (
            estimate(value, sigma[i][e], steady[i][e], dofs[i, e]) if seen[i][e] else Estimate(None, None)
            for e, value in enumerate(own)
        )
        found.append(
            SensorCalibration(
                name=sensor.name,
                kind=sensor.kind,
                scale=scale,
                bias=bias,
                quadratic=quadratic,
                axis=p.axis[k, i] if seen[i][3] else None,
                axis_tangents=table.tangents[k, i],
                axis_covariance=table.covariance[k, angles, angles],
                observable=dict(zip(PARAMETERS, seen[i][:4], strict=True)),
                known=() if all(seen[i]) else known(k, i, solved, seen[i]),
                axis_dof=finite(float(dofs[i, 3:].min())),
            )
        )
    return tuple(found)


def estimate(value: float, sigma: float, repeatability: float, dof: float) -> Estimate:
    """A value with its one sigmas, of one unit, and their degrees of freedom, NaN where nothing tells the noise."""
    return Estimate(value, None) if np.isnan(dof) else Estimate(value, sigma, repeatability, finite(dof))


def known(k: int, i: int, solved: Solved, seen: list[bool]) -> tuple[KnownCombination, ...]:
    """The combinations that stand in for what is not observable of sensor i in session k."""
    found = combinations(k, i, solved, seen)
    if np.isnan(solved.freedom[k, 5 * i]):
        return tuple(replace(combination, sigma=None) for combination in found)
    return found


def combinations(k: int, i: int, solved: Solved, seen: list[bool]) -> tuple[KnownCombination, ...]:
    """The same with the sigmas under the noise that was used."""
    blind = {element for element, s in zip(PARAMETERS, seen, strict=False) if not s}
    if blind == {"quadratic"}:
        return ()
    p, factor = solved.fitted.parameters, float(solved.factor[k])
    if blind == {"bias", "quadratic"}:
        information = solved.fitted.information[k, i] / factor
        norm = float(solved.geometry.norm[i])
        found = known_bias_quadratic(information, float(p.bias[k, i]), float(p.quadratic[k, i]), norm)
        return () if found is None else (found,)
    return known_linear(solved.y[k, :, i], factor * solved.fitted.variance[k, :, i], p.at(k), solved.geometry, i)


def qualities(sessions: Sequence[CalibrationSession], solved: Solved) -> list[Fit]:
    """Quality of fit of every session."""
    fitted, seen = solved.fitted, solved.spectrum
    taking_part = np.isfinite(fitted.variance)
    rms = np.sqrt((fitted.residual**2).sum(axis=(1, 2), where=taking_part) / np.maximum(fitted.readings, 1))
    columns = (fitted.chi2, seen.rank, solved.p_value, rms, solved.stated, solved.factor, *seen.weakest)
    chi2, rank, p_value, residual_rms, stated, factor, sensor, lead, sigma = (c.tolist() for c in columns)
    return [
        Fit(
            chi2=chi2[k],
            dof=int(fitted.readings[k]) - rank[k],
            p_value=p_value[k] if stated[k] else None,
            residual_rms=residual_rms[k],
            noise="stated" if stated[k] else "estimated",
            covariance_factor=factor[k],
            rank=rank[k],
            parameters=5 * len(session.sensors),
            weakest=(f"{session.sensors[sensor[k]].name}.{ELEMENTS[lead[k]]}", sigma[k]),
            iterations=int(fitted.iterations[k]),
            converged=bool(fitted.converged[k]),
            positions_to_add=more_rows(k, solved) if np.isnan(solved.freedom[k]).any() else 0,
        )
        for k, session in enumerate(sessions)
    ]
