"""The effect of temperature on a session's parameters, by the law that the unit's earlier sessions follow, and the
session as it would have been at the temperature of its reference.

The change y of a bias or scale since the reference, at sessions i measured at T_i:

    y_i = a + d·f(t_i) + b·(T_i − T̄) + c·(T_i − T̄)² + e_i,    e_i ~ N(0, σ_i² + τ²)

f is the likeliest change through time of the readings as they are: a law is found only where it shows beside it, so a
sensor that changed when the room did is not taken for one that follows the room. How likely chance makes one is said by
`warmth`. c is fitted wherever the temperatures can show it, small or not: what it could be is then in the uncertainty.
τ is what scatters about the law beyond the noise, hysteresis among it; χ² per degree of freedom is brought to 1 (Mandel
and Paule 1982). A session and its reference each lie off the law by it, so with s the step in the columns

    worth = sᵀθ,    u² = sᵀ·cov θ·s + 2τ²,    known to n − rank degrees of freedom where τ > 0
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from estimator.coverage import combined, coverage_factor
from estimator.health.detection import LEVEL, most_likely
from estimator.health.deviation import deviation
from estimator.health.fits import LEAST, Readings
from estimator.health.rule import tolerance_of
from estimator.health.type_law import ENOUGH_WITH_TYPE, TypeLaw, worth_by
from estimator.health.warmth import ENOUGH_TO_BEND, WARMED, chance_of, shown_columns
from estimator.results import COVERAGE, Calibration, Estimate, SensorCalibration
from estimator.session import Array
from estimator.significance import single_level

FOLLOW = ("scale", "bias")
"""Parameters that follow the temperature by a law of the sensor's own."""
NEAR = 1.0
"""°C within which a session is at its reference's temperature: no room is known better."""
REACH = 5.0
"""°C from the nearest session before it within which a law holds for a session: neither its ends nor a gap tell of
more."""
Place = tuple[str, str]
"""Sensor and parameter."""


@dataclass(frozen=True)
class TemperatureStep:
    """The effect on one parameter of going from the reference's temperature to the session's."""

    worth: float
    """Relative for a scale factor, else SI."""
    sigma: float
    """One sigma of the effect, with the scatter about the law; the same unit."""
    dof: float | None
    """Degrees of freedom of sigma; None where the sessions scatter by no more than their noise."""
    temperature: float
    """°C of the session."""
    reference_temperature: float
    """°C of the reference."""
    sessions: int
    """Number of sessions the law was learned from."""
    lowest: float | None = None
    """°C of the coldest of them; None of a law from before this was kept."""
    highest: float | None = None
    """°C of the warmest."""
    units: int = 0
    """Number of units of its type that it was also learned from."""


@dataclass(frozen=True, kw_only=True)
class TemperatureCorrection(TemperatureStep):
    """A change from the reference without what temperature is worth in it."""

    measured: float
    """Change from the reference at the session's temperature: relative for a scale factor, else SI."""
    corrected: float
    """Change from the reference at the reference's temperature; the same unit."""
    expanded: float
    """U of the corrected change, the law's share in it."""


Steps = Mapping[Place, TemperatureStep]
NO_STEPS: Steps = {}


@dataclass(frozen=True, eq=False)
class Seen:
    """A session that a law is learned from."""

    years: float
    """Time of measurement, years from an arbitrary origin."""
    celsius: float
    """°C, its mean temperature."""
    calibration: Calibration


@dataclass(frozen=True, eq=False)
class LawHistory:
    """Values of one sensor's parameter over sessions at n temperatures."""

    readings: Readings
    """The readings, with the likeliest change through time as a regressor of any size."""
    celsius: Array
    """(n,) °C of each session."""


def can_tell(learned: Sequence[float], reference: float, now: float, enough: int = ENOUGH_TO_BEND) -> bool:
    """Whether sessions at these temperatures, °C, can determine the effect of a temperature other than the
    reference's.
    """
    if abs(now - reference) < NEAR or len(learned) < enough:
        return False
    return bool(np.std(learned) >= WARMED and min(abs(now - celsius) for celsius in learned) <= REACH)


