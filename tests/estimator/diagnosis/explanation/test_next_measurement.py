"""The planner's promises come true: the proposed measurement, carried out, distinguishes the alternatives."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from estimator import CalibrationSession, diagnose
from estimator.diagnosis import Finding
from estimator.diagnosis.explanation.next_measurement import proposals
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.results import Separation
from estimator.session import Array
from estimator.simulate import simulate
from tests.estimator.calibration.cases import accelerometers, block
from tests.estimator.causes.hiding import Scene, strength, with_readings
from tests.estimator.causes.physics import ACTED, SENSOR, World
from tests.estimator.causes.worlds import truth_of, wandering

VOLTS = np.full(6, 3e-6)


def warming(session: CalibrationSession) -> CalibrationSession:
    """The temperature rises with time."""
    t = session.time
    return replace(session, temperature=20 + 5 * t / t[-1] + 0.2 * np.sin(t / 900))


@dataclass(frozen=True, eq=False)
class Pair:
    """A hidden cause and the rival that this session cannot tell from it."""

    cause: str
    rival: str
    session: CalibrationSession
    shape: tuple[float, ...] = ()

    def effect(self, session: CalibrationSession, k: Array) -> Array:
        """(R, m) readings added by amplitudes k."""
        world = World(session, truth_of(session))
        added = ACTED[self.cause](world, k, SENSOR, self.shape) - world.inputs(world.vectors())
        return np.asarray(added * world.truth.scale)

    def amplitude(self) -> Array:
        """Amplitude of a strength of twelve standard errors."""
        world = World(self.session, truth_of(self.session))
        unit = np.array([1e-9])
        return unit * 12 / strength(self.effect(self.session, unit) / world.truth.scale, Scene(world, VOLTS))


BOTH, ONE = block(accelerometers(), 24), block(accelerometers(), 8, runs=(False,))
PAIRS = (
    Pair("cubic-nonlinearity", "odd-quadratic", BOTH),
    Pair("scale-asymmetry", "odd-quadratic", ONE),
    Pair("bias-ramp", "bias-temperature", warming(BOTH)),
    Pair("bias-temperature", "bias-ramp", warming(BOTH)),
    Pair("warm-up", "bias-ramp", BOTH, (6000.0,)),
)
every_pair = pytest.mark.parametrize("pair", PAIRS, ids=lambda p: f"{p.cause}, not {p.rival}")


def measured(pair: Pair, session: CalibrationSession, seed: int) -> Finding:
    """The finding in one session with the cause hidden."""
    clean = simulate(session, truth_of(session), np.random.default_rng(seed), noise=VOLTS)
    found = diagnose(with_readings(clean, pair.effect(session, pair.amplitude()))).findings
    assert len(found) == 1
    return found[0]


def promise(finding: Finding, rival: str) -> Separation:
    """The separation stated for the rival."""
    return next(s for s in finding.separations if s.cause == rival)


def planned(session: CalibrationSession, words: str) -> Baseline:
    """The proposal in those words."""
    at = baseline_of(simulate(session, truth_of(session), np.random.default_rng(1), noise=VOLTS))
    return next(p for said, p in proposals(at) if said == words)


@every_pair
def test_alternatives_come_with_a_measurement_that_tells_them_apart(pair: Pair) -> None:
    said = promise(measured(pair, pair.session, 1), pair.rival)
    assert said.measurement
    assert said.now < 4 < said.then


@pytest.mark.slow
@every_pair
def test_the_measurement_carried_out_tells_them_apart_as_far_as_promised(pair: Pair) -> None:
    said = promise(measured(pair, pair.session, 1), pair.rival)
    plan = planned(pair.session, said.measurement)
    reached = []
    for seed in range(2):
        finding = measured(pair, plan.session, seed)
        assert finding.cause == pair.cause
        assert pair.rival not in finding.alternatives
        rivals = [r.strength for r in finding.ranking if r.cause == pair.rival and r.sensors == finding.sensors]
        reached.append(np.sqrt(finding.strength**2 - (rivals[0] if rivals else 0.0) ** 2))
    assert abs(np.mean(reached) - said.then) < 0.25 * said.then + 1.0


def test_nobody_is_asked_to_repeat_a_session_more_than_four_times() -> None:
    at = baseline_of(simulate(BOTH, truth_of(BOTH), np.random.default_rng(1), noise=VOLTS))
    assert [said for said, _ in proposals(at) if said.startswith("repeat the session")] == [
        "repeat the session while the temperature goes through almost three cycles of 5 °C",
        "repeat the session 4 times",
    ]


def test_a_session_that_records_vibration_gets_proposals_of_any_length() -> None:
    at = baseline_of(measured_with_vibration())
    assert {len(plan.setting.n) for _, plan in proposals(at)} > {len(at.setting.n)}
    assert all(plan.setting.vibration is None for _, plan in proposals(at))


def measured_with_vibration() -> CalibrationSession:
    """A session whose rows shake differently."""
    session = wandering(BOTH)
    return simulate(session, truth_of(session), np.random.default_rng(1), noise=VOLTS)
