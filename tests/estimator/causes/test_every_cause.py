"""One contract for every cause of the catalogue: complete in words, true in physics, found when there and only then."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.applied_vector import stand_geometry
from estimator.causes import CATALOGUE, Cause, RecordCorrection, Setting, Shape, Signature, cause, find
from estimator.causes.contract import NEEDS
from estimator.diagnosis.posterior.absorbed import RECORDED
from estimator.diagnosis.residuals.fitted import stand_baseline
from estimator.session import CalibrationSession
from tests.estimator.calibration.cases import accelerometers, block, gyros
from tests.estimator.causes.physics import ACTED, SENSOR, World
from tests.estimator.causes.worlds import truth_of, wandering

SIGNATURES = [c for c in CATALOGUE if isinstance(c, Signature)]
CORRECTIONS = [c for c in CATALOGUE if isinstance(c, RecordCorrection)]
TABLE = [
    "cubic-nonlinearity",
    "scale-asymmetry",
    "cross-coupling",
    "bias-temperature",
    "bias-temperature-curve",
    "scale-temperature-curve",
    "scale-temperature",
    "bias-ramp",
    "warm-up",
    "bias-jump",
    "hysteresis",
    "saturation",
    "odd-quadratic",
    "bias-asymmetry",
    "cross-axis-quadratic",
    "scale-ramp",
    "axis-creep",
    "temperature-rate",
    "thermal-lag",
    "vibration-rectification",
    "bias-per-position",
    "reading-outlier",
    "excess-noise",
    "beta-eccentricity",
    "beta-second-harmonic",
    "beta-scale",
    "axis-wobble",
    "levelling-y",
    "alpha-shift",
    "flip-misalignment",
    "stand-drift",
    "positions-swapped",
    "channels-swapped",
    "sign-reversed",
    "runs-swapped",
    "beta-reversed",
    "alpha-entry",
    "gravity-entry",
    "sensor-drift",
    "remount-rotation",
    "g-sensitivity",
    "latitude-entry",
    "meridian-error",
]
"""The agreed identifiers."""
every = pytest.mark.parametrize("known", CATALOGUE, ids=lambda c: c.identifier)
every_signature = pytest.mark.parametrize("known", SIGNATURES, ids=lambda c: c.identifier)


def mixed() -> World:
    """Three accelerometers and three rate gyros of one block on the stand, time and temperature recorded."""
    rates = gyros(3, scale=1e4, unit="V")
    session = wandering(block((*accelerometers(3), *rates)))
    return World(session, truth_of(session))


WORLD = mixed()


def setting_of(world: World) -> Setting:
    """The setting of causes, at the true parameters."""
    nothing = np.zeros(world.session.readings.shape)
    geometry = stand_geometry(world.session)
    return stand_baseline(world.session, world.truth, geometry, nothing, nothing + 1).setting


SETTING = setting_of(WORLD)


def shapes(known: Signature) -> list[Shape]:
    """The shapes of a cause on the sensor under test, or its only ones."""
    found = list(known.shapes(SETTING))
    sensor = SENSOR + 3 * (known.kind == "gyroscope")
    return [s for s in found if s.sensors in ((), (sensor,))]


def test_the_catalogue_is_the_agreed_one() -> None:
    assert sorted(c.identifier for c in CATALOGUE) == sorted(TABLE)


@every
def test_is_found_by_its_identifier(known: Cause) -> None:
    assert cause(known.identifier) is known


@every
def test_says_what_is_wrong_and_what_to_do(known: Cause) -> None:
    assert known.equation
    assert known.sentence.format(sensors="A1").endswith(".")
    assert known.advice.endswith(".")
    assert known.scope in {"sensor", "environment", "stand", "fixture", "record", "gyro"}


@every
def test_needs_only_what_a_session_may_hold(known: Cause) -> None:
    assert known.needs <= NEEDS


@every_signature
def test_looks_at_nothing_recorded_that_it_does_not_need(known: Signature) -> None:
    full = replace(SETTING, vibration=np.linspace(1.0, 2.0, WORLD.session.readings.size).reshape(-1, 6))
    changed = {name: getattr(full, name)[::-1] ** 2 for name in RECORDED - known.needs}
    for shape in list(known.shapes(full))[::7]:
        assert np.array_equal(known.columns(replace(full, **changed), shape), shape.columns)


@every_signature
def test_every_shape_has_a_column_an_amplitude(known: Signature) -> None:
    for shape in known.shapes(SETTING):
        assert shape.columns.shape == (*WORLD.session.readings.shape, len(known.units))
        assert np.isfinite(shape.columns).all()


@every_signature
def test_every_shape_states_its_nonlinear_parameters(known: Signature) -> None:
    counts = {len(shape.nonlinear) for shape in known.shapes(SETTING)}
    assert counts == {4 if known.identifier == "sensor-drift" else len(known.nonlinear_units)}


@every_signature
def test_acts_on_the_sensors_that_it_is_blamed_on(known: Signature) -> None:
    for shape in known.shapes(SETTING):
        touched = set(np.flatnonzero(np.abs(shape.columns).sum(axis=(0, 2))))
        assert touched == set(shape.sensors) or (not shape.sensors and len(touched) > 1)


@every_signature
def test_sensor_causes_are_placed_on_every_sensor_of_their_kind(known: Signature) -> None:
    placed = {i for shape in known.shapes(SETTING) for i in shape.sensors}
    able = {i for i, kind in enumerate(SETTING.kinds) if known.kind in (None, kind)}
    assert placed in (set(), able)


@pytest.mark.parametrize("known", [c for c in SIGNATURES if c.identifier in ACTED], ids=lambda c: c.identifier)
def test_signature_is_the_derivative_of_the_effect_acted_out(known: Signature) -> None:
    for shape in shapes(known)[::5]:
        for q, column in enumerate(np.moveaxis(shape.columns, -1, 0)):
            size = np.abs(column).max(axis=0)
            k = 1e-5 * float((SETTING.norm / np.maximum(size, 1e-30)).min()) * np.eye(shape.columns.shape[-1])[q]
            sensor = shape.sensors[0] if shape.sensors else 0
            above, below = (ACTED[known.identifier](WORLD, s * k, sensor, shape.nonlinear) for s in (1, -1))
            assert np.all(np.abs((above - below) / (2 * k[q]) - column) < 1e-6 * size + 1e-25)


@pytest.mark.parametrize("side", [0.0, 1.0, -1.0])
def test_clipping_is_what_the_limit_takes_off(side: float) -> None:
    for shape in (s for s in shapes(cause("saturation")) if s.nonlinear[1] == side):
        limit, h = shape.nonlinear[0], WORLD.inputs(WORLD.vectors())[:, SENSOR]
        clipped = np.clip(h, -np.inf if side > 0 else -limit, np.inf if side < 0 else limit)
        assert np.allclose(shape.columns[:, SENSOR, 0], clipped - h, atol=1e-9)


@pytest.mark.parametrize("need", ["time", "temperature"])
def test_what_was_not_recorded_makes_its_causes_unavailable(need: str) -> None:
    setting = setting_of(replace(WORLD, session=replace(WORLD.session, **{need: None})))
    for known in SIGNATURES:
        assert known.available(setting) == (need not in known.needs)


def test_a_need_that_no_session_can_provide_is_an_error() -> None:
    with pytest.raises(ValueError, match="barometer"):
        setting_of(mixed()).has("barometer")


@pytest.mark.parametrize("known", CATALOGUE, ids=lambda c: c.identifier)
def test_a_model_holds_only_what_acts_in_every_session(known: Cause) -> None:
    one_time = isinstance(known, RecordCorrection) or known.between or known.passing or not isinstance(known, Signature)
    assert known.can_be_modelled == (not one_time)


def test_what_a_result_of_another_version_names_is_not_found() -> None:
    assert find("ghost-in-the-machine") is None


def test_one_run_makes_causes_of_two_unavailable() -> None:
    session = wandering(block(accelerometers(), runs=(False,)))
    setting = setting_of(World(session, truth_of(session)))
    assert not any(c.available(setting) for c in SIGNATURES if "both runs" in c.needs)


@pytest.mark.slow
@pytest.mark.parametrize("known", CORRECTIONS, ids=lambda c: c.identifier)
def test_a_correction_made_twice_is_none(known: RecordCorrection) -> None:
    session = WORLD.session
    rng = np.random.default_rng(1)
    session = replace(session, readings=rng.normal(size=session.readings.shape))
    for place, once in known.corrected(session):
        twice = dict(known.corrected(once))[place]
        assert same(twice, session)
        assert not same(once, session)


def same(a: CalibrationSession, b: CalibrationSession) -> bool:
    """Whether two records hold the same values."""
    columns = ("readings", "standard_errors", "flipped", "beta")
    return all(np.array_equal(getattr(a, name), getattr(b, name)) for name in columns)
