"""A unit whose sessions were measured at different temperatures gets its due date, its services and its verdicts."""

import httpx
import pytest

from service.app import create_app
from service.settings import Settings
from tests.patience import until
from tests.service.made_sessions import session_bytes
from tests.serving import http_client

UNIT = "BA-017"
TEMPERATURES = (18.0, 20.5, 23.0, 25.5, 28.0, 18.5)
"""°C, of six sessions: of the last five too a coefficient is looked for."""
SERVICE = {"kind": "service", "at": "2026-01-15T00:00:00Z", "note": "connector", "by": "K. Ito"}


def upload_all(client: httpx.Client) -> list[int]:
    return [
        client.post("/api/v1/sessions", content=session_at(month, degrees)).status_code
        for month, degrees in enumerate(TEMPERATURES, 1)
    ]


def session_at(month: int, degrees: float) -> bytes:
    plain = session_bytes(seed=month, month=month)
    return plain.replace(b'"temperature_c": [21.0', b'"temperature_c": [' + str(degrees).encode()).replace(
        b", 21.0", b", " + str(degrees).encode()
    )


def due(client: httpx.Client) -> str:
    """The due date, as soon as the outlook that is worked out beside the requests is there."""
    return until(lambda: client.get(f"/api/v1/units/{UNIT}/outlook").raise_for_status().json()["due"])


@pytest.mark.parametrize("workers", [0, 1])
def test_sessions_at_other_temperatures_bring_a_due_date(settings: Settings, workers: int) -> None:
    with http_client(create_app(settings.model_copy(update={"diagnosis_workers": workers}))) as client:
        assert upload_all(client) == [201] * len(TEMPERATURES)
        assert due(client)
        service = client.post(f"/api/v1/units/{UNIT}/services", json=SERVICE)
        assert service.status_code == 201
        assert due(client)
