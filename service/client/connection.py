"""HTTP to a running service; its refusals become errors of `service.errors`, with the service's messages."""

from dataclasses import dataclass
from http import HTTPStatus
from time import sleep
from typing import IO, Any

import httpx

from estimator.errors import Problem
from estimator.json_object import Json
from service.errors import AwayError, RefusedError, ServiceError

MAX_POLLS = 10
"""Polls for a diagnosis; the service itself waits some seconds at each."""
MEDIA_TYPE = "application/problem+json"


@dataclass(frozen=True)
class Connection:
    """One connection to a service, for calls without a method of their own."""

    server: str
    http: httpx.Client

    def get(self, path: str, **query: Any) -> httpx.Response:
        """Reads a resource below /api/v1; parameters of None are left out."""
        return self.answer("GET", path, params={name: value for name, value in query.items() if value is not None})

    def post(self, path: str, body: Json) -> Json:
        """Sends JSON to a resource below /api/v1."""
        answer: Json = self.answer("POST", path, json=body).json()
        return answer

    def send(
        self, name: str, content: bytes | IO[bytes], stated: dict[str, str] | None = None, *, later: bool = False
    ) -> Json:
        """Sends a session file with its form fields; RefusedError with its problems when it is unusable. ``later``: a
        large one is answered with its job after it was received."""
        headers = {"Prefer": "respond-async"} if later else {}
        response = self.answer("POST", "/sessions", files={"file": (name, content)}, data=stated or {}, headers=headers)
        answer: Json = response.json()
        return answer

    def is_diagnosed(self, session: str) -> bool:
        """Whether a session's diagnosis is made, after waiting for it."""
        for _ in range(MAX_POLLS):
            response = self.get(f"/sessions/{session}/diagnosis")
            if response.status_code != HTTPStatus.ACCEPTED:
                return True
            sleep(float(response.headers.get("Retry-After", "1")))
        return False

    def answer(self, method: str, path: str, **request: Any) -> httpx.Response:
        """The answer, or the error that it states."""
        try:
            response = self.http.request(method, path, **request)
        except httpx.HTTPError as fault:
            raise ServiceError("{server} does not answer: {fault}", server=self.server, fault=fault) from fault
        if response.is_success:
            return response
        raise _error(response)


def _error(response: httpx.Response) -> ServiceError:
    """The service's problem+json as its original error; any other answer by its status."""
    if not response.headers.get("content-type", "").startswith(MEDIA_TYPE):
        status = f"{response.status_code} {response.reason_phrase}"
        return ServiceError("{url} answered {status}", url=response.url, status=status)
    problem = response.json()
    if response.status_code == RefusedError.status:
        problems = (Problem(p["field"], p["message"], p.get("row")) for p in problem.get("problems") or ())
        return RefusedError(problem["detail"], tuple(problems))
    error: ServiceError = _KINDS.get(response.status_code, ServiceError)(problem["detail"])
    if isinstance(error, AwayError) and response.headers.get("Retry-After", "").isdecimal():
        error.retry_after = int(response.headers["Retry-After"])
    return error


_KINDS: dict[int, type[ServiceError]] = {
    kind.status: kind for kind in ServiceError.__subclasses__() if kind.status != ServiceError.status
}
