"""Findings in words: only causes of the catalogue get a name; one cause on several sensors is one finding."""

from dataclasses import replace

import numpy as np

from estimator import diagnose
from estimator.causes import CATALOGUE, cause
from estimator.diagnosis.explanation.naming import listed, merged, named_cause
from estimator.session import ACCELEROMETER
from tests.estimator.causes.hiding import scene, spoilt

WHERE = scene(ACCELEROMETER, 0)


def test_noise_whose_cause_is_missing_in_the_catalogue_is_not_named_but_unexplained() -> None:
    session = spoilt("excess-noise", WHERE.measured(1), WHERE, np.random.default_rng(51))
    found = diagnose(session, catalogue=[c for c in CATALOGUE if c.identifier != "excess-noise"])
    assert found.findings == ()
    assert [(s.where, s.sensors) for s in found.structures] == [("larger than stated", ("A2",))]


def test_sensors_are_listed_as_people_do() -> None:
    assert listed(("A1",)) == "A1"
    assert listed(("A1", "A2", "A3")) == "each of A1, A2 and A3"
    assert listed(("A3", "A3")) == "A3"


def test_findings_of_one_cause_become_one() -> None:
    ramp, cubic = cause("bias-ramp"), cause("cubic-nonlinearity")
    first = replace(named_cause(ramp, ("A1",), 1e-6, 3.0), alternatives=("warm-up", "bias-jump"), new=True)
    second = replace(named_cause(ramp, ("A2",), 1e-9, 4.0), alternatives=("bias-jump",), new=False)
    one, other = merged([(ramp, first), (cubic, named_cause(cubic, ("A1",), 1e-5, 9.0)), (ramp, second)])
    assert (one.cause, one.sensors, one.p_value, one.strength) == ("bias-ramp", ("A1", "A2"), 1e-6, 5.0)
    assert (one.alternatives, one.new, len(one.nonlinear_each)) == (("bias-jump",), None, 2)
    assert one.sentence == "The bias of each of A1 and A2 drifts steadily during the session."
    assert other.cause == "cubic-nonlinearity"
