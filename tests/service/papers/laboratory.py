"""A service whose operator has set everything that a certificate names."""

from collections.abc import Iterator
from contextlib import contextmanager

import httpx

from service.app import create_app
from service.settings import Settings
from tests.serving import http_client

LABORATORY = {
    "laboratory_name": "Inertial Laboratory North",
    "laboratory_address": "4 Gyro Street, 20095 Hamburg",
    "laboratory_country": "DE",
}
CUSTOMER = {"name": "Aero Works Ltd", "address": "1 Hangar Road, Derby", "by": "K. Ito"}
STAND = {
    "number": "D-K-117",
    "issued_by": "PTB",
    "issued_on": "2025-12-10",
    "valid_until": "2026-12-10",
    "by": "K. Ito",
}
"""The certificate of the stand of `tests.service.made_sessions`."""


@contextmanager
def named(settings: Settings, **changes: object) -> Iterator[httpx.Client]:
    """HTTP to a service of a laboratory that states everything; ``changes`` are other settings."""
    with http_client(create_app(settings.model_copy(update=LABORATORY | changes))) as client:
        yield client


def state_all(client: httpx.Client, unit: str = "BA-017", **changes: str) -> None:
    """Names the customer of a unit and the certificate of its stand; ``changes`` are of the latter."""
    client.put(f"/api/v1/units/{unit}/customer", json=CUSTOMER).raise_for_status()
    client.put("/api/v1/stands/ODG-1/certificate", json=STAND | changes).raise_for_status()
