"""Talking to a running service over HTTP; its refusals become the errors that commands already understand."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from http import HTTPStatus
from pathlib import Path
from time import sleep
from typing import Any

import httpx

from estimator.errors import Problem
from service.errors import RefusedError, ServiceError

TOKEN = "IMU_HEALTH_TOKEN"
"""Environment variable with the token of whoever calls; on a command line others on the machine could read it."""
MOST_LOOKS = 10
"""Looks at whether a diagnosis is made; the service itself waits some seconds at each."""
TIMEOUT = httpx.Timeout(300.0, connect=5.0)
"""Seconds; the report of a large fleet takes some tens."""


@contextmanager
def connected(server: str) -> "Iterator[Client]":
    """A client of the service at an address; ServiceError when it is no address."""
    try:
        http = httpx.Client(base_url=f"{server.rstrip('/')}/api/v1", timeout=TIMEOUT)
    except httpx.InvalidURL as fault:
        raise ServiceError(f"{server} is not an address: {fault}") from fault
    token = os.environ.get(TOKEN, "")
    if token:
        http.headers["Authorization"] = f"Bearer {token}"
    with http:
        yield Client(server, http)


@dataclass(frozen=True)
class Client:
    """One connection to a service."""

    server: str
    http: httpx.Client

    def upload(self, file: Path, stated: dict[str, str] | None = None) -> dict[str, Any]:
        """Sends a session file with what is ``stated`` of it; RefusedError with its problems when it is unusable."""
        sent = {"file": (file.name, file.read_bytes())}
        response = self._answer("POST", "/sessions", files=sent, data=stated or {})
        answer: dict[str, Any] = response.json()
        return answer

    def diagnosed(self, session: str) -> bool:
        """Whether a session's diagnosis is made, some time after it was asked for."""
        for _ in range(MOST_LOOKS):
            response = self._answer("GET", f"/sessions/{session}/diagnosis")
            if response.status_code != HTTPStatus.ACCEPTED:
                return True
            sleep(float(response.headers.get("Retry-After", "1")))
        return False

    def get(self, path: str, **query: str) -> httpx.Response:
        """Reads a resource below /api/v1."""
        return self._answer("GET", path, params=query)

    def post(self, path: str, body: dict[str, Any]) -> dict[str, Any]:
        """Sends JSON to a resource below /api/v1."""
        answer: dict[str, Any] = self._answer("POST", path, json=body).json()
        return answer

    def put(self, path: str, body: dict[str, Any]) -> dict[str, Any]:
        """Puts JSON in the place of a resource below /api/v1."""
        answer: dict[str, Any] = self._answer("PUT", path, json=body).json()
        return answer

    def _answer(self, method: str, path: str, **request: Any) -> httpx.Response:
        """The answer, or the error that it states."""
        try:
            response = self.http.request(method, path, **request)
        except httpx.HTTPError as fault:
            raise ServiceError(f"{self.server} does not answer: {fault}") from fault
        if response.is_success:
            return response
        raise _error(response)


def _error(response: httpx.Response) -> ServiceError:
    """The service's problem+json as an error; anything else by its status."""
    if not response.headers.get("content-type", "").startswith("application/problem+json"):
        return ServiceError(f"{response.url} answered {response.status_code} {response.reason_phrase}")
    problem = response.json()
    if response.status_code != HTTPStatus.UNPROCESSABLE_ENTITY:
        return ServiceError(problem["detail"])
    found = (Problem(p["field"], p["message"], p.get("row")) for p in problem.get("problems") or ())
    return RefusedError(problem["detail"], tuple(found))
