"""The paper's functional and search: what it finds, how many passes it takes, and from where."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.papers.descent import descend, levenberg_marquardt
from benchmarks.papers.triples import triples_of
from estimator.calibration import calibrate
from estimator.errors import ScheduleError
from tests.estimator.calibration.free_sessions import G, session, sphere, truth

ACCURACY = 1e-5
"""0.001 %: of scale, of g, of a radian."""


def block(R=12, m=4, noise=0.0, seed=0, **changes):
    rng = np.random.default_rng(seed)
    true = truth(m, seed=seed, bias=0.01 * G, scale_error=0.01)
    return true, session(true, sphere(R, rng), noise=noise, rng=rng, **changes)


def angles_between(axes):
    return axes @ axes.T


def test_four_accelerometers_have_thirteen_parameters():
    assert len(triples_of(block()[1]).free) == 13
    assert len(triples_of(block()[1]).members) == 4


@pytest.mark.parametrize("m", [3, 4, 6])
def test_the_jacobian_is_the_derivative(m):
    problem = triples_of(block(m=m)[1])
    x = 0.01 * np.random.default_rng(1).standard_normal(len(problem.free))
    steps = 1e-6 * np.eye(len(x))
    numeric = np.stack([(problem.misses(x + s) - problem.misses(x - s)) / 2e-6 for s in steps], axis=1)
    assert np.abs(problem.jacobian(x) - numeric).max() < 1e-7


def test_descent_from_nominal_finds_every_parameter_to_the_published_accuracy():
    true, measured = block()
    found = descend(triples_of(measured), below=1e-9)
    assert found.converged
    assert found.iterations < 270
    assert np.abs(found.parameters.scale / true.scale - 1).max() < ACCURACY
    assert np.abs(found.parameters.bias - true.bias).max() < ACCURACY * G
    assert np.abs(angles_between(found.parameters.axis) - angles_between(true.axes)).max() < ACCURACY


def test_a_start_ten_per_cent_off_is_nearer_than_nominal():
    problem = triples_of(block()[1])
    exact = levenberg_marquardt(problem).x
    near, far = descend(problem, 0.9 * exact, below=1e-9), descend(problem, below=1e-9)
    assert near.iterations < far.iterations


def test_the_functional_never_rises():
    problem = triples_of(block(noise=1e-3)[1])
    values = [problem.functional(x) for x in descend(problem, most=50).path]
    assert np.all(np.diff(values) <= 0)


def test_both_searches_end_at_one_optimum():
    problem = triples_of(block(R=20, noise=1e-3)[1])
    slow, fast = descend(problem), levenberg_marquardt(problem)
    assert fast.iterations < 15 < slow.iterations
    assert np.abs(slow.x - fast.x).max() < 1e-7


def test_the_functional_agrees_with_maximum_likelihood_within_the_noise():
    measured = block(R=24, noise=1e-4)[1]
    found, best = levenberg_marquardt(triples_of(measured)).parameters, calibrate(measured, quadratic=False)
    z = [(k - s.scale.value) / s.scale.sigma for k, s in zip(found.scale, best.sensors, strict=True)]
    assert np.abs(z).max() < 3


def test_tables_set_a_degree_wrong_cost_nothing():
    rng = np.random.default_rng(3)
    true = truth(4, bias=0.1)
    wrong = sphere(12, rng) + np.radians(1) * rng.standard_normal((12, 3))
    measured = session(true, wrong / np.linalg.norm(wrong, axis=1, keepdims=True), noise=0.0)
    assert np.abs(levenberg_marquardt(triples_of(measured)).parameters.scale / true.scale - 1).max() < 1e-9


def test_nine_orientations_determine_thirteen_and_two_planes_never_do():
    turn = 2 * np.pi * np.arange(24) / 24
    zero = np.zeros(24)
    planes = np.vstack([np.c_[np.cos(turn), zero, np.sin(turn)], np.c_[zero, np.cos(turn), np.sin(turn)]])
    true = truth(4)

    def rank(directions):
        problem = triples_of(session(true, directions, noise=0.0))
        return np.linalg.matrix_rank(problem.jacobian(levenberg_marquardt(problem).x), tol=1e-5)

    rng = np.random.default_rng(5)
    assert [rank(sphere(8, rng)), rank(sphere(9, rng)), rank(planes)] == [12, 13, 12]


def test_too_few_orientations_are_refused():
    with pytest.raises(ScheduleError, match="3 orientations are too few: fewer equations than 13 parameters"):
        triples_of(block(R=3)[1])


def test_gyros_are_refused():
    measured = block(gyros=1)[1]
    with pytest.raises(ScheduleError, match="accelerometers only"):
        triples_of(measured)


def test_a_flat_block_is_refused():
    measured = block(m=3)[1]
    flat = tuple(replace(s, nominal_axis=np.array([1.0, 0.01 * k, 0.0])) for k, s in enumerate(measured.sensors))
    with pytest.raises(ScheduleError, match="in one plane"):
        triples_of(replace(measured, sensors=flat))
