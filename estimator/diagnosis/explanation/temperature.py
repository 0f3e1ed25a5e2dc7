"""Changes of parameters that a change of temperature since the earlier sessions can explain as well as a drift.

The bias and scale of a sound sensor follow the temperature by a law that no session at one temperature shows. A session
far from the temperatures of its history compares parameters under two conditions, and cannot tell which of the two
changed: the sensor or the room. A session at the temperature of the others can.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.causes.catalogue import UNEXPLAINED
from estimator.diagnosis.results import Finding, Rival, Separation
from estimator.message import joined, say
from estimator.session import Array

LEAST_DIFFERENCE = 5.0
"""°C from which on two sessions were measured at different temperatures: laboratories that are held at 20 ± 2 °C differ
by less through all seasons, while 30 µg and 100 ppm per °C, usual of sensors without compensation, are worth whole
tolerances beyond it."""

BIAS, SCALE = "bias-temperature", "scale-temperature"
OF_TEMPERATURE = frozenset({BIAS, SCALE})
"""Causes that a change between sessions may be, where their temperatures differ."""
OF_ALL_SENSORS = {"gravity-entry": (SCALE,), "alpha-entry": (BIAS,)}
"""Effects of temperature on all sensors alike, by the change between sessions that looks the same."""
DRIFT = "sensor-drift"


@dataclass(frozen=True)
class Temperatures:
    """A session's temperature, and that of its history, °C."""

    now: float
    usual: float

    @property
    def difference(self) -> float:
        """°C."""
        return abs(self.now - self.usual)


def temperatures(session: Array | None, history: Sequence[Array | None]) -> Temperatures | None:
    """The temperatures of a session and of most of its history; None where they are alike or not known.

    Parameters
    ----------
    session : (R,) °C of its rows; None where it was not recorded.
    history : the same of every earlier session. What one runs through, it covers.
    """
    known = [rows for rows in history if rows is not None]
    if session is None or not known:
        return None
    now = float(session.mean())
    nearest = np.array([np.clip(now, rows.min(), rows.max()) for rows in known])
    usual = now + float(np.median(nearest - now))
    pair = Temperatures(now, usual)
    return pair if pair.difference > LEAST_DIFFERENCE else None


def with_temperature(findings: Sequence[Finding], temperatures: Temperatures | None) -> tuple[Finding, ...]:
    """The findings; changes since the history have temperature beside them where it changed as well."""
    return tuple(findings if temperatures is None else (compared_with_temperature(f, temperatures) for f in findings))


def compared_with_temperature(finding: Finding, temperatures: Temperatures) -> Finding:
    """One finding with the rivals by which temperature explains it."""
    rivals = tuple(name for name in rivals_of(finding) if name not in finding.alternatives)
    if not rivals:
        return finding
    named = tuple(name for name in rivals if name != UNEXPLAINED)
    again = say("measure again at about {temperature} °C", temperature=f"{temperatures.usual:.0f}")
    separated = tuple(Separation(name, finding.sensors, 0.0, again, finding.strength) for name in named)
    compared = replace(
        finding,
        alternatives=(*named, *finding.alternatives, *(name for name in rivals if name == UNEXPLAINED)),
        separations=(*separated, *finding.separations),
        ranking=tuple(shared(finding, named)),
        advice=say(
            "Measure again at about {usual_temperature} °C, as in the earlier sessions, or calibrate over "
            "temperature, before you act on this: the session was measured at {temperature} °C.",
            usual_temperature=f"{temperatures.usual:.0f}",
            temperature=f"{temperatures.now:.0f}",
        ),
    )
    return (
        replace(compared, sentence=temperature_advice(compared, temperatures)) if finding.cause == DRIFT else compared
    )


def temperature_advice(finding: Finding, temperatures: Temperatures) -> str:
    """The facts known of a drift, and no more."""
    sensors = joined(", ", finding.sensors)
    return say(
        "The parameters of {sensors} differ from those of the earlier sessions, and the "
        "temperature differs by {difference} °C.",
        sensors=sensors,
        difference=f"{temperatures.difference:.0f}",
    )


def rivals_of(finding: Finding) -> tuple[str, ...]:
    """Causes by which temperature moves what has moved; of axes alone it is none of the catalogue."""
    if finding.cause != DRIFT:
        return OF_ALL_SENSORS.get(finding.cause, ())
    scales, biases = any(finding.amplitude[0::4]), any(finding.amplitude[1::4])
    return tuple(name for name, acts in ((BIAS, biases), (SCALE, scales)) if acts) or (UNEXPLAINED,)


def shared(finding: Finding, rivals: Sequence[str]) -> list[Rival]:
    """The ranking, in which a cause shares its probability evenly with rivals that do the same to these sessions."""
    ranked = list[Rival]()
    for rival in finding.ranking:
        if rival.cause != finding.cause:
            ranked.append(rival)
            continue
        part = replace(rival, probability=rival.probability / (1 + len(rivals)))
        ranked += [part, *(replace(part, cause=name) for name in rivals)]
    return ranked
