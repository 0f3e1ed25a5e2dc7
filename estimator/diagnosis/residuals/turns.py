"""Earlier sessions seen from a session: turned into its frame, exactly, before anything is taken as linear.

A block that sits turned by R in its fixture has axes R·e. About equal frames a quarter of the turn's square would be
left on every axis (16″ of 1°) and pass for a change of the sensors. So every earlier baseline is turned by its own R:
axes and applied vectors together, which changes none of its residuals. R is found by Gauss–Newton on the rotations,
with each sensor's own 5×5 covariance (what a session does not observe thus has no say) and Huber's weight, so that a
sensor that moved alone does not drag it. R is where the change is linearised, no estimate: the turn itself is an
amplitude of the joint fit.

Sessions of a history in which the block sat as in the latest share its turn, and all of them tell where it sat. One in
which it sat otherwise is turned by its own and has no say on the common turn, only on how the axes lie to one another.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.diagnosis.residuals.baseline import Absorption, Baseline, turn_response
from estimator.diagnosis.residuals.between_sessions import carried, carried_each, deviation, inverse_root
from estimator.parameters import together
from estimator.rotations import common_turn, turn_of, vector_of
from estimator.session import Array, CalibrationSession
from estimator.significance import p_value

ROUNDS = 20
"""Rounds of Gauss–Newton; three to six are usual."""
NEGLIGIBLE = 1e-10
"""rad (2e-5″): a step that no longer moves the place of linearisation."""
NEAR = 1e-6
"""Change of a direction cosine (0.2″) below which the start of Gauss–Newton is near enough: what is left to it is a
step or two."""
HUBER = 3.0
"""Standard errors of a sensor's change (root of χ² over its 5 elements, each) beyond which it weighs less."""
SEEN = 1e-6
"""Share of the best seen direction of a turn below which one is left alone: about a line that all axes share."""
OTHERWISE = 1e-4
"""Chance that a session of a history that sits as the latest one does is taken to sit otherwise: all that it costs is
that session's say on the common turn."""


def turned_session(session: CalibrationSession, turn: Array) -> CalibrationSession:
    """The session with block axes turned by (3, 3), dimensionless, as if it had been mounted so."""
    directions = None if session.directions is None else session.directions @ turn.T
    flip = turn @ session.flip_turn
    return replace(session, mounting=turn @ session.mounting, directions=directions, flip_turn=flip)


def turned_baseline(baseline: Baseline, turn: Array) -> Baseline:
    """The baseline in block axes turned by (3, 3), dimensionless: its residuals and noise stay as they are.

    So does what the fit takes of the readings. Along the tangents of the turned axes the parameters are others, by an
    orthogonal C: what is worked out of the baseline is carried over instead of worked out anew.
    """

    def to(vectors: Array | None) -> Array | None:
        return None if vectors is None else vectors @ turn.T

    old, p = baseline.setting, baseline.parameters
    setting = replace(
        old,
        parameters=replace(p, axis=p.axis @ turn.T),
        n=old.n @ turn.T,
        d_alpha=to(old.d_alpha),
        d_beta=to(old.d_beta),
        force=to(old.force),
        flip_turn=turn @ old.flip_turn,
    )
    turned = replace(baseline, session=turned_session(baseline.session, turn), setting=setting, turn=vector_of(turn))
    C, absorbed = carried(turned.parameters, turn @ p.axis_tangents), baseline.absorption
    design = baseline.whitened_design.copy()
    design[:, : len(C)] = design[:, : len(C)] @ C.T
    vars(turned).update(
        whiten=baseline.whiten,
        whitened_design=design,
        absorption=Absorption(absorbed.basis, C @ absorbed.response),
        covariance=C @ baseline.covariance @ C.T,
    )
    return turned


def of_each(covariance: Array) -> Array:
    """(m, 5, 5) covariance of every sensor's own parameters, from the covariance (P, P) of all."""
    m = len(covariance) // 5
    return np.asarray(covariance.reshape(m, 5, m, 5)[np.arange(m), :, np.arange(m)])


def turns_between(nows: Sequence[Baseline], earlier: Sequence[Baseline]) -> Array:
    """(H, 3, 3) rotations, dimensionless, that take the axes of earlier sessions onto those of as many ``nows`` of the
    same sensors; each iterates until it has settled itself."""
    p, q = together([b.parameters for b in nows]), together([b.parameters for b in earlier])
    current, origin = (np.stack([of_each(b.covariance) for b in baselines]) for baselines in (nows, earlier))
    norm, frames = np.stack([b.setting.norm for b in nows]), q.axis_tangents
    response = turn_response(p).reshape(*p.scale.shape, 5, 3)
    turn = common_turn(q.axis, p.axis, NEAR)
    moving = np.ones(len(turn), dtype=bool)
    for _ in range(ROUNDS):
        mapping = carried_each(p, turn[:, None] @ frames)
        roots = inverse_root(current + mapping @ origin @ np.swapaxes(mapping, -1, -2))
        turned = replace(q, axis=q.axis @ np.swapaxes(turn, -1, -2))
        step = roots @ deviation(p, turned, norm)[..., None]
        length = np.linalg.norm(step, axis=-2, keepdims=True) / np.sqrt(5)
        weight = np.sqrt(np.minimum(1.0, HUBER / np.maximum(length, HUBER)))
        design = (weight * (roots @ response)).reshape(len(turn), -1, 3)
        missing = -(np.linalg.pinv(design, rcond=SEEN) @ (weight * step).reshape(len(turn), -1, 1))[..., 0]
        turn = np.where(moving[:, None, None], turn_of(missing) @ turn, turn)
        moving &= np.linalg.norm(missing, axis=-1) >= NEGLIGIBLE
        if not moving.any():
            break
    return turn


def in_frame_of(now: Baseline, history: Sequence[Baseline]) -> list[Baseline]:
    """Earlier baselines turned into the frame of ``now``; those of other sensors as they are."""
    alike = [h for h in history if h.setting.kinds == now.setting.kinds]
    if not alike:
        return list(history)
    turns = dict(zip(map(id, alike), turns_between([now] * len(alike), alike), strict=True))
    latest, shared = alike[-1], turns[id(alike[-1])]
    reference = turned_covariance(now, latest, shared)

    def framed(baseline: Baseline) -> Baseline:
        if baseline.setting.kinds != now.setting.kinds:
            return baseline
        turn = turns[id(baseline)]
        otherwise = baseline is not latest and is_reseated(
            now, turn @ shared.T, turned_covariance(now, baseline, turn) + reference
        )
        if otherwise or now.gauge_free.any():
            return replace(turned_baseline(baseline, turn), sits_otherwise=otherwise)
        return turned_baseline(baseline, shared)

    return [framed(h) for h in history]


def turned_covariance(now: Baseline, earlier: Baseline, turn: Array) -> Array:
    """(P, P) dimensionless: covariance of the parameters of a session that is turned by (3, 3), in those of ``now``."""
    carry = carried(now.parameters, turn @ earlier.parameters.axis_tangents)
    return np.asarray(carry @ earlier.covariance @ carry.T)


def is_reseated(now: Baseline, difference: Array, covariance: Array) -> bool:
    """Whether the block sat differently in one session than in the latest: turned by ``difference`` (3, 3), with the
    ``covariance`` (P, P) of both, dimensionless, as `turned_covariance` gives it.
    """
    seen = inverse_root(covariance) @ turn_response(now.parameters) @ vector_of(difference)
    return bool(p_value(seen @ seen, 3) < OTHERWISE)
