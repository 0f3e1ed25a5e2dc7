"""What came in, and what became of it."""

from datetime import datetime

from pydantic import BaseModel, Field

from service.api.schemas.problem import Fault, faults
from service.api.schemas.sessions import SaidSession, said_session
from service.records.arrival import Arrival, Refusal, under_way
from service.records.job import Job
from service.records.session import StoredSession


class UploadSchema(BaseModel):
    """One file that came in: it was stored as a session, or refused and nothing of it stored, or a job works on it."""

    id: str = Field(description="The session's id, or `r` and the number of the refusal, or `j` and that of its job.")
    at: datetime = Field(description="When it came, UTC.")
    filename: str = Field(description="What the file was called.")
    sha256: str = Field(description="SHA-256 of its bytes.")
    size: int = Field(description="Bytes.")
    stored: bool = Field(description="Whether it became a session.")
    session: SaidSession | None = Field(description="The session that it became.")
    problems: list[Fault] = Field(description="Why it was refused: every fault with its place.")
    job: str = Field(default="", description="Address of the job that works, or worked, on it.")


def job_upload_schema(job: Job, session: StoredSession | None, refusal: Refusal | None) -> UploadSchema:
    """An upload that a job works on, with what it became where that is known."""
    own = f"/api/v1/jobs/{job.id}"
    if session is not None or refusal is not None:
        came = Arrival(job.asked_at, session, refusal)
        return upload_schema(came).model_copy(update={"job": own})
    assert job.sent is not None
    return UploadSchema(
        id=under_way(job.id), at=job.asked_at, filename=job.subject, sha256=job.sent.sha256, size=job.sent.size,
        stored=False, session=None, problems=[], job=own,
    )  # fmt: skip


class UploadPage(BaseModel):
    """Uploads, newest first."""

    under_way: list[UploadSchema] = Field(
        description="What came in and a job still works on: all of it where the list begins, none where it goes on, or "
        "where `refused` ones are asked for."
    )
    uploads: list[UploadSchema] = Field(description="What came in and was stored or refused.")
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
        session=None if arrival.session is None else said_session(arrival.session),
        problems=faults(problems),
    )
