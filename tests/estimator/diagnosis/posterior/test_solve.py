"""The likeliest terms with the noise that they are weighed in."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.diagnosis.diagnose import diagnose
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.session import Array, CalibrationSession
from tests.estimator.diagnosis.posterior.small import solved
from tests.estimator.diagnosis.small import ROWS, SENSOR, WHERE, effect, measured, on_sensor


def with_errors(session: CalibrationSession, factor: float) -> CalibrationSession:
    """The session that states its standard errors by a factor of the true ones."""
    sensors = tuple(replace(s, bias_repeatability=factor * s.bias_repeatability) for s in session.sensors)
    return replace(session, standard_errors=session.standard_errors * factor, sensors=sensors)


def stated(added: Array | float = 0.0) -> CalibrationSession:
    session = measured(added)
    return replace(session, standard_errors=np.broadcast_to(WHERE.noise, session.readings.shape).copy())


@pytest.mark.parametrize("factor", [0.1, 3.0])
def test_noise_stated_off_by_a_factor_is_told_by_the_readings(factor: float) -> None:
    best, _ = solved(with_errors(stated(effect("cubic-nonlinearity")), factor))
    assert [t.place for t in best.terms] == [("cubic-nonlinearity", (SENSOR,))]
    assert best.noise is not None
    (claim,) = best.noise.claims
    assert np.sqrt(claim.ratio) == pytest.approx(1 / factor, rel=0.3)


def test_noise_as_stated_is_believed() -> None:
    best, _ = solved(stated(effect("cubic-nonlinearity")))
    assert best.noise is None


def test_readings_far_out_on_all_sensors_are_tails_and_mostly_no_names() -> None:
    """Six readings of ninety-six, off by six standard errors."""
    baseline, session = baseline_of(stated()), stated()
    sigma = np.sqrt(baseline.variance) * baseline.parameters.scale
    tailed, names, names_if_normal = [], 0, 0
    for seed in range(6):
        rng = np.random.default_rng((12, seed))
        far = np.zeros(sigma.size)
        far[rng.choice(far.size, 6, replace=False)] = 6 * rng.choice([-1, 1], 6)
        best, normal = solved(replace(session, readings=session.readings + far.reshape(sigma.shape) * sigma))
        tailed.append(best.noise is not None and best.noise.tails)
        names += sum(t.named for t in best.terms)
        names_if_normal += sum(t.named for t in normal.terms)
    assert sum(tailed) >= 5
    assert names < names_if_normal / 3


def test_two_causes_that_noise_stands_in_for_are_both_found() -> None:
    both = effect("cubic-nonlinearity") + effect("bias-jump")
    best, _ = solved(stated(both))
    assert {t.place for t in best.terms} == {("cubic-nonlinearity", (SENSOR,)), ("bias-jump", (SENSOR,))}


def test_a_noisier_sensor_beside_a_cause() -> None:
    scatter = on_sensor(5 * np.random.default_rng(4).standard_normal(ROWS), 3)
    best, _ = solved(stated(effect("cubic-nonlinearity") + scatter))
    assert [n.sensor for n in best.noisy] == [3]
    assert [t.place for t in best.terms] == [("cubic-nonlinearity", (SENSOR,))]


def test_the_posterior_is_written_as_any_diagnosis() -> None:
    found = diagnose(stated(effect("warm-up")))
    (finding,) = found.findings
    assert (finding.cause, finding.sensors) == ("warm-up", (f"A{SENSOR + 1}",))
    assert finding.amplitude[0] / finding.sigma[0] > 5
    assert abs(finding.nonlinear["s"] - 900) < 450
    assert sum(rival.probability for rival in finding.ranking) <= 1 + 1e-9


def test_names_do_not_depend_on_those_of_the_sensors() -> None:
    session = stated(effect("hysteresis"))
    renamed = replace(session, sensors=tuple(replace(s, name=f"S{9 - k}") for k, s in enumerate(session.sensors)))
    (one,), (other,) = (diagnose(s).findings for s in (session, renamed))
    assert (one.cause, other.sensors) == (other.cause, (f"S{9 - SENSOR}",))
    assert one.ranking[0].probability == pytest.approx(other.ranking[0].probability, abs=1e-6)


def test_names_do_not_depend_on_the_unit_of_the_readings() -> None:
    session = stated(effect("hysteresis"))
    thousand = replace(
        session,
        readings=session.readings * 1e3,
        standard_errors=session.standard_errors * 1e3,
        sensors=tuple(
            replace(s, nominal_scale=1e3 * s.nominal_scale, bias_repeatability=1e3 * s.bias_repeatability)
            for s in session.sensors
        ),
    )
    (one,), (other,) = (diagnose(s).findings for s in (session, thousand))
    assert (one.cause, one.sensors) == (other.cause, other.sensors)
    assert one.ranking[0].probability == pytest.approx(other.ranking[0].probability, abs=0.01)
