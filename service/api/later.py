"""A large upload whose sender asks for it is acknowledged once it is safe on disk, and worked on as a job.

Whoever does not ask, and whoever sends a small file or one that is there already, gets the answer that they always got.
"""

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Request
from fastapi.responses import JSONResponse
from pydantic import TypeAdapter

from service.admission import PersonOf
from service.api.schemas.jobs import JobAnswer, job_answer
from service.background.job_desk import JobDesk
from service.dependencies import JobDeskOf
from service.flows.receive import Reception
from service.flows.take_in import is_long
from service.ingest.limits import in_force
from service.records.identity import Person
from service.records.received import SentFile

PREFER, ASYNC = "Prefer", "respond-async"
"""Header and preference of RFC 7240."""
ACCEPTED = 202
JSON = TypeAdapter(JobAnswer)


@dataclass(frozen=True)
class Later:
    """How one request wants to be answered."""

    is_asked_for: bool
    longer_than: int
    desk: JobDesk
    person: Person

    def is_for(self, file: SentFile, reception: Reception) -> bool:
        """Whether this file is worked on later."""
        return self.is_asked_for and is_long(reception.storage, file, self.longer_than)

    def accepted(self, file: SentFile, reception: Reception) -> JSONResponse:
        """The job, with its address; what becomes of the upload is told there too."""
        job = self.desk.take_in(reception, file, self.person)
        headers = {"Location": f"/api/v1/jobs/{job.id}", "Preference-Applied": ASYNC}
        return JSONResponse(JSON.dump_python(job_answer(job), mode="json"), ACCEPTED, headers)


def _later(request: Request, desk: JobDeskOf, person: PersonOf) -> Later:
    asked = ",".join(request.headers.getlist(PREFER)).lower().split(",")
    is_asked = any(one.split(";")[0].strip() == ASYNC for one in asked)
    return Later(is_asked, in_force().later, desk, person)


LaterOf = Annotated[Later, Depends(_later)]
"""Whether the sender wants a large file to be worked on later, and how it is then answered."""
