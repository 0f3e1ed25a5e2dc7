"""What came in, and what became of it."""

from datetime import datetime

from pydantic import BaseModel, Field

from service.api.schemas.problem import Fault
from service.api.schemas.sessions import SessionSchema
from service.records.arrival import Arrival, Refusal
from service.records.session import StoredSession


class UploadSchema(BaseModel):
    """One file that came in: either it was stored as a session, or it was refused and nothing of it was stored."""

    id: str = Field(description="The session's id, or `r` and the number of the refusal.")
    at: datetime = Field(description="When it came, UTC.")
    filename: str = Field(description="What the file was called.")
    sha256: str = Field(description="SHA-256 of its bytes.")
    size: int = Field(description="Bytes.")
    stored: bool = Field(description="Whether it became a session.")
    session: SessionSchema | None = Field(description="The session that it became.")
    problems: list[Fault] = Field(description="Why it was refused: every fault with its place.")


class UploadPage(BaseModel):
    """Uploads, newest first."""

    uploads: list[UploadSchema] = Field(description="What came in.")
    next_after: str | None = Field(description="The list goes on with `after` this; null at its end.")


def upload_schema(arrival: Arrival) -> UploadSchema:
    """An upload as the API tells of it."""
    file: Refusal | StoredSession | None = arrival.refusal or arrival.session
    assert file is not None, "an arrival is one of the two"
    problems = () if arrival.refusal is None else arrival.refusal.problems
    return UploadSchema(
        id=arrival.name,
        at=arrival.at,
        filename=file.filename,
        sha256=file.sha256,
        size=file.size,
        stored=arrival.session is not None,
        session=None if arrival.session is None else SessionSchema.model_validate(arrival.session),
        problems=[Fault(field=one.field, row=one.row, message=one.message) for one in problems],
    )
