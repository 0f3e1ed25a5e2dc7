"""Errors of the service: one tree; the class is the status, and every answer has one shape (problem+json, RFC 9457).

ServiceError (500)
├── SignInError (401)         somebody must sign in first, or did so wrongly
├── ForbiddenError (403)      the sender may not do this
├── NotFoundError (404)       no such session, unit or unit type
├── ConflictError (409)       the request does not fit earlier actions
├── RefusedError (422)        an upload or a request that cannot be used; holds every problem with its place
├── TooLargeError (413)       an upload beyond the limit
├── TooOftenError (429)       wrong sign-ins in a row; try again after `retry_after`
├── NoSpaceError (507)        the disk is full; nothing was stored
├── DamagedError (500)        a stored file differs from the upload, and is not given out
└── AwayError (503)           the database or the folder of files cannot be used; try again after `retry_after`
    ├── BusyError (503)       too much is being read at once; nothing was stored
    └── PendingError (503)    the answer rests on results still being made; ask again after `retry_after`
"""

from http import HTTPStatus

from estimator.errors import Problem
from estimator.message import say


class ServiceError(Exception):
    """An error with a status and a sentence for the one who asked."""

    status = HTTPStatus.INTERNAL_SERVER_ERROR

    def __init__(self, detail: str, /, **parts: object) -> None:
        """``detail``: the sentence, or the template of one with its ``parts``."""
        self.detail = say(detail, **parts) if parts else detail
        super().__init__(self.detail)

    @property
    def title(self) -> str:
        """The status in words."""
        return self.status.phrase


class SignInError(ServiceError):
    """The sender must sign in first, or did so wrongly."""

    status = HTTPStatus.UNAUTHORIZED


class ForbiddenError(ServiceError):
    """The sender may not do this."""

    status = HTTPStatus.FORBIDDEN


class NotFoundError(ServiceError):
    """There is no such session, unit or unit type."""

    status = HTTPStatus.NOT_FOUND


class ConflictError(ServiceError):
    """The request does not fit earlier actions."""

    status = HTTPStatus.CONFLICT


class RefusedError(ServiceError):
    """An upload or a request that cannot be used; ``problems`` holds every fault with its place."""

    status = HTTPStatus.UNPROCESSABLE_ENTITY

    def __init__(self, detail: str, problems: tuple[Problem, ...]) -> None:
        super().__init__(detail)
        self.problems = problems


class TooLargeError(ServiceError):
    """An upload beyond the limit."""

    status = HTTPStatus.REQUEST_ENTITY_TOO_LARGE


class TooOftenError(ServiceError):
    """Too many wrong sign-ins in a row."""

    status = HTTPStatus.TOO_MANY_REQUESTS
    retry_after = 60


class NoSpaceError(ServiceError):
    """The disk is full; nothing was stored."""

    status = HTTPStatus.INSUFFICIENT_STORAGE


class DamagedError(ServiceError):
    """A stored file is not what was uploaded, and is not given out."""


class AwayError(ServiceError):
    """The database does not answer or its schema is not up to date, or the folder of files cannot be written."""

    status = HTTPStatus.SERVICE_UNAVAILABLE
    retry_after = 5
    """Seconds after which it is worth asking again."""


class BusyError(AwayError):
    """Too much that is costly is under way; nothing was stored."""


class PendingError(AwayError):
    """The answer rests on results that are still being made."""

    retry_after = 2
    """A larger session is diagnosed in that time."""
