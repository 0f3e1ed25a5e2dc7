"""A typed client of a running service: upload, verdict, history, diagnosis, flags, certificate.

    from service.client import connect

    with connect("http://127.0.0.1:8000") as client:
        print(client.upload(Path("BA-900-003.json")).said)

It needs httpx and nothing else of the service; its errors are those of `service.errors`, with the service's messages.
"""

from service.client.answers import Diagnosis, Finding, Flag, Point, Receipt, Reservation, Session, Unit, Usable
from service.client.client import Client, connect

__all__ = [
    "Client",
    "Diagnosis",
    "Finding",
    "Flag",
    "Point",
    "Receipt",
    "Reservation",
    "Session",
    "Unit",
    "Usable",
    "connect",
]
