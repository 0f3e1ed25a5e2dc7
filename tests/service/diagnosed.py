"""Sessions with a hidden effect, from the tests' own generator, given to the service over HTTP."""

import json
from functools import cache
from typing import Any

import httpx

from estimator.session import ACCELEROMETER, CalibrationSession
from estimator.writing import session_document
from tests.blind.case import Case
from tests.blind.cases import draw_case
from tests.conftest import Holding
from tests.estimator.causes.hiding import change, scene, with_readings
from tests.estimator.diagnosis.small import measured, stated, swaying
from tests.service.made_sessions import session_id

LONGEST = 16
TEMPERATURE = ("single", (77, 3), "bias-temperature")
"""A5 follows the temperature, told apart from every rival by more than five standard errors."""
ECCENTRIC = ("single", (77, 25), "beta-scale")
UNEXPLAINED = ("outside", (5, 1), "fifth-harmonic")
DOUBTED = ("two", (13, 34), None)
"""A2 steps while the stand is not level; a course that nobody knows would explain the step almost as well."""
ALIASES = ("single", (77, 0), "cubic-nonlinearity")


@cache
def drawn(what: tuple[str, tuple[int, ...], str | None]) -> Case:
    """A case by its kind, seed and cause."""
    return draw_case(*what, LONGEST)


def warm(seed: int, started_at: str, *, follows: bool = True) -> dict[str, Any]:
    """A session of a unit whose A2 follows the temperature, or does not yet."""
    where = scene(ACCELEROMETER, 2)
    session = where.measured(seed)
    if follows:
        session = with_readings(session, change("bias-temperature", where) * where.world.truth.scale)
    return session_document(session) | {"unit": "WARM-1", "started_at": started_at}


def swaying_stand() -> dict[str, Any]:
    """A session on a stand whose head nods twice a turn, more in the second run."""
    return dated(measured(swaying(2e-4)), "SWAY-1")


def boasting() -> dict[str, Any]:
    """A sound session whose file states a quarter of the standard errors that readings have."""
    return dated(stated(measured(seed=3), 0.25), "BOAST-1")


def dated(session: CalibrationSession, unit: str) -> dict[str, Any]:
    """The session's file, of a unit and a day."""
    return session_document(session) | {"unit": unit, "started_at": "2026-03-05T08:00:00Z"}


def send(client: httpx.Client, document: dict[str, Any]) -> str:
    """Uploads a session and returns its id."""
    answer = client.post("/api/v1/sessions", content=json.dumps(document))
    assert answer.status_code in (200, 201), answer.text
    return str(answer.json()["id"])


def files_of(case: Case) -> tuple[bytes, ...]:
    """A case's history, then its session, as files of a unit of its own."""
    own = {"unit": f"{case.session['unit']}-{case.label}"}
    return tuple(json.dumps(document | own).encode() for document in (*case.history, case.session))


def held(holding: Holding, what: tuple[str, tuple[int, ...], str | None]) -> tuple[httpx.Client, str]:
    """A service that holds a case with its diagnosis, and the id of its session."""
    files = files_of(drawn(what))
    return holding(*files, diagnosed=True), session_id(files[-1])


def diagnosis_of(client: httpx.Client, id: str) -> dict[str, Any]:
    """imu-diagnosis/1 of a stored session."""
    answer = client.get(f"/api/v1/sessions/{id}/diagnosis")
    assert answer.status_code == 200, answer.text
    document: dict[str, Any] = answer.json()
    return document


def accepted(client: httpx.Client, id: str) -> tuple[dict[str, Any], int]:
    """The only finding of a session, and the model revision since it was accepted for the stand."""
    [finding] = diagnosis_of(client, id)["findings"]
    own = {"cause": finding["cause"], "scope": "stand", "by": "K. Ito"}
    revision = client.post(f"/api/v1/sessions/{id}/diagnosis/accept", json=own).json()["id"]
    unit = client.get(f"/api/v1/sessions/{id}").json()["unit"]
    client.post(f"/api/v1/units/{unit}/recalibrate").raise_for_status()
    return finding, revision
