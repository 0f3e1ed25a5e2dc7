"""Every cause is found when it is there, and is not when it is not; so is one that was added a minute ago."""

import json

import numpy as np
import pytest

from estimator import diagnose
from estimator.causes import CATALOGUE, Cause, SensorCause, Setting
from estimator.causes.contract import column
from estimator.session import ACCELEROMETER, Array
from tests.estimator.causes.hiding import found, scene, scene_for, undisturbed, with_readings

every = pytest.mark.parametrize("known", CATALOGUE, ids=lambda c: c.identifier)


@every
def test_is_found_when_hidden(known: Cause) -> None:
    diagnosis = found(known.identifier)
    offered = {name for f in diagnosis.findings for name in (f.cause, *f.alternatives)}
    assert known.identifier in offered
    json.dumps(diagnosis.to_dict(), allow_nan=False)


@every
def test_is_not_found_when_absent(known: Cause) -> None:
    diagnosis = undisturbed(scene_for(known.identifier))
    assert known.identifier not in {f.cause for f in diagnosis.findings}


@every
def test_has_a_limit_or_a_reason_in_every_diagnosis(known: Cause) -> None:
    (limit,) = (x for x in undisturbed(scene_for(known.identifier)).limits if x.cause == known.identifier)
    assert (limit.amplitude is None) == bool(limit.reason)
    assert all(np.isfinite(a) and a > 0 for a in limit.amplitude or ())


class MoonTide(SensorCause):
    """The zero swings five times a session."""

    identifier = "moon-tide"
    scope = "environment"
    equation = "k·sin 10πt/t_end"
    units = ("m/s²",)
    needs = frozenset({"time"})
    sentence = "The moon pulls at {sensors}."
    advice = "Wait for the new moon."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        assert setting.time is not None
        return column(np.sin(10 * np.pi * setting.time / setting.time[-1]))


def test_a_new_cause_is_one_class_and_one_entry() -> None:
    where = scene(ACCELEROMETER, 0)
    wave = np.sin(10 * np.pi * where.world.session.time / where.world.session.time[-1])
    session = with_readings(where.measured(1), 0.12 * 5e-4 * wave[:, None] * np.eye(6)[2])
    (finding,) = diagnose(session, catalogue=(*CATALOGUE, MoonTide())).findings
    assert (finding.cause, finding.sensors) == ("moon-tide", ("A3",))
    assert abs(finding.amplitude[0] - 5e-4) < 4 * finding.sigma[0]
    assert finding.sentence == "The moon pulls at A3."
