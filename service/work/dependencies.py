"""Dependencies of routes: readers of diagnoses and groups, the desk of long jobs."""

from collections.abc import Iterator
from typing import Annotated

from fastapi import Depends, Request

from service.storage.queries import Store
from service.web.application import application_of
from service.work.job_desk import JobDesk
from service.work.readers import GroupReader, Reader


def _summarised(request: Request) -> Iterator[Store]:
    application = application_of(request)
    application.part(Reader).until_summarised()
    with application.storage.database.reading() as store:
        yield store


def _reader(request: Request) -> Reader:
    return application_of(request).part(Reader)


def _jobs(request: Request) -> JobDesk:
    return application_of(request).part(JobDesk)


def _groups(request: Request) -> GroupReader:
    return application_of(request).part(GroupReader)


ReaderOf = Annotated[Reader, Depends(_reader)]
GroupReaderOf = Annotated[GroupReader, Depends(_groups)]
"""Reader of joint diagnoses of groups."""
JobDeskOf = Annotated[JobDesk, Depends(_jobs)]
"""The desk at which long jobs are requested."""
ReadingFleet = Annotated[Store, Depends(_summarised, scope="function")]
"""A store for reading the fleet; small ones wait for its summaries where no process makes them."""
