"""The result of a thermal programme, in SI: a calibration at the reference temperature, and the curves."""

from dataclasses import replace

import numpy as np
from scipy.linalg import block_diag

from estimator.calibration.free.excess import UNLIKELY
from estimator.calibration.free.knowledge import Knowledge, merged, of_nothing
from estimator.calibration.free.report import report
from estimator.coverage import finite
from estimator.curves import LAG, MISFIT, Curve, SensorCurves, ThermalCurves, ThermalFinding
from estimator.forward import measured
from estimator.parameters import ELEMENTS, SensorParameters
from estimator.results import NOMINAL_AXES, Calibration, Fit
from estimator.session import Array
from estimator.significance import p_value
from estimator.thermal.begin import Begun
from estimator.thermal.orders import Orders
from estimator.thermal.solve import ThermalFit
from estimator.thermal.structure import LEVEL, MisfitForm, Misfits, misfits, places

METHOD = "thermal/maximum-likelihood"
"""Name of the method in results."""


def ratio_of(solved: ThermalFit, *, stated: bool) -> float:
    """Factor by which the covariance grows because the stated noise does not explain the residuals."""
    doubted = stated and solved.dof > 0 and p_value(solved.chi2, solved.dof) < UNLIKELY
    return solved.chi2 / solved.dof if doubted else 1.0


def result(begun: Begun, solved: ThermalFit, orders: Orders, forms: tuple[MisfitForm, ...]) -> Calibration:
    """Everything that was found, in SI."""
    session, ratio = begun.session, ratio_of(solved, stated=begun.stated)
    covariance = solved.covariance * ratio + block_diag(*orders.spread)
    estimated = not begun.stated or ratio > 1
    dof = np.where(estimated, solved.redundancy, np.inf)
    missed = misfits(solved, begun.course, stated=begun.stated)
    curves = curves_of(begun, solved, orders, covariance, missed, dof)
    known = knowledge(begun, solved, covariance, dof)
    parts = [(begun.at, known)]
    silent = np.setdiff1d(np.arange(len(session.sensors)), begun.at)
    if len(silent):
        chosen = [session.sensors[i] for i in silent]
        nominal = np.array([s.nominal_scale for s in chosen]), np.stack([s.nominal_axis for s in chosen])
        parts.append((silent, of_nothing(measured(session)[0][:, silent], *nominal)))
    held = "directions" if solved.rows.prior.any() else NOMINAL_AXES
    plain = report(session, merged(parts), fit_of(begun, solved, known, ratio), held)
    found = tuple(findings(begun, solved, covariance, forms, missed))
    thermal = ThermalCurves(begun.course.reference, begun.course.lowest, begun.course.highest, curves, found)
    return replace(plain, method=METHOD, thermal=thermal)


def fit_of(begun: Begun, solved: ThermalFit, known: Knowledge, ratio: float) -> Fit:
    """Quality of fit of the curves."""
    sigma = np.sqrt(
        np.diagonal(known.covariance) / np.nan_to_num(known.parameters.si_factors(begun.unit), nan=1.0) ** 2
    )
    worst = int(np.nanargmax(sigma))
    parameters = int(solved.free.sum())
    return Fit(
        chi2=solved.chi2,
        dof=solved.dof,
        p_value=float(p_value(solved.chi2, solved.dof)) if begun.stated and solved.dof > 0 else None,
        residual_rms=float(np.sqrt(np.mean(known.residual**2))),
        noise="stated" if begun.stated else "estimated",
        covariance_factor=ratio,
        rank=parameters,
        parameters=parameters,
        weakest=(f"{begun.session.sensors[begun.at[worst // 5]].name}.{ELEMENTS[worst % 5]}", float(sigma[worst])),
        iterations=solved.iterations,
        converged=solved.converged,
    )


