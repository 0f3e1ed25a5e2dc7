"""Builds one `Calibration` a session from the solution of sessions on a two-axis stand.

What can be done for all sessions at once is done on arrays; what is left builds the result of one session, when it is
read.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from math import isnan
from typing import Any

import numpy as np

from estimator.applied_vector import Geometry
from estimator.calibration.observability import Spectrum, known_bias_quadratic, known_linear
from estimator.calibration.refine import RefinedFit
from estimator.coverage import finite, positions_to_add
from estimator.forward import projected, slope
from estimator.parameters import ELEMENTS, names, units
from estimator.results import PARAMETERS, Calibration, Estimate, Fit, KnownCombination, Residuals, SensorCalibration
from estimator.session import Array, CalibrationSession

METHOD = "two-axis-stand/maximum-likelihood"
"""Name of the method in results."""


@dataclass(frozen=True, eq=False)
class Solved:
    """S sessions of one schedule, solved and judged. R rows, m sensors."""

    y: Array
    """(S, R, m) readings, offset taken off, reading units."""
    geometry: Geometry
    fitted: RefinedFit
    spectrum: Spectrum
    stated: Array
    """(S,) whether all noise was stated."""
    p_value: Array
    """(S,)"""
    factor: Array
    """(S,) factor by which the stated row noise was enlarged."""
    freedom: Array
    """(S, P) degrees of freedom of the variances: infinite where the noise is known, NaN where not determined."""


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
    axis_dof: Array
    """(S, m) degrees of freedom of the axes, without unit: infinite where the noise is known."""


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
        tangents=p.axis_tangents,
        residual_sigma=np.where(
            np.isnan(solved.freedom[:, None, ::5]), np.nan, np.sqrt(grown * (fitted.variance + swing * swing))
        ),
        seen=seen,
        axis_dof=solved.freedom.reshape(S, m, 5)[..., 3:].min(axis=-1),
    )


@dataclass(frozen=True, eq=False)
class Reports:
    """The reports of sessions of one schedule, worked out when the first of them is read."""

    sessions: tuple[CalibrationSession, ...]
    solved: Solved

    @cached_property
    def table(self) -> Tables:
        """The numbers of all results."""
        return tables(self.solved)

    @cached_property
    def fits(self) -> list[tuple[Any, ...]]:
        """The line of `qualities` for every session."""
        return qualities(self.solved)

    def __getitem__(self, k: int) -> Calibration:
        """The result of session k."""
        session, solved, table = self.sessions[k], self.solved, self.table
        return Calibration(
            unit=session.unit,
            method=METHOD,
            sensors=sensor_results(k, session, solved, table),
            names=names(session.sensors),
            units=units(session.sensors),
            covariance=table.covariance[k],
            repeatability=table.repeatability[k],
            fit=quality(k, session, solved, self.fits[k]),
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
            site=session.site,
            screening=session.screening,
            set_aside=session.set_aside,
        )


def more_rows(k: int, solved: Solved) -> int:
    """Positions to add to session k so that each sensor whose noise cannot be estimated has it to `WANTED` freedom."""
    untold = np.isnan(solved.freedom[k]).reshape(-1, 5).any(axis=1)
    missing = 5 * int(untold.sum()) - int(solved.spectrum.observed[k][untold].sum())
    return positions_to_add(-missing, int(untold.sum()))


def sensor_results(k: int, session: CalibrationSession, solved: Solved, table: Tables) -> tuple[SensorCalibration, ...]:
    """The sensors of session k."""
    p = solved.fitted.parameters
    values = zip(p.scale[k].tolist(), p.bias[k].tolist(), p.quadratic[k].tolist(), strict=True)
    seen, sigma, steady = table.seen[k].tolist(), table.sigma[k].tolist(), table.steady[k].tolist()
    dofs, axis_dof = solved.freedom[k].reshape(-1, 5).tolist(), table.axis_dof[k].tolist()
    results = []
    for i, (sensor, row) in enumerate(zip(session.sensors, values, strict=True)):
        angles = slice(5 * i + 3, 5 * i + 5)
        scale, bias, quadratic = (
            estimate(value, sigma[i][e], steady[i][e], dofs[i][e]) if seen[i][e] else Estimate(None, None)
            for e, value in enumerate(row)
        )
        results.append(
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
                axis_dof=finite(axis_dof[i]),
            )
        )
    return tuple(results)


def estimate(value: float, sigma: float, repeatability: float, dof: float) -> Estimate:
    """A value with its one sigmas, of one unit, and their degrees of freedom, NaN where the noise is unknown."""
    return Estimate(value, None) if isnan(dof) else Estimate(value, sigma, repeatability, finite(dof))


def known(k: int, i: int, solved: Solved, seen: list[bool]) -> tuple[KnownCombination, ...]:
    """The combinations that stand in for what is not observable of sensor i in session k."""
    known_combinations = combinations(k, i, solved, seen)
    if np.isnan(solved.freedom[k, 5 * i]):
        return tuple(replace(combination, sigma=None) for combination in known_combinations)
    return known_combinations


def combinations(k: int, i: int, solved: Solved, seen: list[bool]) -> tuple[KnownCombination, ...]:
    """The combinations, with their sigmas under the noise that was used."""
    blind = {element for element, s in zip(PARAMETERS, seen, strict=False) if not s}
    if blind == {"quadratic"}:
        return ()
    p, factor = solved.fitted.parameters, float(solved.factor[k])
    if blind == {"bias", "quadratic"}:
        information = solved.fitted.information[k, i] / factor
        norm = float(solved.geometry.norm[i])
        known_combination = known_bias_quadratic(information, float(p.bias[k, i]), float(p.quadratic[k, i]), norm)
        return () if known_combination is None else (known_combination,)
    return known_linear(solved.y[k, :, i], factor * solved.fitted.variance[k, :, i], p.at(k), solved.geometry, i)


def qualities(solved: Solved) -> list[tuple[Any, ...]]:
    """χ², rank, degrees of freedom, p-value, residual, whether all noise was stated, the factor, and the weakest
    direction (its sensor, its element and its sigma) of every session.
    """
    fitted, seen = solved.fitted, solved.spectrum
    used = fitted.readings
    squares = np.where(np.isfinite(fitted.variance), fitted.residual**2, 0.0).sum(axis=(1, 2))
    rms = np.sqrt(squares / np.maximum(used, 1))
    columns = (fitted.chi2, seen.rank, used - seen.rank, solved.p_value, rms, solved.stated, solved.factor)
    return list(zip(*(c.tolist() for c in (*columns, *seen.weakest)), strict=True))


def quality(k: int, session: CalibrationSession, solved: Solved, fit: tuple[Any, ...]) -> Fit:
    """Quality of fit of session k, from its line of `qualities`."""
    chi2, rank, dof, p_value, residual_rms, stated, factor, sensor, lead, sigma = fit
    return Fit(
        chi2=chi2,
        dof=dof,
        p_value=p_value if stated else None,
        residual_rms=residual_rms,
        noise="stated" if stated else "estimated",
        covariance_factor=factor,
        rank=rank,
        parameters=5 * len(session.sensors),
        weakest=(f"{session.sensors[sensor].name}.{ELEMENTS[lead]}", sigma),
        iterations=int(solved.fitted.iterations[k]),
        converged=bool(solved.fitted.converged[k]),
        positions_to_add=more_rows(k, solved) if np.isnan(solved.freedom[k]).any() else 0,
    )
