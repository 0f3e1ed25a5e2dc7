"""The one shape of every error: application/problem+json (RFC 9457)."""

from collections.abc import Iterable

from pydantic import BaseModel, ConfigDict, Field

from estimator.errors import Problem
from estimator.json_object import Json


class Fault(BaseModel):
    """One fault of a request."""

    field: str = Field(description="Where: a field of the file, a column, or a part of the request.")
    row: int | None = Field(description="Row of the table, counted from 1; null when it is not in one row.")
    message: str = Field(description="What is wrong, and what to do.")


class ProblemDocument(BaseModel):
    """Reason why a request was not carried out."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "type": "about:blank",
                "title": "Unprocessable Entity",
                "status": 422,
                "detail": "BA-017.json cannot be used: one problem. Nothing was stored.",
                "problems": [{"field": "A3", "row": 7, "message": "is not a number"}],
            }
        }
    )

    type: str = Field(description="`about:blank`: the status says what kind of problem it is.")
    title: str = Field(description="The status in words.")
    status: int = Field(description="The HTTP status.")
    detail: str = Field(description="What happened, in a sentence for people.")
    request_id: str | None = Field(
        default=None, description="The id of the request, under which the log of the service knows it."
    )
    problems: list[Fault] | None = Field(default=None, description="With 422: every fault with its place.")


def faults(problems: Iterable[Problem]) -> list[Fault]:
    """Problems as an answer lists them."""
    return [Fault(**vars(problem)) for problem in problems]


def errors(*statuses: int) -> dict[int | str, Json]:
    """OpenAPI entries of a route's problems; any route can find the database unavailable."""
    return {status: {"model": ProblemDocument} for status in (*statuses, 503)}
