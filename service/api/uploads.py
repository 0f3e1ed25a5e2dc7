"""What became of the files that came in: stored, or refused."""

from typing import Annotated

from fastapi import APIRouter, Path, Query

from service.api.schemas.fields import Limit, Text
from service.api.schemas.problem import errors
from service.api.schemas.uploads import UploadPage, UploadSchema, job_upload_schema, upload_schema
from service.dependencies import Reading
from service.errors import NotFoundError
from service.records.arrival import Arrival, ArrivalQuery, job_number, refusal_number
from service.records.job import JobKind
from service.storage.store import Store

router = APIRouter(prefix="/uploads", tags=["sessions"])
FileName = Annotated[Text | None, Query(alias="q", description="Part of the file's name.")]
Refused = Annotated[bool, Query(description="Only those that were refused.")]
UploadId = Annotated[
    Text, Path(description="A session's id, or `r` and the number of a refusal, or `j` and that of a job.")
]
After = Annotated[
    Text | None, Query(description="The list goes on after this upload: `next_after` of the last answer.")
]


@router.get("", responses=errors(422))
def list_uploads(
    store: Reading, text: FileName = None, refused: Refused = False, after: After = None, limit: Limit = 100
) -> UploadPage:
    """Every file that came in, newest first, and what became of it; those that a job still works on apart."""
    refusal = refusal_number(after or "")
    session = after if refusal is None else None
    wanted = ArrivalQuery(text, refused, after_session=session, after_refusal=refusal, limit=limit + 1)
    jobs = () if after or refused else store.jobs.open_uploads(text)
    found = store.arrivals.page(wanted)  # after the jobs: a file that ends meanwhile is in both, not in neither
    shown = found[:limit]
    return UploadPage(
        under_way=[job_upload_schema(job, None, None) for job in jobs],
        uploads=[upload_schema(one) for one in shown],
        next_after=shown[-1].name if len(found) > limit else None,
    )


@router.get("/{id}", responses=errors(404, 422))
def read_upload(id: UploadId, store: Reading) -> UploadSchema:
    """What became of one file; of a refused one every fault with its place."""
    refusal, job = refusal_number(id), job_number(id)
    if job is not None:
        return _by_job(store, job)
    if refusal is not None:
        refused = store.arrivals.refusal(refusal)
        return upload_schema(Arrival(refused.at, None, refused))
    session = store.sessions.get(id)
    return upload_schema(Arrival(session.uploaded_at, session, None))


def _by_job(store: Store, number: int) -> UploadSchema:
    job = store.jobs.get(number)
    if job.kind is not JobKind.UPLOAD:
        raise NotFoundError(f"Job {number} takes in no upload.")
    session = store.sessions.get(job.session) if job.session else None
    return job_upload_schema(job, session, None if job.refusal is None else store.arrivals.refusal(job.refusal))
