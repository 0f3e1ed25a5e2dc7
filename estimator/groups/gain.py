"""The benefit of a group's findings for sessions that took no part in their fit, and the parameters they move.

The amplitudes are fixed on the first two thirds of the sessions and tried on those that came later.

Naming may not predict worse: every name is tried on sessions that took no part in its amplitude. Of three parts of the
sessions each is predicted from the other two, with the amplitude, its covariance and the spread between sessions that
those have. A name whose sessions are likelier without it is none.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.calibration.calibrate import averaged
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.prediction import by_sensor
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.groups.evidence import VARYING
from estimator.groups.fixed import added_by, fixed
from estimator.groups.joint_fit import JointFit, predictive
from estimator.groups.pool import PoolModel, pooled
from estimator.groups.random_effects import mean_of
from estimator.groups.results import GroupFinding, GroupGain, Moved
from estimator.groups.selection import Found, GroupSelection
from estimator.session import Array, CalibrationSession

FIRST = 2 / 3
"""Part of the sessions that fix the amplitudes."""
ELEMENTS = ("scale", "bias", "quadratic", "axis_1", "axis_2")
SHOWN = 5
"""Parameters that moved most."""


def gain_of(
    selection: GroupSelection, findings: Sequence[GroupFinding], sessions: Sequence[CalibrationSession]
) -> GroupGain | None:
    """The gain on later sessions; None without findings or without sessions to leave out."""
    n = len(selection.layout.parts)
    model, lasting = PoolModel(absorbed=selection.of_one_session), []
    for f, finding in zip(selection.found, findings, strict=True):
        if f.form != VARYING:
            model = model.with_shared(f.place, f.since)
            lasting.append(finding)
    first = max(int(np.ceil(FIRST * n)), 1 + max((s.since for s in model.shared), default=0))
    if not model.shared or first >= n:
        return None
    every = pooled(selection.layout, model, selection.scale).fit
    fit, later = JointFit(every.U[:first], every.F[:first]), JointFit(every.U[first:], every.F[first:])
    parts = [p.statistics for p in selection.layout.parts[first:]]
    square = sum(float(p.whole.sum()) for p in parts)
    freedom = sum(float(p.whole_freedom.sum()) for p in parts)
    before, after = latest_errors(lasting, fit.amplitude, sessions[-1]) if sessions else (None, None)
    removed = fit.reduces(later) * float(np.mean(selection.scale[first:]))
    return GroupGain(
        fitted=first,
        held_out=n - first,
        log_score=fit.predicts(later),
        chi2_per_dof_before=square / freedom,
        chi2_per_dof_after=(square - removed) / freedom,
        moved=moved(findings, sessions[-1]) if sessions else (),
        before=before,
        after=after,
    )


def latest_errors(
    findings: Sequence[GroupFinding], amplitude: Array, session: CalibrationSession
) -> tuple[dict[str, dict[str, float]] | None, dict[str, dict[str, float]] | None]:
    """Root mean square residual of every sensor in a session, by kind and name, m/s² (rad/s), without findings and with
    them; None where it has none of them.

    ``amplitude`` (a,) SI: of the findings one after another, as sessions fixed them in which this one had no part.
    """
    widths = [len(f.amplitude) for f in findings]
    parts = np.split(amplitude, np.cumsum(widths)[:-1])
    effects = [replace(fixed(f), amplitude=tuple(part.tolist())) for f, part in zip(findings, parts, strict=True)]
    baseline = baseline_of(averaged(session))
    added = added_by(baseline, effects, ())
    if added is None:
        return None, None
    residuals, (R, m) = WhitenedResiduals.of(baseline), baseline.residual.shape
    effect = residuals.trace((added.columns @ added.amplitude)[..., None])[:, 0]
    before, after = (
        by_sensor(z[: R * m].reshape(R, m) / residuals.whiten.weight, baseline)
        for z in (residuals.z, residuals.z - effect)
    )
    return before, after


def moved(findings: Sequence[GroupFinding], session: CalibrationSession) -> tuple[Moved, ...]:
    """Changes of a session's parameters when the findings are modelled, the largest first."""
    baseline = baseline_of(averaged(session))
    residuals, names = WhitenedResiduals.of(baseline), [s.name for s in session.sensors]
    added = added_by(baseline, [fixed(f) for f in findings if f.subject in session.subjects], ())
    if added is None:
        return ()
    effect = added.columns @ added.amplitude
    change = -(residuals.response @ residuals.whitened(effect[..., None])[:, 0])
    sigma = np.sqrt(np.diagonal(baseline.covariance))
    factors = baseline.parameters.si_factors(baseline.setting.norm)
    order = np.argsort(-np.abs(change / sigma))[:SHOWN]
    return tuple(
        Moved(ELEMENTS[j % 5], names[j // 5], float(change[j] * factors[j]), float(change[j] / sigma[j]))
        for j in order
        if change[j] != 0
    )


PARTS = 3
"""Parts of the sessions, every third one in each: all reach over the whole life of the group."""


def names_that_predict(state: GroupSelection) -> GroupSelection:
    """The findings by which sessions left out are likelier; the others are not tried again."""
    worse = tuple(f for f in state.found if gained(state, f) <= 0)
    found = tuple(f for f in state.found if f not in worse)
    return replace(state, found=found, barred=state.barred | {f.hypothesis.group for f in worse})


def gained(state: GroupSelection, name: Found) -> float:
    """Log predictive density that a name gains, the other findings given."""
    w, k = name.place
    moments = state.weighed(without=name).pool.moments[w]
    U, F = moments.U[name.since :, k], moments.F[name.since :, k]
    seen = np.diagonal(F, axis1=1, axis2=2).sum(axis=1) > 0
    U, F = U[seen], F[seen]
    part = np.arange(len(U)) % PARTS
    whole = 0.0
    for p in range(PARTS) if len(U) > 1 else ():
        fit = part != p
        mean = mean_of(U[fit], F[fit])
        spread = mean.covariance + mean.spread**2 * np.eye(w)
        whole += sum(predictive(mean.value, spread, u, f) for u, f in zip(U[~fit], F[~fit], strict=True))
    return whole if len(U) > 1 else np.inf
