"""Work that waits for a person, over HTTP."""

from fastapi import APIRouter
from pydantic import BaseModel, Field

from service.languages.catalogue import said_in
from service.pages.review.queue import ToDo, waiting_for
from service.people.admission import PersonOf
from service.web.dependencies import LanguageOf, Now, Reading
from service.web.problem_document import errors

router = APIRouter(prefix="/review", tags=["fleet"])


class ReviewQueue(BaseModel):
    """Work that waits for the caller."""

    waiting: tuple[ToDo, ...] = Field(description="By kind, 15 of each at most; empty where nothing waits.")


@router.get("", responses=errors())
def read_review(store: Reading, person: PersonOf, now: Now, language: LanguageOf) -> ReviewQueue:
    """The work that the caller can do: own flags; for crews overdue units; for engineers questioned sessions,
    certificates to sign, flags without an assignee and failed work.
    """
    return ReviewQueue(waiting=tuple(said_in(to_do, language) for to_do in waiting_for(store, person, now)))