def temperature_steps(
    learned: Sequence[Seen],
    reference: Calibration,
    between: tuple[float, float],
    tolerances: Mapping[Place, float],
    laws: Sequence[TypeLaw] = (),
) -> dict[Place, TemperatureStep]:
    """The effect of temperature on every parameter whose law is found, by sensor and parameter.

    Parameters
    ----------
    learned : the sessions before, the reference among them, in order of time.
    between : °C of the reference and of the session.
    tolerances : T by kind of sensor, or sensor, and parameter, relative for scale, else SI.
    laws : of the unit's type. By them, too, something is taken off where it leaves the parameter decidable.
    """
    of_type = {(law.kind, law.parameter): law for law in laws}
    cases = [
        (sensor, parameter, allowed)
        for sensor in reference.sensors
        for parameter in FOLLOW
        if (allowed := tolerance_of(tolerances, sensor.name, sensor.kind, parameter)) is not None
    ]
    level = single_level(LEVEL, max(len(cases), 1))
    found = {
        (s.name, parameter): _step(learned, (s, parameter, t), between, (level, of_type.get((s.kind, parameter))))
        for s, parameter, t in cases
    }
    return {place: step for place, step in found.items() if step is not None}


def _step(
    learned: Sequence[Seen],
    place: tuple[SensorCalibration, str, float],
    between: tuple[float, float],
    level_and_law: tuple[float, TypeLaw | None],
) -> TemperatureStep | None:
    """Takes the type's law where it leaves the parameter decidable, else the sessions' own law where they show one.

    ``place``: a sensor of the reference, a parameter and T; ``level_and_law``: the chance of a law where
    none is, and the type's."""
    (origin, parameter, allowed), (level, law) = place, level_and_law
    unit = allowed if law is None else law.tolerance
    history = history_of(learned, origin, parameter, unit)
    if history is None or len(history.celsius) < ENOUGH_WITH_TYPE:
        return None
    shows = _shows(history, level)
    if law is None:
        return _as_step(_own_worth(history, between), unit, between, history.celsius) if shows else None
    found = worth_by(history.readings, history.celsius, law, between)
    step = replace(_as_step(found, unit, between, history.celsius), units=law.units)
    return step if shows or coverage_factor(COVERAGE, step.dof) * step.sigma <= allowed else None


def _shows(history: LawHistory, level: float) -> bool:
    """Whether the sessions follow the temperature more closely than chance allows."""
    celsius = history.celsius
    is_spread = len(celsius) >= ENOUGH_TO_BEND and celsius.std() >= WARMED
    return bool(is_spread and chance_of(history.readings, celsius) < level)


def _own_worth(history: LawHistory, between: tuple[float, float]) -> tuple[float, float, float | None]:
    celsius = history.celsius
    columns, step = shown_columns(celsius), np.array(between) - celsius.mean()
    return _worth(history.readings, columns, np.array([step[1] - step[0], step[1] ** 2 - step[0] ** 2]))


def _as_step(
    found: tuple[float, float, float | None], allowed: float, between: tuple[float, float], celsius: Array
) -> TemperatureStep:
    """``found``: worth and its variance in tolerances, and degrees of freedom."""
    worth, variance, dof = found
    span = float(celsius.min()), float(celsius.max())
    u = float(np.sqrt(variance))
    return TemperatureStep(worth * allowed, u * allowed, dof, between[1], between[0], len(celsius), *span)


def history_of(learned: Sequence[Seen], origin: SensorCalibration, parameter: str, allowed: float) -> LawHistory | None:
    """A parameter of a sensor over sessions, in tolerances; None where none of them states it."""
    rows = [row for session in learned if (row := _row(session, origin, parameter)) is not None]
    if not rows:
        return None
    years, celsius, change, sigma = np.array(rows).T
    n = len(years)
    readings = Readings(years - years[0], change[:, None] / allowed, sigma[:, None] / allowed, np.ones((n, 1)), _ONE)
    likely = most_likely(readings, 0.0, np.full(n, np.inf))
    if likely is not None:
        base = np.concatenate([readings.base, likely.column[:, None]], axis=1)
        readings = replace(readings, base=base, now=np.append(_ONE, likely.column[-1]))
    return LawHistory(readings, celsius)


_ONE = np.ones(1)


def _row(session: Seen, origin: SensorCalibration, parameter: str) -> tuple[float, ...] | None:
    """Years, °C, change and its sigma that the session brings; None where it does not tell the parameter."""
    sensor = next((s for s in session.calibration.sensors if s.name == origin.name and s.kind == origin.kind), None)
    found = None if sensor is None else deviation(sensor, origin, parameter)
    if found is None or not found.is_finite:
        return None
    return session.years, session.celsius, float(found.vector[0]), float(np.sqrt(found.current[0, 0]))