def knowledge(begun: Begun, solved: ThermalFit, covariance: Array, dof: Array) -> Knowledge:
    """The five elements of every sensor at the reference temperature, SI."""
    q, (k, p), state, gyro = begun.order + 1, solved.free.shape, solved.state, solved.rows.gyro
    value = begun.course.to_powers(begun.order)[0]
    nominal = np.array([begun.session.sensors[i].nominal_scale for i in begun.at])
    parameters = SensorParameters(
        scale=nominal * (state.scale @ value),
        bias=begun.unit * (state.bias[:, :q] @ value),
        quadratic=state.quadratic / begun.unit,
        axis=state.axes,
    )
    change = np.zeros((k, 5, k, p))
    sensors = np.arange(k)
    change[sensors, 0, sensors, :q] = nominal[:, None] * value
    change[sensors, 1, sensors, q : 2 * q] = begun.unit[:, None] * value
    change[sensors, 2, sensors, p - 3] = 1 / begun.unit
    change[sensors, 3, sensors, p - 2] = change[sensors, 4, sensors, p - 1] = 1.0
    flat = change.reshape(5 * k, k * p)
    observable = np.ones((k, 5), dtype=bool)
    observable[:, 2] = solved.free[:, -3]
    observable[np.ix_(gyro, np.array([0, 2, 3, 4]))] = False
    seen = observable.ravel()
    gain = solved.rows.scale_basis @ state.scale.T
    residual = solved.linear.residual * solved.rows.sigma
    return Knowledge(
        parameters=parameters,
        covariance=np.where(np.outer(seen, seen), flat @ covariance @ flat.T, np.nan),
        observable=observable,
        known=((),) * k,
        residual=residual / gain * begun.unit,
        noise=solved.rows.sigma / gain * begun.unit,
        freedom=np.repeat(dof, 5),
    )


def curves_of(
    begun: Begun, solved: ThermalFit, orders: Orders, covariance: Array, missed: Misfits, dof: Array
) -> tuple[SensorCurves, ...]:
    """The curves of every sensor, SI."""
    q, p = begun.order + 1, solved.free.shape[1]
    powers = begun.course.to_powers(begun.order)
    curves = []
    for i, place in enumerate(begun.at):
        sensor, known = begun.session.sensors[place], covariance[i * p : (i + 1) * p, i * p : (i + 1) * p]
        by_bias, by_scale = begun.unit[i] * powers, sensor.nominal_scale * powers
        scatter, freedom = missed.sigma[i], finite(float(dof[i]))
        bias = Curve(
            coefficients=by_bias @ solved.state.bias[i, :q],
            order=int(orders.order[i, 1]),
            covariance=by_bias @ known[q : 2 * q, q : 2 * q] @ by_bias.T,
            scatter=float(begun.unit[i] * scatter[1]),
            loop=float(abs(begun.unit[i] * solved.state.bias[i, q])),
            dof=freedom,
        )
        if solved.rows.gyro[i]:
            curves.append(SensorCurves(sensor.name, bias))
            continue
        scale = Curve(
            coefficients=by_scale @ solved.state.scale[i],
            order=int(orders.order[i, 0]),
            covariance=by_scale @ known[:q, :q] @ by_scale.T,
            scatter=float(sensor.nominal_scale * scatter[0]),
            dof=freedom,
        )
        curves.append(SensorCurves(sensor.name, bias, scale, by_scale @ known[:q, q : 2 * q] @ by_bias.T))
    return tuple(curves)


def findings(
    begun: Begun, solved: ThermalFit, covariance: Array, forms: tuple[MisfitForm, ...], missed: Misfits
) -> list[ThermalFinding]:
    """Effects that the readings show beside the curves, SI."""
    q, p = begun.order + 1, solved.free.shape[1]
    found = []
    for i, place in enumerate(begun.at):
        name, unit_of = begun.session.sensors[place].name, float(begun.unit[i])
        for form in forms:
            column = places(begun.order)[form.kind]
            if not solved.free[i, q + column]:
                continue
            size = unit_of * (float(np.abs(form.column).max()) if form.kind == LAG else 1.0)
            at = i * p + q + column
            found.append(
                ThermalFinding(
                    kind=form.kind,
                    sensor=name,
                    parameter="bias",
                    amplitude=float(solved.state.bias[i, column]) * size,
                    sigma=float(np.sqrt(covariance[at, at])) * size,
                    p_value=float(form.sensor_p_values[i]),
                    time_constant=form.time_constant,
                    alternatives=form.alternatives,
                )
            )
        for parameter, scatter, chance in zip(("scale", "bias"), missed.sigma[i], missed.p_value[i], strict=True):
            if scatter > 0 and chance < LEVEL:
                size = unit_of if parameter == "bias" else begun.session.sensors[place].nominal_scale
                found.append(ThermalFinding(MISFIT, name, parameter, float(scatter) * size, 0.0, float(chance)))
    return found
