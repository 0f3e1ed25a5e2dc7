"""The benefit of a group's findings for sessions that took no part in their fit, and the parameters they move.

The amplitudes are fixed on the first two thirds of the sessions and tried on those that came later.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.calibration.calibrate import averaged
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.prediction import by_sensor
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.groups.course import AnsweredGroup
from estimator.groups.fixed import added_by, fixed
from estimator.groups.joint_fit import JointFit
from estimator.groups.results import GroupFinding, GroupGain, Moved
from estimator.session import Array, CalibrationSession

FIRST = 2 / 3
"""Part of the sessions that fix the amplitudes."""
ELEMENTS = ("scale", "bias", "quadratic", "axis_1", "axis_2")
SHOWN = 5
"""Parameters that moved most."""


def gain_of(
    answer: AnsweredGroup, findings: Sequence[GroupFinding], sessions: Sequence[CalibrationSession]
) -> GroupGain | None:
    """The gain on later sessions; None without findings or without sessions to leave out."""
    model, n = answer.model, len(answer.records)
    shared = [(t, finding) for t, finding in zip(model.named, findings, strict=True) if t.shared]
    first = max(int(np.ceil(FIRST * n)), 1 + max((t.since for t, _ in shared), default=0))
    if not shared or first >= n:
        return None
    every = model.pool.given([*model.own, *(t for t, _ in shared)]).fit
    fit, later = JointFit(every.U[:first], every.F[:first]), JointFit(every.U[first:], every.F[first:])
    square = sum(float(s.whole.sum()) for s in answer.records[first:])
    freedom = sum(float(s.whole_freedom.sum()) for s in answer.records[first:])
    lasting = [finding for _, finding in shared]
    before, after = latest_errors(lasting, fit.amplitude, sessions[-1]) if sessions else (None, None)
    removed = fit.reduces(later) * float(np.mean([part.scale for part in model.pool.parts[first:]]))
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