def _worth(readings: Readings, columns: Array, step: Array) -> tuple[float, float, float | None]:
    """Worth, T, its variance, T², and degrees of freedom of a step (2,) in columns (n, q), °C and °C²."""
    design, q = np.concatenate([readings.base, columns], axis=1), columns.shape[1]
    noise = np.maximum(readings.sigma[:, 0], LEAST) ** 2
    free = len(design) - int(np.linalg.matrix_rank(design))
    scatter = _scatter(design, readings.value[:, 0], noise, free)
    size, covariance, _ = _fitted(design, readings.value[:, 0], noise + scatter)
    along = np.concatenate([np.zeros(design.shape[1] - q), step[:q]])
    return float(along @ size), float(along @ covariance @ along) + 2 * scatter, float(free) if scatter > 0 else None


def _fitted(design: Array, value: Array, variance: Array) -> tuple[Array, Array, float]:
    """Sizes (p,), their covariance (p, p) and χ² of weighted least squares, in the units of the design and value."""
    covariance = np.linalg.pinv((design.T / variance) @ design, hermitian=True)
    size = covariance @ (design.T @ (value / variance))
    return size, covariance, float(((value - design @ size) ** 2 / variance).sum())


def _scatter(design: Array, value: Array, noise: Array, free: int) -> float:
    """τ², unit of the value squared, that brings χ² to its degrees of freedom; 0 where noise alone does."""

    def excess(scatter: float) -> float:
        return _fitted(design, value, noise + scatter)[2] - free

    most = float((value - value.mean()) @ (value - value.mean()))
    if free < 1 or excess(0.0) <= 0:
        return 0.0
    return float(brentq(excess, 0.0, most))


def at_reference(calibration: Calibration, reference: Calibration, steps: Steps) -> Calibration:
    """The calibration as it would be at the reference's temperature, with the uncertainty of the steps."""
    if not steps:
        return calibration
    ones = {s.name: s.scale.value for s in reference.sensors}
    covariance, place = calibration.covariance.copy(), {name: i for i, name in enumerate(calibration.names)}
    for (name, parameter), step in steps.items():
        i = place.get(f"{name}.{parameter}")
        if i is not None:
            covariance[i, i] += (step.sigma * _unit(ones, name, parameter)) ** 2
    sensors = tuple(_moved(sensor, ones, steps) for sensor in calibration.sensors)
    return replace(calibration, sensors=sensors, covariance=covariance)


def _unit(ones: Mapping[str, float | None], name: str, parameter: str) -> float:
    """Factor that turns a step into a change of the parameter: the reference's scale, as scale steps are relative to
    it.
    """
    return (ones.get(name) or 0.0) if parameter == "scale" else 1.0


def _moved(sensor: SensorCalibration, ones: Mapping[str, float | None], steps: Steps) -> SensorCalibration:
    scale, bias = (steps.get((sensor.name, parameter)) for parameter in FOLLOW)
    return replace(
        sensor,
        scale=_freed(sensor.scale, scale, _unit(ones, sensor.name, "scale")),
        bias=_freed(sensor.bias, bias, 1.0),
    )


def _freed(estimate: Estimate, step: TemperatureStep | None, unit: float) -> Estimate:
    """The estimate without the effect of temperature; ``unit``: size of one unit of the step, in the estimate's own."""
    if step is None or estimate.value is None or estimate.sigma is None:
        return estimate
    sigma = abs(step.sigma * unit)
    dof = combined((estimate.sigma**2, estimate.dof), (sigma**2, step.dof))
    return replace(
        estimate, value=estimate.value - step.worth * unit, sigma=float(np.hypot(estimate.sigma, sigma)), dof=dof
    )


def corrections(
    sessions: tuple[Calibration, Calibration], reference: Calibration, steps: Steps, k: float
) -> dict[Place, TemperatureCorrection]:
    """The corrections of a session, by sensor and parameter.

    Parameters
    ----------
    sessions : the session as measured, and `at_reference`.
    k : coverage factor for known noise.
    """
    found, known = {}, {sensor.name for sensor in sessions[0].sensors}
    for (name, parameter), step in steps.items():
        measured_and_moved = sessions if name in known else ()
        changes = [deviation(session.sensor(name), reference.sensor(name), parameter) for session in measured_and_moved]
        measured, moved = changes or (None, None)
        if measured is not None and moved is not None:
            expanded = coverage_factor(k, moved.dof) * float(np.sqrt(moved.covariance[0, 0]))
            values = {"measured": float(measured.vector[0]), "corrected": float(moved.vector[0]), "expanded": expanded}
            found[name, parameter] = TemperatureCorrection(**vars(step) | values)
    return found
