"""What routes ask for by type: readers of diagnoses and groups, the desk of long work."""

from collections.abc import Iterator
from typing import Annotated

from fastapi import Depends, Request

from service.storage.queries import Store
from service.web.application import application_of
from service.work.job_desk import JobDesk
from service.work.readers import GroupReader, Reader


def _summarised(request: Request) -> Iterator[Store]:
    own = application_of(request)
    own.part(Reader).until_summarised()
    with own.storage.database.reading() as store:
        yield store


def _reader(request: Request) -> Reader:
    return application_of(request).part(Reader)


def _jobs(request: Request) -> JobDesk:
    return application_of(request).part(JobDesk)


def _groups(request: Request) -> GroupReader:
    return application_of(request).part(GroupReader)


ReaderOf = Annotated[Reader, Depends(_reader)]
"""What reads diagnoses."""
GroupReaderOf = Annotated[GroupReader, Depends(_groups)]
"""What reads what groups of sessions show."""
JobDeskOf = Annotated[JobDesk, Depends(_jobs)]
"""Where long work is asked for."""
ReadingFleet = Annotated[Store, Depends(_summarised, scope="function")]
"""The same, with what is kept of the fleet as a whole made before, where no process beside the requests makes it."""
