"""Scores of signatures where there is no effect, and what they are worth."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import kstest

from estimator import diagnose
from estimator.causes import cause
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.signatures.lasting import traces_of
from estimator.diagnosis.signatures.products import Products, Projected
from estimator.diagnosis.signatures.scores import bayes_factor, score
from estimator.session import ACCELEROMETER
from tests.estimator.causes.hiding import scene, with_readings

LINEAR = [cause(name) for name in ("cubic-nonlinearity", "bias-ramp", "beta-eccentricity", "flip-misalignment")]


def p_values(*, stated: bool) -> list[float]:
    """p-values of every place of four causes in twenty sessions without an effect."""
    where, found = scene(ACCELEROMETER, 0), []
    for seed in range(20):
        session = where.measured(seed)
        if not stated:
            session = replace(session, standard_errors=np.full(session.readings.shape, np.nan))
        residuals = WhitenedResiduals.of(baseline_of(session))
        nothing = np.zeros((len(residuals.z), 0))
        found += [s.p_value for s in score(residuals, traces_of(residuals, LINEAR), nothing)]
    return found


def test_without_an_effect_the_score_is_chi_square() -> None:
    assert kstest(p_values(stated=True), "uniform").pvalue > 1e-3


def test_under_unknown_noise_the_score_is_as_rare_as_its_f() -> None:
    assert kstest(p_values(stated=False), "uniform").pvalue > 1e-3


def test_evidence_grows_with_the_score() -> None:
    for q in (1, 2, 3):
        values = [bayes_factor(t, q) for t in np.linspace(q + 1e-6, 60, 200)]
        assert np.all(np.diff(values) > 0)


def test_every_amplitude_has_to_pay() -> None:
    assert bayes_factor(30.0, 1) > bayes_factor(30.0, 2) > bayes_factor(30.0, 3)


def test_no_more_than_expected_is_no_evidence() -> None:
    assert bayes_factor(0.5, 1) == 0.0
    assert bayes_factor(2.9, 3) == bayes_factor(0.1, 3) < 0.0


@pytest.mark.slow
def test_unknown_noise_names_no_cause_in_sound_sessions() -> None:
    where = scene(ACCELEROMETER, 0)
    for seed in range(6):
        session = replace(where.measured(seed), standard_errors=np.full((48, 6), np.nan))
        assert not diagnose(session).findings


def test_an_effect_is_found_under_unknown_noise() -> None:
    where = scene(ACCELEROMETER, 0)
    jump = 0.12 * 2e-3 * (np.arange(48) >= 20)[:, None] * np.eye(6)[2]
    session = replace(with_readings(where.measured(1), jump), standard_errors=np.full((48, 6), np.nan))
    (finding,) = diagnose(session).findings
    assert (finding.cause, finding.sensors, finding.nonlinear) == ("bias-jump", ("A3",), {"row": 21.0})


@pytest.mark.parametrize("stated", [True, False])
def test_what_the_findings_leave_is_what_projecting_every_row_would_leave(stated: bool) -> None:
    """Part by part, from inner products alone; the findings explain most of what is there."""
    session = with_readings(scene(ACCELEROMETER, 0).measured(1), 0.12 * 1e-3 * np.arange(48)[:, None] * np.eye(6)[2])
    errors = session.standard_errors if stated else np.full((48, 6), np.nan)
    residuals = WhitenedResiduals.of(baseline_of(replace(session, standard_errors=errors)))
    (first, *_), (second, *_) = (traces_of(residuals, [cause(name)]) for name in ("bias-ramp", "cross-coupling"))
    attributed, _ = np.linalg.qr(first.columns[2])
    projected = Projected.of(residuals, attributed)
    left = second.columns - attributed @ (attributed.T @ second.columns)
    whole, expected = projected([second.products], [second.columns]), Products.of(residuals, left)
    found = whole.parts
    for once, each in zip(whole.whole, found.whole, strict=True):
        assert np.allclose(once, each, rtol=0, atol=1e-12 * np.abs(second.products.whole[0]).max())
    assert np.allclose(found.square, expected.square, rtol=0, atol=1e-12 * second.products.square.max())
    assert np.allclose(
        found.along.sum(axis=0), left.swapaxes(1, 2) @ projected.z, rtol=0, atol=1e-9 * found.along.max()
    )
