"""The generator itself: its noise is what it states, its strengths are what a matched filter finds."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

from tests.blind.catalogue import CATALOGUE, DISCRETE, HISTORY
from tests.blind.draw import draw_session
from tests.blind.effects_pose import POSE
from tests.blind.effects_sensor import INPUT, UNIT, across
from tests.blind.hide import at_strength, draw_effect, resolved, signature
from tests.blind.physics import mean_readings, measure
from tests.blind.rivals import available
from tests.blind.separation import Field
from tests.blind.strength import Lens
from tests.blind.world import ARCSEC, Effect, Session


def accelerometers(seed: int, **changed: object) -> Session:
    """Six accelerometers, both runs, everything stated."""
    rng = np.random.default_rng(seed)
    while True:
        session = draw_session(rng, frozenset({"time", "temperature", "both runs", "stated noise", "accelerometers"}))
        if session.unit.size == 6 and not session.unit.gyro.any():
            return replace(session, **changed)


def test_every_cause_is_written_down_once():
    """Pose, input, parameters, reading or record: each identifier changes the truth somewhere."""
    elsewhere = {"saturation", "excess-noise", "channels-swapped", "sign-reversed"}
    assert set(POSE) | set(INPUT) | set(UNIT) | elsewhere == set(CATALOGUE)


def test_specific_force_is_that_of_the_conventions():
    """n = g·(−cos α sin β, sin α, cos α cos β) on a perfect stand, read by an ideal triad."""
    session = accelerometers(1, mounting=np.eye(3))
    unit = session.unit
    ideal = replace(unit, scale=np.ones(6), bias=np.zeros(6), quadratic=np.zeros(6), axis=np.vstack([np.eye(3)] * 2))
    u = mean_readings(replace(session, unit=ideal))[:, :3]
    alpha, beta = session.stand.alpha, session.schedule.beta
    sign = np.where(session.schedule.flipped, -1.0, 1.0)
    n = np.stack(
        [-sign * np.cos(alpha) * np.sin(beta), sign * np.sin(alpha) + 0 * beta, np.cos(alpha) * np.cos(beta)], axis=1
    )
    g = np.linalg.norm(u, axis=1)
    assert np.allclose(u / g[:, None], n, atol=1e-12)
    assert np.allclose(g, g[0])
    assert 9.77 < g[0] < 9.84


def test_levelling_is_a_shift_of_beta():
    """θ_y acts as −θ_y/cos α on β, to first order."""
    session = accelerometers(2)
    tilted = Session(**{**session.__dict__})
    effect = replace(draw_effect(session, "levelling-y", np.random.default_rng(1)), amplitude=(10 * ARCSEC,))
    shift = -10 * ARCSEC / np.cos(session.stand.alpha)
    turned = replace(session, schedule=replace(session.schedule, beta=session.schedule.beta + shift))
    assert np.allclose(mean_readings(tilted, [effect]), mean_readings(turned), atol=1e-8 * session.unit.scale.max())


@pytest.mark.parametrize("seed", range(6))
def test_sessions_without_an_effect_have_the_noise_that_they_state(seed: int):
    """A plain least-squares fit of every sensor, whitened by the full covariance: χ² as its freedom asks."""
    session = accelerometers(seed)
    readings, _ = measure(session, [], np.random.default_rng(seed + 100))
    unit = session.unit
    lens = Lens(session)
    size = np.array([0.01, 0.05, 1e-5, 0.01, 0.01])

    def misfit(x: np.ndarray) -> np.ndarray:
        p = x.reshape(6, 5) * size
        sides = np.array([across(e) for e in unit.axis])
        axis = unit.axis + p[:, 3:4] * sides[:, 0] + p[:, 4:5] * sides[:, 1]
        axis /= np.linalg.norm(axis, axis=1)[:, None]
        tried = replace(
            unit,
            scale=unit.scale * (1 + p[:, 0]),
            bias=unit.bias + p[:, 1],
            quadratic=unit.quadratic + p[:, 2],
            axis=axis,
        )
        difference = readings - mean_readings(replace(session, unit=tried))
        return lens.whiten(difference.reshape(-1, 1))[:, 0]

    fitted = least_squares(misfit, np.zeros(30), method="lm")
    freedom = readings.size - 30
    assert abs(2 * fitted.cost - freedom) < 4 * np.sqrt(2 * freedom)


def test_the_matched_statistic_has_the_strength_and_unit_spread():
    """The mean is the strength and the standard deviation one, over 400 draws of noise and stand errors."""
    session = accelerometers(7)
    lens = Lens(session)
    rng = np.random.default_rng(7)
    effect, strength = at_strength(lens, draw_effect(session, "cubic-nonlinearity", rng), 12.0)
    left = lens.left(signature(session, effect).reshape(-1, 1))[:, 0]
    clean = mean_readings(session)
    drawn = np.stack([(measure(session, [effect], rng)[0] - clean).ravel() for _ in range(400)], axis=1)
    statistic = left @ lens.left(drawn) / strength
    assert strength == pytest.approx(12.0, rel=1e-6)
    assert statistic.mean() == pytest.approx(12.0, abs=0.2)
    assert statistic.std() == pytest.approx(1.0, abs=0.15)


@pytest.mark.slow
@pytest.mark.parametrize("cause", [name for name in CATALOGUE if name not in DISCRETE | {"excess-noise", "saturation"}])
def test_the_own_column_of_a_cause_explains_it_wholly(cause: str):
    """The rivals' columns hold the truth: fitted with its own, next to nothing is left."""
    between = CATALOGUE[cause].scope == HISTORY
    lens, effect = visible(cause, between)
    left = lens.left(signature(lens.session, effect).reshape(-1, 1))[:, 0]
    own = [r for r in Field(lens, between).rivals(left, "nothing", (), None) if r.cause == cause]
    share = min(r.left for r in own) / np.linalg.norm(left)
    assert share < (0.3 if cause in ("warm-up", "thermal-lag") else 1e-3)


def visible(cause: str, between: bool) -> tuple[Lens, Effect]:
    """A session that sees the cause, and the effect."""
    rng = np.random.default_rng(3)
    while True:
        session = draw_session(rng, CATALOGUE[cause].needs)
        if not available(session, cause):
            continue
        if cause == "temperature-rate" and not resolved(session):
            continue
        lens = Lens(session)
        if between:
            lens = Lens(session, np.diag(np.linalg.norm(lens.whitened, axis=0)))
        effect = draw_effect(session, cause, rng)
        column = signature(session, effect).reshape(-1, 1)
        if np.linalg.norm(lens.left(column)) > 1e-2 * np.linalg.norm(lens.whiten(column)):
            return lens, effect
