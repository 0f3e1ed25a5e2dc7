"""HTTP to a running service; its refusals become the errors of `service.errors`, with its own words."""

from dataclasses import dataclass
from http import HTTPStatus
from time import sleep
from typing import IO, Any

import httpx

from estimator.errors import Problem
from estimator.json_object import Json
from service.errors import AwayError, RefusedError, ServiceError

MOST_LOOKS = 10
"""Looks at whether a diagnosis is made; the service itself waits some seconds at each."""
MEDIA_TYPE = "application/problem+json"


@dataclass(frozen=True)
class Connection:
    """One connection to a service, for calls that have no method of their own."""

    server: str
    http: httpx.Client

    def get(self, path: str, **query: Any) -> httpx.Response:
        """Reads a resource below /api/v1; what is None is not asked for."""
        return self.answer("GET", path, params={name: value for name, value in query.items() if value is not None})

    def post(self, path: str, body: Json) -> Json:
        """Sends JSON to a resource below /api/v1."""
        answer: Json = self.answer("POST", path, json=body).json()
        return answer

    def put(self, path: str, body: Json) -> Json:
        """Puts JSON in the place of a resource below /api/v1."""
        answer: Json = self.answer("PUT", path, json=body).json()
        return answer

    def send(
        self, name: str, content: bytes | IO[bytes], stated: dict[str, str] | None = None, *, later: bool = False
    ) -> Json:
        """Sends a session file with what is ``stated`` of it; RefusedError with its problems when it is unusable.
        ``later``: a large one is answered with its job, once it was received."""
        headers = {"Prefer": "respond-async"} if later else {}
        response = self.answer("POST", "/sessions", files={"file": (name, content)}, data=stated or {}, headers=headers)
        answer: Json = response.json()
        return answer

    def is_diagnosed(self, session: str) -> bool:
        """Whether a session's diagnosis is made, some time after it was asked for."""
        for _ in range(MOST_LOOKS):
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
            raise ServiceError(f"{self.server} does not answer: {fault}") from fault
        if response.is_success:
            return response
        raise _error(response)


def _error(response: httpx.Response) -> ServiceError:
    """The service's problem+json as the error that it was; anything else by its status."""
    if not response.headers.get("content-type", "").startswith(MEDIA_TYPE):
        return ServiceError(f"{response.url} answered {response.status_code} {response.reason_phrase}")
    problem = response.json()
    if response.status_code == RefusedError.status:
        found = (Problem(p["field"], p["message"], p.get("row")) for p in problem.get("problems") or ())
        return RefusedError(problem["detail"], tuple(found))
    error: ServiceError = _KINDS.get(response.status_code, ServiceError)(problem["detail"])
    if isinstance(error, AwayError) and response.headers.get("Retry-After", "").isdecimal():
        error.retry_after = int(response.headers["Retry-After"])
    return error


_KINDS: dict[int, type[ServiceError]] = {
    kind.status: kind for kind in ServiceError.__subclasses__() if kind.status != ServiceError.status
}
"""Errors by their status."""
