"""The purpose of the product in one file: an effect is hidden in a simulated unit, and the service finds it.

A unit of six accelerometers is measured on a two-axis stand. Its readings are made here: by the model that the service
starts with, and one effect more. The session file goes to a running service over HTTP. The service says that its
simulation is wrong, names the cause with its amplitude, takes it into the model of what has it, and shows how much
better it predicts readings that took no part. What no catalogue has, it reports without a name.
"""

from dataclasses import dataclass
from html import unescape
from typing import Any

import httpx
import numpy as np

from estimator import Site, Stand
from estimator.session import ACCELEROMETER, Array, CalibrationSession, Sensor
from estimator.simulate import StandDraw, cone, draw_stand, scattered, simulate, stand_schedule
from estimator.writing import session_document
from tests.databases import one_engine

GRAVITY = 9.815
"""m/s²."""
SCALE = 0.12
"""V per m/s²."""
NOISE = 3e-6
"""One sigma of an averaged reading, V; 2.5 µg."""
SENSORS = tuple(
    Sensor(f"A{number}", ACCELEROMETER, axis, SCALE, "V") for number, axis in enumerate(cone(6, np.radians(54.7)), 1)
)
SCHEDULE = stand_schedule(
    SENSORS, Stand("S-1", alpha=np.radians(40)), Site(gravity=GRAVITY), positions=24, unit_name="HE-1"
)
"""24 positions of the head, direct and flipped."""
BETA: Array = np.asarray(SCHEDULE.beta)
"""(48,) the angle that the head shows, rad."""
A3 = 2
COVERAGE = 2.0
"""U = 2σ, 95 %."""

pytestmark = one_engine


def measured(head_error: Array | float = 0.0) -> CalibrationSession:
    """A session of the unit; ``head_error`` (48,): how far the head really stands from the angle that it shows, rad."""
    rng = np.random.default_rng(2026)
    unit = scattered(SENSORS, np.full(len(SENSORS), GRAVITY), rng)
    stand = StandDraw(draw_stand(SCHEDULE, rng).constant, np.zeros_like(BETA) + head_error)
    return simulate(SCHEDULE, unit, rng, noise=NOISE, draw=stand)


@dataclass(frozen=True)
class Service:
    """The running service, as a program talks to it."""

    http: httpx.Client

    def upload(self, session: CalibrationSession) -> str:
        """The identifier under which the session is stored."""
        document = session_document(session) | {"started_at": "2026-03-05T08:00:00Z"}
        answer = self.http.post("/api/v1/sessions", json=document).raise_for_status()
        return str(answer.json()["id"])

    def get(self, path: str) -> dict[str, Any]:
        """An answer."""
        answer: dict[str, Any] = self.http.get(f"/api/v1{path}").raise_for_status().json()
        return answer

    def simulation_fits(self, session: str) -> bool:
        """Whether the model in force explains the readings: χ² of what it leaves, at the level of 0.1 %."""
        return bool(self.get(f"/sessions/{session}/calibration")["fit"]["p_value"] > 0.001)

    def extend_model(self, session: str, cause: str, scope: str) -> None:
        """An engineer accepts the cause, and the unit is calculated again."""
        accepted = {"cause": cause, "scope": scope, "by": "K. Ito"}
        self.http.post(f"/api/v1/sessions/{session}/diagnosis/accept", json=accepted).raise_for_status()
        self.http.post("/api/v1/units/HE-1/recalibrate").raise_for_status()


def assert_found_and_modelled(
    service: Service, session: str, *, cause: str, sensors: list[str], amplitude: list[float], scope: str
) -> None:
    """Asserts that a simulation that was wrong becomes right, for an effect whose truth is known."""
    assert not service.simulation_fits(session)

    diagnosis = service.get(f"/sessions/{session}/diagnosis")
    [finding] = diagnosis["findings"]
    assert (finding["cause"], finding["sensors"], finding["alternatives"]) == (cause, sensors, [])
    expanded = COVERAGE * np.array(finding["sigma"])
    assert np.all(np.abs(np.array(finding["amplitude"]) - amplitude) < expanded), finding
    assert np.linalg.norm(expanded) < 0.2 * np.linalg.norm(amplitude)  # an amplitude, not a guess
    assert finding["sentence"] in unescape(service.http.get(f"/sessions/{session}/diagnosis").text)

    without, with_cause = diagnosis["gain"]["before"], diagnosis["gain"]["after"]
    assert diagnosis["gain"]["held_out"] == "positions"  # each predicted from the others
    assert with_cause["rms"] < 0.5 * without["rms"]
    assert 0.8 < with_cause["chi2_per_dof"] < 1.25

    service.extend_model(session, cause, scope)
    assert service.simulation_fits(session)
    [revision] = service.get("/models")["models"]
    assert (revision["cause"], revision["scope"]) == (cause, scope)


def test_a_sensor_that_is_not_linear(client: httpx.Client) -> None:
    """A3 reads k·a³ too much; the model ends with a²."""
    k = 1e-6  # s⁴/m², 96 µg at 1 g
    session = measured()
    acceleration = session.readings[:, A3] / SCALE
    session.readings[:, A3] += SCALE * k * acceleration**3

    service = Service(client)
    stored = service.upload(session)
    assert_found_and_modelled(service, stored, cause="cubic-nonlinearity", sensors=["A3"], amplitude=[k], scope="unit")


def test_a_stand_whose_head_is_off_centre(client: httpx.Client) -> None:
    """The head's error goes round once a turn, which all six sensors feel."""
    sine, cosine = 3e-5, -2e-5  # rad, 6″ and −4″
    service = Service(client)
    stored = service.upload(measured(sine * np.sin(BETA) + cosine * np.cos(BETA)))
    assert_found_and_modelled(
        service, stored, cause="beta-eccentricity", sensors=[], amplitude=[sine, cosine], scope="stand"
    )


def test_an_effect_that_no_catalogue_has(client: httpx.Client) -> None:
    """The head's error goes round five times a turn: it is reported, located, and not named."""
    service = Service(client)
    stored = service.upload(measured(3e-5 * np.sin(5 * BETA)))
    assert not service.simulation_fits(stored)

    diagnosis = service.get(f"/sessions/{stored}/diagnosis")
    assert (diagnosis["findings"], diagnosis["unexplained"]) == ([], True)
    assert diagnosis["summary"] == (
        "An effect common to all sensors, of the stand or fixture, that no known cause explains: the applied vector "
        "deviates in β, harmonic 5 of β."
    )


def test_nothing_is_found_where_nothing_is_hidden(client: httpx.Client) -> None:
    service = Service(client)
    stored = service.upload(measured())
    assert service.simulation_fits(stored)
    diagnosis = service.get(f"/sessions/{stored}/diagnosis")
    assert (diagnosis["findings"], diagnosis["unexplained"]) == ([], False)
