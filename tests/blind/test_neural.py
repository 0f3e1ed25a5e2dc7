"""The network among the rivals of the detection study: how signatures are matched, that it learns, its lines."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.study.detection import NETWORK, NEURAL, STRENGTHS, Look, beside_network, page, threshold
from benchmarks.study.neural.lessons import STRENGTHS as LEARNED
from benchmarks.study.neural.lessons import Lesson, draw, filled, lesson
from benchmarks.study.neural.network import Answer, Design, Filters, answer, design_of, log_posterior, starting
from estimator import read_session
from estimator.calibration.calibrate import averaged
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from tests.blind.cases import draw_case

OWN, SHARED = ("bias-asymmetry",), ("stand-drift",)


def one_of_many(alone: Lesson) -> Lesson:
    """The lesson with a leading axis."""
    return Lesson(Design(*(x[None] for x in alone.design)), *(x[None] for x in alone[1:]))


@pytest.fixture(scope="module")
def given() -> Lesson:
    """A session that holds an effect of one sensor."""
    rng = np.random.default_rng(1)
    tried = (lesson(rng, OWN, SHARED) for _ in range(20))
    alone = next(n for n in tried if 0 < n.labels[0] <= len(n.free) and not n.unstated.any())
    return one_of_many(alone)


@pytest.fixture(scope="module")
def residuals() -> WhitenedResiduals:
    return WhitenedResiduals.of(baseline_of(averaged(read_session(draw_case("none", (3,)).session))))


@pytest.fixture
def stored(tmp_path: Path) -> Path:
    """Weights that have learned nothing."""
    facts = {"minutes": 25.0, "processor_minutes": 21.3, "sessions": 4700, "draws": 2_130_000}
    weights = starting(24, (len(OWN), len(SHARED)), np.random.default_rng(4))
    np.savez(tmp_path / "n.npz", own=OWN, shared=SHARED, loss=0.987, prior_loss=2.97, **facts, **weights)
    return tmp_path / "n.npz"


def test_a_right_signature_is_the_matched_filter_of_an_effect(given: Lesson) -> None:
    design, z, labels, _ = draw(given, 3000, np.random.default_rng(2))
    sensor = int(given.labels[0, 0]) - 1
    g = np.sign(design.known[..., :1]) * design.present[..., None]
    output = Filters.of(design, z, np)(g, np)[0, sensor, :, 0]
    best = (z[0] * given.traces[0, 0][:, None]).sum(axis=(0, 2))
    assert abs(np.corrcoef(output, best)[0, 1]) > 0.99
    sound = labels[0] == 0
    assert np.mean(output[sound] ** 2) == pytest.approx(1, abs=0.13)  # 3 sigma of 1500
    acting = np.abs(output[labels[0] == sensor + 1])
    assert LEARNED[0] < acting.mean() < LEARNED[1]


def test_sensors_in_another_order_are_answered_in_that_order(given: Lesson) -> None:
    design, z, _, _ = draw(given, 4, np.random.default_rng(2))
    weights, m = starting(24, (1, 1), np.random.default_rng(4)), z.shape[1]
    turned = design._replace(**{name: x[:, ::-1] for name, x in design._asdict().items() if name != "removed"})
    before, after = log_posterior(weights, design, z), log_posterior(weights, turned, z[:, ::-1])
    order = [0, *range(m, 0, -1), m + 1]
    np.testing.assert_allclose(after, before[..., order], atol=1e-3)
    np.testing.assert_allclose(np.exp(after).sum(axis=-1), 1, atol=1e-5)


def test_a_session_filled_up_is_answered_as_it_is(residuals: WhitenedResiduals, stored: Path) -> None:
    R, m = residuals.baseline.residual.shape
    nothing = np.zeros((1, m, R))
    z = residuals.z[: R * m].reshape(R, m).T
    empty = Lesson(design_of(residuals), residuals.basis[R * m :], z, nothing[0, :, 0], nothing, *2 * [np.zeros(1)])
    whole = one_of_many(filled(empty, R + 3, m + 1))
    found = log_posterior(dict(np.load(stored)), whole.design, whole.free[:, :, None])[0, 0]
    said = answer(stored, residuals)
    assert said.log_odds == pytest.approx(np.log(np.expm1(-found[0])), abs=1e-3)
    assert said.cause in OWN + SHARED


@pytest.mark.slow
def test_it_learns(given: Lesson) -> None:
    neural = pytest.importorskip(
        "benchmarks.study.neural.__main__", reason="needs jax: pip install -r requirements-bench.lock"
    )
    weights = starting(24, (1, 1), np.random.default_rng(4))
    state = (weights, *({name: np.zeros_like(x) for name, x in weights.items()} for _ in range(2)))
    batch = draw(given, 32, np.random.default_rng(2))[:3]
    losses = []
    for k in range(1, 21):
        state, loss = neural.stepped(state, batch, 3e-3, k)
        losses.append(float(loss))
    assert losses[-1] < 0.5 * losses[0]


def look(cause: str, strength: float, log_odds: float, said: str) -> Look:
    limit = dict.fromkeys(STRENGTHS, 0.0)
    return Look(cause, strength, True, True, {"bias-ramp": 0.0}, 0.0, limit, 0.0, 0.0, Answer(log_odds, said))


def test_the_page_has_its_lines_at_equal_false_alarms(stored: Path) -> None:
    sound = [look("", 0.0, k / 100, "bias-ramp") for k in range(101)]
    said = ((0.5, "bias-ramp"), (2.0, "warm-up"), (3.0, "bias-ramp"))
    hidden = [look("bias-ramp", strength, *answer) for strength in STRENGTHS for answer in said]
    looks = [*sound, *hidden]
    text = beside_network(looks, "a command", stored)
    assert text.startswith(NETWORK)
    assert f"| {NEURAL} | 1 % |" + 4 * " 66.7 % (20.8–93.9) of 3 |" in text
    assert f"| {NEURAL}: the right name first |  |" + 4 * " 33.3 % (6.1–79.2) of 3 |" in text
    assert "25 minutes (21 of one processor)" in text
    assert "held-out sessions 0.99, of the prior 2.97" in text
    assert NEURAL not in page(looks, "a command")


def test_as_many_sound_sessions_pass_a_threshold_as_are_wished() -> None:
    values = [float(k) for k in np.random.default_rng(1).permutation(400)]
    assert sum(value > threshold(values, 0.01) for value in values) == 4
    assert threshold(values, 0.0) == 399.0
